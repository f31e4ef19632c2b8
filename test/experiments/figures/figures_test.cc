#include "experiments/figures/figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "evaluation/chi_squared.h"
#include "experiments/figures/figure_makers.h"
#include "test/experiments/figures/test_records.h"

namespace duet {
namespace {

using testing::Contains;
using testing::HasSubstr;

std::string ErrorOf(const std::string& name, const FigureInput& input,
                    const std::filesystem::path& out) {
  try {
    (void)MakeFigure(name, input, out);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// A study of two estimators and three seeds; the window's error is twice the filter's.
void WriteStudy(const std::filesystem::path& folder) {
  for (int seed = 1; seed <= 3; ++seed) {
    for (const char* estimator : {"msckf", "window"}) {
      TestRecord record{.estimator = estimator, .seed = seed};
      record.error_m = 0.1 * seed * (record.estimator == "window" ? 2.0 : 1.0);
      WriteTestRecord(record, folder / "runs" / (record.estimator + std::to_string(seed)));
    }
  }
}

TEST(Figures, PositionErrorHasTheRecordsErrorsAndSigmas) {
  const FiguresFolder folder;
  WriteTestRecord({.error_m = 0.2}, folder / "run");
  MakeFigure("position_error", {.folders = {folder / "run"}}, folder / "out");
  const FigureTable table = ReadFigureTable(folder / "out/position_error.csv");
  const std::vector<double> errors = table.Column("msckf: position error x");
  ASSERT_EQ(errors.size(), 40u);  // one row for each row of the record
  for (const double error : errors) EXPECT_NEAR(error, 0.2, 1e-12);
  for (const double error : table.Column("msckf: position error y")) EXPECT_NEAR(error, 0.0, 1e-12);
  for (const double sigma : table.Column("msckf +3 sigma: position error x")) {
    EXPECT_NEAR(sigma, 0.3, 1e-12);
  }
  EXPECT_THAT(table.comments[1], HasSubstr("run (msckf): duet 1 c, tracks abcdef"));
  EXPECT_THAT(ReadTextFile(folder / "out/position_error.gp"), HasSubstr("run (msckf): duet 1 c"));
}

TEST(Figures, WhatDidNotStartInTheTruthsAxesIsAlignedAndSaysSo) {
  const FiguresFolder folder;
  WriteTestRecord({.error_m = 0.2, .init = "rest"}, folder / "run");
  MakeFigure("position_error", {.folders = {folder / "run"}}, folder / "out");
  const FigureTable table = ReadFigureTable(folder / "out/position_error.csv");
  for (const double error : table.Column("msckf: position error x")) EXPECT_NEAR(error, 0.0, 1e-9);
  EXPECT_THAT(ReadTextFile(folder / "out/position_error.csv"), HasSubstr("Laid onto the truth"));
  EXPECT_THAT(ErrorOf("nees_over_time", {.folders = {folder / "run"}}, folder / "out"),
              HasSubstr("did not start in the truth's axes"));
}

TEST(Figures, OfAStudyOneExampleIsShownOverTimeAndAllRunsInStatistics) {
  const FiguresFolder folder;
  WriteStudy(folder / "study");
  const FigureInput input{.folders = {folder / "study"}};
  MakeFigure("position_error", input, folder / "out");
  const FigureTable errors = ReadFigureTable(folder / "out/position_error.csv");
  EXPECT_NEAR(errors.Column("window: position error x").at(7), 0.2, 1e-12);
  EXPECT_THAT(ReadTextFile(folder / "out/position_error.csv"),
              HasSubstr("Drawn: stream room, seed 1 (of 3)."));

  MakeFigure("nees_over_time", input, folder / "out");
  const FigureTable nees = ReadFigureTable(folder / "out/nees_over_time.csv");
  // (0.1 seed / 0.1)^2 over the seeds 1, 2, 3.
  const std::vector<double> mean = nees.Column("msckf: position NEES");
  ASSERT_EQ(mean.size(), 40u);
  for (const double value : mean) EXPECT_NEAR(value, (1.0 + 4.0 + 9.0) / 3.0, 1e-9);
  const Band band = MeanChiSquaredBand(3, 3, 0.95);
  EXPECT_NEAR(nees.Column("band of 3 runs: position NEES [-] from").front(), band.low, 1e-12);
  EXPECT_NEAR(nees.Column("band of 3 runs: position NEES [-] to").front(), band.high, 1e-12);
  EXPECT_EQ(nees.comments.size(), 1u + 6 + 2);  // all six records, two notes
}

// A study whose baseline estimates nothing has its figure from the first setting that does; cells
// that share a record are drawn once each.
TEST(Figures, TheCalibrationIsThatOfTheFirstSettingThatEstimatesOne) {
  const FiguresFolder folder;
  for (const char* setting : {"off", "on"}) {
    WriteTestRecord({.setting = setting, .seed = 1},
                    folder / ("study/runs/" + std::string(setting)));
  }
  const auto states = folder / "study/runs/off/states.csv";
  std::string without = ReadTextFile(states);
  for (std::size_t at; (at = without.find("sigma_t_d")) != std::string::npos;) {
    without.replace(at, 9, "other_t_d");
  }
  WriteTextFile(states, without);
  WriteTextFile(folder / "study/plan.csv",
                "#id,stream_id,stream,estimator,setting,perturbation,seed\n"
                "off,s,room,msckf,off,none,1\non,s,room,msckf,on,none,1\n"
                "on,s,room,msckf,on too,none,1\n");
  const Figure figure = ComposeFigure("calibration", {.folders = {folder / "study"}});
  EXPECT_EQ(figure.sources.size(), 1u);
  EXPECT_EQ(figure.notes.back(), "Drawn: stream room, setting on (of 3), seed 1.");
}

// Medians over those that did not fail beat nobody, and the note says how many failed.
TEST(Figures, CostIsComparedOnStreamsThatDifferInFeaturesAndWithoutSurvivors) {
  const FiguresFolder folder;
  std::string plan = "#id,stream_id,stream,estimator,setting,perturbation,seed\n";
  for (const char* stream : {"few", "many", "hall"}) {
    for (const int seed : {1, 2}) {
      const std::string id = stream + std::to_string(seed);
      plan += id + ",s," + stream + ",msckf,default,none," + std::to_string(seed) + "\n";
      if (id == "few2") continue;  // left no record
      WriteTestRecord({.states = 80, .stream = stream, .seed = seed},
                      folder / ("study/runs/" + id));
      WriteTextFile(folder / ("study/runs/" + id + "/evaluation.json"),
                    "{\"metrics\": {\"ate.position_m\": 0.1}}\n");
    }
  }
  WriteTextFile(folder / "study/plan.csv", plan);
  WriteTextFile(folder / "study/study.yaml",
                "study: s\nestimators: [msckf]\nseeds: 1..2\nstreams:\n"
                "  - {name: few, simulate: room_easy, set: {simulation.max_tracks: 40}}\n"
                "  - {name: many, simulate: room_easy, set: {simulation.max_tracks: 160}}\n"
                "  - {name: hall, simulate: room_easy, set: {simulation.duration_s: 9}}\n");
  const Figure figure = ComposeFigure("cost_against_accuracy", {.folders = {folder / "study"}});
  EXPECT_THAT(figure.notes, Contains("Settings: 1: default on few, 2: default on many."));
  EXPECT_THAT(figure.notes, Contains(HasSubstr("1 of 4 runs of msckf failed: left out")));
  EXPECT_EQ(figure.notes.back(), "Drawn: 2 of 3 streams, 2 seeds.");
  const auto front = std::find_if(figure.panels[0].series.begin(), figure.panels[0].series.end(),
                                  [](const Series& series) { return series.name == "front"; });
  ASSERT_NE(front, figure.panels[0].series.end());
  EXPECT_EQ(front->columns[0].size(), 1u);
}

// The order of the grid, and cells that left no record, are in plan.csv.
TEST(Figures, OfAPlanTheFirstCellIsTheExampleAndCellsWithoutRecordHaveFailed) {
  const FiguresFolder folder;
  WriteStudy(folder / "study");
  WriteTextFile(folder / "study/plan.csv",
                "#id,stream_id,stream,estimator,setting,perturbation,seed\n"
                "lost,s,room,msckf,default,none,7\n"
                "msckf3,s,room,msckf,default,none,3\n"
                "window3,s,room,window,default,none,3\n"
                "msckf1,s,room,msckf,default,none,1\n");
  const FigureInput input{.folders = {folder / "study"}};
  const Figure errors = ComposeFigure("position_error", input);
  EXPECT_THAT(errors.notes.back(), HasSubstr("Drawn: stream room, seed 3 (of 3)."));
  EXPECT_EQ(errors.sources.size(), 2u);
  const Figure rmse = ComposeFigure("rmse_over_runs", input);
  EXPECT_THAT(rmse.notes, Contains("1 of 3 runs of msckf failed: gaps."));
  EXPECT_THAT(rmse.notes.back(), "Drawn: stream room, 3 seeds.");
  EXPECT_THAT(rmse.sources.front(), HasSubstr("no record"));
  for (const char* name : {"nees_over_time", "relative_errors"}) {
    EXPECT_THAT(ComposeFigure(name, input).notes,
                Contains("1 of 3 runs of msckf failed: left out."))
        << name;
  }
}

// Of plain records the same estimator twice on one recording: told apart by name and look, and no
// sample of two.
TEST(Figures, PlainRunsOfOneEstimatorAreToldApart) {
  const FiguresFolder folder;
  WriteTestRecord({}, folder / "short");
  WriteTestRecord({.error_m = 0.2}, folder / "long");
  const FigureInput input{.folders = {folder / "short", folder / "long"}};
  const Figure errors = ComposeFigure("position_error", input);
  const std::vector<Series>& series = errors.panels[0].series;
  EXPECT_EQ(series[1].legend, "msckf, short");
  EXPECT_EQ(series[4].legend, "msckf, long");
  EXPECT_NE(series[1].look.colour, series[4].look.colour);
  EXPECT_NE(series[1].look.dash, series[4].look.dash);
  const Figure nees = ComposeFigure("nees_over_time", input);
  EXPECT_EQ(nees.sources.size(), 1u);
  EXPECT_EQ(nees.panels[0].series[1].legend, "msckf, 1 run");
}

// A run that is lost must not hide the others.
TEST(Figures, RmsesFarApartAreOnALogarithmicAxis) {
  const FiguresFolder folder;
  WriteStudy(folder / "study");
  const auto position_axis = [&](double lost_m) {
    for (const auto& run : std::filesystem::directory_iterator(folder / "study/runs")) {
      const bool lost = run.path().filename() == "msckf2";
      WriteTextFile(run.path() / "evaluation.json",
                    "{\"metrics\": {\"ate.position_m\": " + FormatNumber(lost ? lost_m : 0.02) +
                        ", \"ate.orientation_deg\": 2.5}}\n");
    }
    const Figure figure = ComposeFigure("rmse_over_runs", {.folders = {folder / "study"}});
    EXPECT_FALSE(figure.panels[1].y.logarithmic);
    EXPECT_EQ(figure.panels[1].y.low, 0.0);
    return figure.panels[0].y;
  };
  EXPECT_FALSE(position_axis(0.5).logarithmic);
  EXPECT_TRUE(position_axis(16.0).logarithmic);
  EXPECT_FALSE(position_axis(16.0).low.has_value());
}

TEST(Figures, RmseIsTheStudysOwnWhereItHasBeenEvaluated) {
  const FiguresFolder folder;
  WriteStudy(folder / "study");
  WriteTextFile(folder / "study/runs/msckf2/evaluation.json",
                "{\"metrics\": {\"ate.position_m\": 0.5, \"ate.orientation_deg\": 2.5}}\n");
  MakeFigure("rmse_over_runs", {.folders = {folder / "study"}}, folder / "out");
  const FigureTable table = ReadFigureTable(folder / "out/rmse_over_runs.csv");
  const std::vector<double> position = table.Column("msckf: position RMSE");
  ASSERT_EQ(position.size(), 3u);
  EXPECT_NEAR(position[0], 0.0, 1e-9);  // a shift alone: aligned away
  EXPECT_EQ(position[1], 0.5);
  EXPECT_EQ(table.Column("msckf: orientation RMSE").at(1), 2.5);
}

// Two settings that one estimator does not tell apart share its record: each cell is drawn in its
// own place, and once.
TEST(Figures, CellsThatShareARecordAreDrawnOnceEach) {
  const FiguresFolder folder;
  for (const char* id : {"msckf", "window_a", "window_b"}) {
    const std::string estimator = std::string(id).substr(0, 6) == "window" ? "window" : "msckf";
    WriteTestRecord({.estimator = estimator, .setting = "a", .seed = 1},
                    folder / ("study/runs/" + std::string(id)));
    WriteTextFile(folder / ("study/runs/" + std::string(id) + "/evaluation.json"),
                  "{\"metrics\": {\"ate.position_m\": 0.1}}\n");
  }
  WriteTextFile(folder / "study/plan.csv",
                "#id,stream_id,stream,estimator,setting,perturbation,seed\n"
                "msckf,s,room,msckf,a,none,1\nwindow_a,s,room,window,a,none,1\n"
                "msckf,s,room,msckf,b,none,1\nwindow_b,s,room,window,b,none,1\n");
  const FigureInput input{.folders = {folder / "study"}};
  EXPECT_EQ(ComposeFigure("position_error", input).sources.size(), 2u);
  MakeFigure("cost_against_accuracy", input, folder / "out");
  const FigureTable table = ReadFigureTable(folder / "out/cost_against_accuracy.csv");
  EXPECT_EQ(table.Column("msckf: position").size(), 2u);
  EXPECT_EQ(table.Column("window: position").size(), 2u);
}

TEST(Figures, RecordsOfTwoVersionsAreNotDrawnTogether) {
  const FiguresFolder folder;
  WriteStudy(folder / "study");
  const auto file = folder / "study/runs/msckf2/manifest.json";
  std::string manifest = ReadTextFile(file);
  manifest.replace(manifest.find("\"commit\": \"c\""), 13, "\"commit\": \"d\"");
  WriteTextFile(file, manifest);
  EXPECT_THAT(ErrorOf("rmse_over_runs", {.folders = {folder / "study"}}, folder / "out"),
              HasSubstr("results of two are not mixed"));
}

TEST(Figures, BadInputIsOneLineThatSaysWhatToDo) {
  const FiguresFolder folder;
  WriteTestRecord({.covariance = false}, folder / "run");
  const FigureInput input{.folders = {folder / "run"}};
  EXPECT_THAT(ErrorOf("positon_error", input, folder / "out"),
              HasSubstr("did you mean 'position_error'?"));
  EXPECT_THAT(ErrorOf("position_error", input, folder / "out"),
              HasSubstr("run it again with --covariance: duet run --backend msckf --covariance"));
  EXPECT_THAT(ErrorOf("nees_over_time", input, folder / "out"), HasSubstr("--covariance"));
  EXPECT_THAT(ErrorOf("position_error", {.folders = {}}, folder / "out"), HasSubstr("--runs"));
  EXPECT_THAT(ErrorOf("position_error", {.folders = {folder / "absent"}}, folder / "out"),
              HasSubstr("does not exist"));
  EXPECT_THAT(ErrorOf("position_error", {.folders = {folder.path()}}, folder / "out"),
              testing::AnyOf(HasSubstr("run it again"), HasSubstr("no run record")));
  std::filesystem::remove(folder / "run/truth.csv");
  WriteTextFile(folder / "run/covariance.csv", "#timestamp [ns],size,numbers\n");
  EXPECT_THAT(ErrorOf("position_error", input, folder / "out"),
              HasSubstr("dataset.path: absent/mav0 is not there"));
  WriteTextFile(
      folder / "run/manifest.json",
      "{\"dataset\": {\"path\": \"" + folder.path().string() + "\", \"cameras\": \"0\"}}\n");
  EXPECT_THAT(ErrorOf("position_error", input, folder / "out"),
              HasSubstr("is not as docs/formats.md says"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));  // nothing half written
}

}  // namespace
}  // namespace duet
