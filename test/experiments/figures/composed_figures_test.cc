// The numbers of further figures, without drawing them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/figures/figure_files.h"
#include "experiments/figures/figure_makers.h"
#include "test/experiments/figures/test_records.h"

namespace duet {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

FigureTable DataOf(const std::string& name, const FigureInput& input, const FiguresFolder& folder) {
  WriteTextFile(folder / "data.csv", FigureCsv(ComposeFigure(name, input)));
  return ReadFigureTable(folder / "data.csv");
}

std::string RefusalOf(const std::string& name, const FigureInput& input) {
  try {
    (void)ComposeFigure(name, input);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ComposedFigures, TimeIsSplitIntoTheRecordsStages) {
  const FiguresFolder folder;
  WriteTestRecord({}, folder / "run");
  const FigureTable table = DataOf("time_by_stage", {.folders = {folder / "run"}}, folder);
  // Frame i: 1 ms in update, 0.1 i ms in rest.
  const std::string to = ": mean thread CPU time a frame [ms] to";
  EXPECT_NEAR(table.Column("update" + to).at(0), 1.0, 1e-9);
  EXPECT_NEAR(table.Column("rest" + to).at(0), 1.0 + 1.95, 1e-9);
  EXPECT_NEAR(table.Column("p50: thread").at(0), 1.0 + 1.95, 1e-9);
  EXPECT_NEAR(table.Column("max: thread").at(0), 1.0 + 3.9, 1e-9);
}

TEST(ComposedFigures, CostIsTheMedianOfFramesAndSeedsBySetting) {
  const FiguresFolder folder;
  for (int seed = 1; seed <= 3; ++seed) {
    for (const std::string setting : {"long", "short"}) {
      TestRecord record;
      record.states = setting == "long" ? 40 : 20;
      record.setting = setting;
      record.seed = seed;
      const auto run = folder / "study/runs" / (setting + std::to_string(seed));
      WriteTestRecord(record, run);
      const double error_m = (setting == "long" ? 0.1 : 0.3) + 0.01 * seed;
      WriteTextFile(run / "evaluation.json",
                    "{\"metrics\": {\"ate.position_m\": " + std::to_string(error_m) + "}}\n");
    }
  }
  const FigureTable table =
      DataOf("cost_against_accuracy", {.folders = {folder / "study"}}, folder);
  EXPECT_THAT(table.Column("msckf: thread"),
              ElementsAre(DoubleNear(1.95, 1e-9), DoubleNear(2.95, 1e-9)));
  EXPECT_THAT(table.Column("msckf: position"),
              ElementsAre(DoubleNear(0.32, 1e-6), DoubleNear(0.12, 1e-6)));
  EXPECT_EQ(table.Column("front: position").size(), 2u);  // each is cheaper or better
}

TEST(ComposedFigures, CalibrationShowsEstimateSigmasAndTruthInItsUnit) {
  const FiguresFolder folder;
  TestRecord record;
  record.seed = 1;
  WriteTestRecord(record, folder / "study/runs/a");
  WriteTextFile(folder / "study/runs/a/calibration_truth.csv", "name,true\nt_d,0.0015\n");
  FigureInput input{.folders = {folder / "study"}};
  const FigureTable table = DataOf("calibration", input, folder);
  EXPECT_NEAR(table.Column("msckf: t_d [ms]").at(3), 1.0, 1e-9);
  EXPECT_NEAR(table.Column("msckf +3 sigma: t_d [ms]").at(3), 1.0 + 3.0 * 10.0 / 4.0, 1e-9);
  EXPECT_NEAR(table.Column("truth: t_d [ms]").at(0), 1.5, 1e-9);
  // Sigma falls with the frames, 10 ms / n: the prior would leave nothing to see of what is known
  // after a tenth of the time, 1 ms +- 3 * 10 ms / 5.
  const Figure figure = CalibrationFigure(input);
  EXPECT_NEAR(figure.panels[0].y.low.value_or(0.0), 1.0 - 6.0 - 1.2, 1e-6);
  EXPECT_NEAR(figure.panels[0].y.high.value_or(0.0), 1.0 + 6.0 + 1.2, 1e-6);
  EXPECT_THAT(figure.notes.front(), HasSubstr("In the first 0.2 s lines go beyond the axes"));
  input.components = {"t_r"};
  EXPECT_THAT(RefusalOf("calibration", input), HasSubstr("did you mean 't_d'?"));
}

TEST(ComposedFigures, RelativeErrorsOfAShiftAreNone) {
  const FiguresFolder folder;
  WriteTestRecord({}, folder / "run");
  const FigureTable table = DataOf("relative_errors", {.folders = {folder / "run"}}, folder);
  const std::vector<double> medians =
      table.Column("msckf median: translation error [% of the way] to");
  EXPECT_GE(medians.size(), 2u);
  for (const double error : medians) EXPECT_NEAR(error, 0.0, 1e-9);
}

TEST(ComposedFigures, NormalizedErrorsAndTheirAutocorrelation) {
  const FiguresFolder folder;
  TestRecord record;
  record.states = 140;
  record.error_m = 0.11;
  WriteTestRecord(record, folder / "run");
  const FigureInput input{.folders = {folder / "run"}};
  // All errors along x are 1.1 sigma, those along y and z zero: a third of them in its bin.
  const std::vector<double> density =
      DataOf("normalized_errors", input, folder).Column("msckf: position");
  ASSERT_EQ(density.size(), 80u);
  EXPECT_NEAR(density[2 * (20 + 4)], 1.0 / 3.0 / 0.25, 1e-9);
  double share = 0.0;
  for (std::size_t i = 0; i < density.size(); i += 2) share += 0.25 * density[i];
  EXPECT_NEAR(share, 1.0, 1e-9);
  // A constant of n samples correlates with itself by the share that overlaps; the first 2 s of
  // the 7 s are left out.
  const std::vector<double> correlation =
      DataOf("whiteness", input, folder).Column("msckf position: autocorrelation");
  ASSERT_GT(correlation.size(), 10u);
  EXPECT_NEAR(correlation[0], 1.0, 1e-9);
  EXPECT_NEAR(correlation[10], 90.0 / 100.0, 1e-9);
}

TEST(ComposedFigures, AblationMatrixHoldsTheTablesNumbersColouredByTheirRatio) {
  const FiguresFolder folder;
  const auto cell = [](const char* variant, const char* median) {
    return std::string("{\"estimator\": \"msckf\", \"variant\": \"") + variant +
           "\", \"runs\": 3, \"ate_position_m\": {\"median\": " + median + "}}";
  };
  WriteTextFile(folder / "ablation.json", "[" + cell("none", "0.1") + "," + cell("t_d", "0.04") +
                                              "," + cell("all", "null") + "]\n");
  const Figure figure = ComposeFigure("ablation_matrix", {.folders = {folder.path()}});
  ASSERT_EQ(figure.panels.size(), 1u);  // no other quantity is there
  const Panel& panel = figure.panels[0];
  EXPECT_EQ(panel.series.back().texts, (std::vector<std::string>{"0.1", "0.04"}));
  EXPECT_EQ(panel.series[0].columns[0].size(), 1u);  // under 0.5 of none
  EXPECT_EQ(panel.series[2].columns[0].size(), 1u);  // none itself
  EXPECT_EQ(panel.y.ticks.size(), 3u);
  WriteTextFile(folder / "ablation.json", "[{\"variant\": \"none\"}]\n");
  EXPECT_THAT(RefusalOf("ablation_matrix", {.folders = {folder.path()}}),
              HasSubstr("estimator: is missing"));
}

TEST(ComposedFigures, InformationIsInUnitsOfThePriors) {
  const FiguresFolder folder;
  WriteTextFile(folder / "obs.json",
                R"({"components": [{"prior_sigma": 2.0}, {"prior_sigma": 0.1}],
                    "cut": {"covariance": [[1.0, 0.0], [0.0, 0.01]]},
                    "whole": {"covariance": [[0.04, 0.0], [0.0, 0.0001]]}})");
  const FigureTable table =
      DataOf("information_spectrum", {.folders = {folder / "obs.json"}}, folder);
  EXPECT_THAT(table.Column("tracks cut at the window: information"),
              ElementsAre(DoubleNear(4.0, 1e-9), DoubleNear(1.0, 1e-9)));
  EXPECT_THAT(table.Column("whole tracks: information"),
              ElementsAre(DoubleNear(100.0, 1e-7), DoubleNear(100.0, 1e-7)));
}

// 6.3: the clones that did not see the feature and the IMU's matrices have no entry.
TEST(ComposedFigures, StructureOfHxIsThatOfTheClonesThatSawTheFeature) {
  const Figure figure = ComposeFigure("thesis_6_3", {});
  const Panel& panel = figure.panels.front();
  const Series& nonzero = panel.series.front();
  const auto middle = [&panel](const std::string& group) {
    for (const auto& [at, name] : panel.x.ticks) {
      if (name == group) return at;
    }
    ADD_FAILURE() << group;
    return 0.0;
  };
  const auto rows_at = [&nonzero](double column) {
    int rows = 0;
    for (std::size_t i = 0; i < nonzero.columns[0].size(); ++i) {
      if (nonzero.columns[0][i] <= column && column <= nonzero.columns[1][i]) ++rows;
    }
    return rows;
  };
  for (const char* group : {"state", "IMU", "c0", "c5"}) {
    EXPECT_EQ(rows_at(middle(group)), 0) << group;
  }
  EXPECT_EQ(rows_at(middle("c1") - 4.0), 8);  // the anchor: all rows
  for (const char* group : {"c2", "c3", "c4"}) EXPECT_EQ(rows_at(middle(group)), 2) << group;
}

TEST(ComposedFigures, FiguresOfOtherCommandsSayWhatTheyExpect) {
  const FiguresFolder folder;
  const FigureInput input{.folders = {folder.path()}};
  EXPECT_THAT(RefusalOf("ablation_matrix", input), HasSubstr("expected the folder of duet ablate"));
  EXPECT_THAT(RefusalOf("allan", input), HasSubstr("expected the folder of duet allan"));
  EXPECT_THAT(RefusalOf("track_lengths", input), HasSubstr("has no run record"));
  EXPECT_THAT(RefusalOf("thesis_3_2", {}), HasSubstr("expected a recording that begins at rest"));
}

}  // namespace
}  // namespace duet
