#include "experiments/figures/figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "evaluation/chi_squared.h"
#include "test/experiments/figures/test_records.h"

namespace duet {
namespace {

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
              HasSubstr("One example of 6 runs: room, seed 1"));

  MakeFigure("nees_over_time", input, folder / "out");
  const FigureTable nees = ReadFigureTable(folder / "out/nees_over_time.csv");
  // (0.1 seed / 0.1)^2 over the seeds 1, 2, 3.
  const std::vector<double> mean = nees.Column("msckf: position NEES");
  ASSERT_EQ(mean.size(), 40u);
  for (const double value : mean) EXPECT_NEAR(value, (1.0 + 4.0 + 9.0) / 3.0, 1e-9);
  const Band band = MeanChiSquaredBand(3, 3, 0.95);
  EXPECT_NEAR(nees.Column("band of 3 runs: position NEES [-] from").front(), band.low, 1e-12);
  EXPECT_NEAR(nees.Column("band of 3 runs: position NEES [-] to").front(), band.high, 1e-12);
  EXPECT_EQ(nees.comments.size(), 1u + 6 + 1);  // all six records
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
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));  // nothing half written
}

}  // namespace
}  // namespace duet
