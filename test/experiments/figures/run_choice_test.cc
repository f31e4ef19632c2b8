// Which of the runs found a figure is made of, where the user chooses.

#include "experiments/figures/run_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/figures/figure_files.h"
#include "experiments/figures/figure_makers.h"
#include "test/experiments/figures/test_records.h"

namespace duet {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

// Two streams, two settings, two seeds, two estimators; the error in mm says which a run is.
void WriteGrid(const std::filesystem::path& folder) {
  std::string plan = "#id,stream_id,stream,estimator,setting,perturbation,seed\n";
  int error_mm = 0;
  for (const char* stream : {"room", "hall"}) {
    for (const char* setting : {"default", "slow"}) {
      for (const char* estimator : {"msckf", "window"}) {
        for (const int seed : {1, 2}) {
          const std::string id = std::string(stream) + setting + estimator + std::to_string(seed);
          plan += id + ",s," + stream + "," + estimator + "," + setting + ",none," +
                  std::to_string(seed) + "\n";
          WriteTestRecord({.estimator = estimator,
                           .error_m = 1e-3 * ++error_mm,
                           .stream = stream,
                           .setting = setting,
                           .seed = seed},
                          folder / "runs" / id);
        }
      }
    }
  }
  WriteTextFile(folder / "plan.csv", plan);
}

std::string RefusalOfChoice(const std::string& name, const FigureInput& input) {
  try {
    (void)ComposeFigure(name, input);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

class RunChoiceTest : public testing::Test {
 protected:
  RunChoiceTest() { WriteGrid(folder_ / "study"); }

  FigureInput Choosing(const RunChoice& choice) const {
    return {.folders = {folder_ / "study"}, .choice = choice};
  }
  std::string Refusal(const std::string& name, const RunChoice& choice) const {
    return RefusalOfChoice(name, Choosing(choice));
  }

  const FiguresFolder folder_;
};

// The 16 runs in the grid's order have errors of 1 to 16 mm.
TEST_F(RunChoiceTest, WhatIsShownOverTimeIsTheRunChosenAndTheDataSayWhich) {
  const FigureInput input = Choosing(
      {.streams = {"hall"}, .settings = {"slow"}, .seeds = {"2"}, .estimators = {"window"}});
  WriteTextFile(folder_ / "data.csv", FigureCsv(ComposeFigure("position_error", input)));
  const FigureTable table = ReadFigureTable(folder_ / "data.csv");
  const std::vector<double> errors = table.Column("window: position error x");
  ASSERT_FALSE(errors.empty());
  for (const double error : errors) EXPECT_NEAR(error, 0.016, 1e-12);
  EXPECT_THAT(table.comments, Contains(HasSubstr("runs/hallslowwindow2 (window)")));
  EXPECT_THAT(table.comments,
              Contains(HasSubstr("Drawn: stream hall (of 2), setting slow (of 2), seed 2 (of 2), "
                                 "estimator window (of 2).")));
  for (const std::string& comment : table.comments) {
    EXPECT_EQ(comment.find("msckf"), std::string::npos) << comment;
  }
}

// Every coordinate by itself moves the example to the first run that has it.
TEST_F(RunChoiceTest, EachChoiceAloneMovesTheExample) {
  const auto first = [&](const RunChoice& choice) {
    return ComposeFigure("position_error", Choosing(choice)).sources.front();
  };
  EXPECT_THAT(first({}), HasSubstr("runs/roomdefaultmsckf1 "));
  EXPECT_THAT(first({.streams = {"hall"}}), HasSubstr("runs/halldefaultmsckf1 "));
  EXPECT_THAT(first({.settings = {"slow"}}), HasSubstr("runs/roomslowmsckf1 "));
  EXPECT_THAT(first({.seeds = {"2"}}), HasSubstr("runs/roomdefaultmsckf2 "));
  EXPECT_THAT(first({.estimators = {"window"}}), HasSubstr("runs/roomdefaultwindow1 "));
}

TEST_F(RunChoiceTest, StatisticsAreOverTheSeedsChosen) {
  const auto sources = [&](const char* name, const RunChoice& choice) {
    return ComposeFigure(name, Choosing(choice)).sources.size();
  };
  for (const char* name :
       {"nees_over_time", "rmse_over_runs", "time_by_stage", "relative_errors"}) {
    EXPECT_EQ(sources(name, {}), 4u) << name;
    EXPECT_EQ(sources(name, {.seeds = {"2"}}), 2u) << name;
    EXPECT_EQ(sources(name, {.seeds = {"1", "2"}, .estimators = {"window"}}), 2u) << name;
  }
  EXPECT_EQ(ComposeFigure("rmse_over_runs", Choosing({.seeds = {"2"}})).notes.back(),
            "Drawn: stream room (of 2), setting default (of 2), seed 2 (of 2).");
}

TEST_F(RunChoiceTest, CostIsDrawnOfTheSettingsChosen) {
  for (const std::filesystem::directory_entry& run :
       std::filesystem::directory_iterator(folder_ / "study/runs")) {
    WriteTextFile(run.path() / "evaluation.json", "{\"metrics\": {\"ate.position_m\": 0.1}}\n");
  }
  const auto notes = [&](const RunChoice& choice) {
    return ComposeFigure("cost_against_accuracy", Choosing(choice)).notes;
  };
  EXPECT_THAT(notes({}), Contains("Settings: 1: default, 2: slow."));
  EXPECT_THAT(notes({.settings = {"default", "slow"}}), Contains("Settings: 1: default, 2: slow."));
  EXPECT_THAT(notes({.settings = {"slow"}}),
              Contains("Drawn: stream room (of 2), setting slow (of 2), 2 seeds."));
}

TEST_F(RunChoiceTest, UnknownNamesAreOneLineWithTheNearest) {
  EXPECT_EQ(Refusal("position_error", {.streams = {"hal"}}),
            "--stream: no run is of stream 'hal'; did you mean 'hall'?");
  EXPECT_EQ(Refusal("position_error", {.settings = {"quick"}}),
            "--setting: no run is of setting 'quick'; expected default, slow");
  EXPECT_EQ(Refusal("position_error", {.perturbations = {"t_d"}}),
            "--perturbation: no run is of perturbation 't_d'; expected none");
  EXPECT_EQ(Refusal("position_error", {.seeds = {"7"}}),
            "--seed: no run is of seed '7'; the seeds are 1 to 2");
  EXPECT_EQ(Refusal("position_error", {.estimators = {"msckf", "windw"}}),
            "--estimator: no run is of estimator 'windw'; did you mean 'window'?");
}

TEST_F(RunChoiceTest, AChoiceThatLeavesNoRunIsRefused) {
  // Names that are there, but not together.
  std::string plan;
  std::ifstream file(folder_ / "study/plan.csv");
  for (std::string line; std::getline(file, line);) {
    if (line.find("hallslowwindow") == std::string::npos) plan += line + "\n";
  }
  file.close();
  WriteTextFile(folder_ / "study/plan.csv", plan);
  const RunChoice none = {.streams = {"hall"}, .settings = {"slow"}, .estimators = {"window"}};
  EXPECT_EQ(Refusal("position_error", none),
            "--stream hall --setting slow --estimator window: no run is of all of these");
  RunChoice one = none;
  one.estimators = {"msckf", "window"};
  EXPECT_THAT(Refusal("position_error", one),
              HasSubstr("--estimator: 'window' has no run that is"));
  // There are such runs, on what is not drawn: the example is of the first stream.
  one.streams = {};
  EXPECT_EQ(Refusal("position_error", one), "no error");
  std::filesystem::remove(folder_ / "study/runs/hallslowmsckf1/manifest.json");
  EXPECT_THAT(
      Refusal("position_error", {.streams = {"hall"}, .settings = {"slow"}, .seeds = {"1"}}),
      EndsWith("--seed 1: no such run left a record"));
}

TEST_F(RunChoiceTest, WhatCouldNotChangeTheFigureIsRefused) {
  for (const char* name : {"thesis_3_8", "thesis_6_3", "allan", "ablation_matrix"}) {
    EXPECT_EQ(Refusal(name, {.streams = {"hall"}}), "--stream: has no effect on duet figure " +
                                                        std::string(name) +
                                                        ", which is not made of runs");
  }
  for (const char* name : {"track_lengths", "parallax", "thesis_3_2"}) {
    EXPECT_THAT(Refusal(name, {.estimators = {"window"}}),
                HasSubstr("shows the data that every estimator was given"))
        << name;
    EXPECT_THAT(Refusal(name, {.settings = {"slow"}}), HasSubstr("--setting: has no effect"));
  }
  EXPECT_EQ(Refusal("position_error", {.seeds = {"1", "2"}}),
            "--seed: stands there twice, and duet figure position_error draws one seed");
  EXPECT_EQ(Refusal("rmse_over_runs", {.seeds = {"1", "1"}}), "--seed: '1' stands there twice");
  EXPECT_THAT(Refusal("rmse_over_runs", {.settings = {"default", "slow"}}),
              HasSubstr("draws one setting"));
  EXPECT_THAT(Refusal("cost_against_accuracy", {.streams = {"room", "hall"}}),
              HasSubstr("draws one stream"));
  EXPECT_THAT(Refusal("thesis_5_4", {.estimators = {"msckf", "window"}}),
              HasSubstr("draws one estimator"));
  // Figures that can be made of something else than runs.
  EXPECT_THAT(RefusalOfChoice("thesis_5_4", {.folders = {}, .choice = {.seeds = {"1"}}}),
              HasSubstr("no --runs are given"));
  WriteTextFile(folder_ / "obs.json", "{}");
  EXPECT_THAT(RefusalOfChoice("information_spectrum",
                              {.folders = {folder_ / "obs.json"}, .choice = {.seeds = {"1"}}}),
              HasSubstr("--seed: chooses among runs, and the figure is made of a file of duet "
                        "observability"));
  std::filesystem::create_directories(folder_ / "recording/mav0");
  for (const char* name : {"track_lengths", "thesis_3_2"}) {
    EXPECT_THAT(RefusalOfChoice(
                    name, {.folders = {folder_ / "recording"}, .choice = {.streams = {"room"}}}),
                HasSubstr("made of a recording"))
        << name;
  }
}

// Records of duet run and duet compare have an estimator and a recording, and no place in a grid.
TEST(RunChoice, OfPlainRunsTheEstimatorAndTheRecordingCanBeChosen) {
  const FiguresFolder folder;
  for (const char* estimator : {"msckf", "window"}) {
    WriteTestRecord({.estimator = estimator}, folder / ("compare/" + std::string(estimator)));
  }
  const auto input = [&](const RunChoice& choice) {
    return FigureInput{.folders = {folder / "compare"}, .choice = choice};
  };
  const Figure figure = ComposeFigure("position_error", input({.estimators = {"window"}}));
  EXPECT_THAT(figure.sources, ElementsAre(HasSubstr("compare/window (window)")));
  EXPECT_EQ(RefusalOfChoice("position_error", input({.estimators = {"windwo"}})),
            "--estimator: no run is of estimator 'windwo'; did you mean 'window'?");
  for (const auto& [flag, choice] : {std::pair{"seed", RunChoice{.seeds = {"0"}}},
                                     {"setting", RunChoice{.settings = {"a"}}},
                                     {"perturbation", RunChoice{.perturbations = {"none"}}}}) {
    EXPECT_EQ(RefusalOfChoice("position_error", input(choice)),
              "--" + std::string(flag) + ": the runs have no " + flag +
                  ": they are of duet run or duet compare, not of a study; expected no such "
                  "choice");
  }
  EXPECT_THAT(RefusalOfChoice("position_error", input({.streams = {"nowhere"}})),
              HasSubstr("--stream: "));
}

}  // namespace
}  // namespace duet
