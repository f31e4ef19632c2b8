#include "evaluation/study_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/support/input_error.h"
#include "common/support/random.h"
#include "evaluation/chi_squared.h"
#include "evaluation/failure_reasons.h"
#include "test/seeds.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::Not;

struct SyntheticStudy {
  std::vector<std::string> streams = {"room", "corridor", "hall"};
  std::vector<std::string> estimators = {"msckf", "window"};
  std::vector<std::string> settings = {"default"};
  int seeds = 20;
  std::uint64_t seed = 11;
  /// Multiplies the error of an arm.
  std::function<double(const StudyRun&)> factor = [](const StudyRun&) { return 1.0; };
};

/// Student's t with three degrees of freedom: tails that errors of estimators have.
double StudentT3(Random* random) {
  const double normal = random->Normal();
  double squares = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double z = random->Normal();
    squares += z * z;
  }
  return normal / std::sqrt(squares / 3.0);
}

/// Errors that share what a stream and seed do to every estimator, with heavy tails of their own.
StudyResult MakeStudy(const SyntheticStudy& synthetic) {
  StudyResult study;
  study.name = "synthetic";
  study.foot = {"first estimates on"};
  Random random(synthetic.seed);
  for (std::size_t s = 0; s < synthetic.streams.size(); ++s) {
    for (const std::string& setting : synthetic.settings) {
      for (const std::string& estimator : synthetic.estimators) {
        for (int seed = 1; seed <= synthetic.seeds; ++seed) {
          StudyRun run;
          run.stream = synthetic.streams[s];
          run.estimator = estimator;
          run.setting = setting;
          run.perturbation = "none";
          run.seed = seed;
          run.id = run.stream + setting + estimator + std::to_string(seed);
          Random of_stream = Random(100 + s).Fork(static_cast<std::uint64_t>(seed));
          const double error = 0.1 * static_cast<double>(s + 1) *
                               std::exp(0.3 * of_stream.Normal() + 0.05 * StudentT3(&random));
          run.metrics = {{"ate.position_m", error * synthetic.factor(run)},
                         {"coverage_share", 0.99},
                         {"nees.pose", 6.0 * std::exp(0.2 * random.Normal())}};
          study.runs.push_back(run);
        }
      }
    }
  }
  return study;
}

const StudyTable& TableNamed(const std::vector<StudyTable>& tables, const std::string& name) {
  for (const StudyTable& table : tables) {
    if (table.name == name) return table;
  }
  throw std::runtime_error("no table is called " + name);
}

std::vector<StudyTable> PositionTables(const SyntheticStudy& synthetic,
                                       StudyTableOptions options = {}) {
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 200;
  return MakeStudyTables(MakeStudy(synthetic), options);
}

TEST(StudyTable, PlantedDifferenceOfTenPercentIsSaidInOneSentence) {
  SyntheticStudy synthetic;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 0.9 : 1.0; };
  const auto tables = PositionTables(synthetic);
  const StudyTable& paired = TableNamed(tables, "ate.position_m.paired");
  EXPECT_THAT(paired.verdict, testing::StartsWith("window has the smaller position error (ATE): "));
  EXPECT_THAT(paired.verdict, HasSubstr("60 pairs on 3 streams, p < 0.001"));
  EXPECT_THAT(paired.verdict, Not(HasSubstr("general verdict")));
  EXPECT_EQ(TableNamed(tables, "ate.position_m").verdict, paired.verdict);
  const TableRow& all = paired.rows.back();
  EXPECT_EQ(all.cells[0].text, "all streams");
  EXPECT_EQ(all.cells[1].value, 60.0);
  // msckf / window. 60 ratios that scatter by about 12 %: four standard errors of their centre.
  EXPECT_NEAR(all.cells[3].value, 1.0 / 0.9, 0.06);
  EXPECT_LT(all.cells[3].low, all.cells[3].value);
  EXPECT_GT(all.cells[3].high, all.cells[3].value);
  EXPECT_GT(all.cells[3].low, 1.0);
  EXPECT_EQ(all.cells.back().text, "window");
}

TEST(StudyTable, NoDifferenceIsNoVerdict) {
  const auto tables = PositionTables({});
  EXPECT_THAT(TableNamed(tables, "ate.position_m.paired").verdict,
              testing::StartsWith("Nothing can be said of position error (ATE) between msckf and "
                                  "window: msckf's is "));
}

TEST(StudyTable, WholeTableGivesAFalseVerdictAtMostAsOftenAsAlpha) {
  // Two names of one estimator on three streams: four tests in a table, and any verdict is wrong.
  SyntheticStudy synthetic;
  synthetic.seeds = 12;
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 0;
  const int repetitions = test::Seeds(600, 150);
  int wrong = 0;
  for (int i = 0; i < repetitions; ++i) {
    synthetic.seed = static_cast<std::uint64_t>(1000 + i);
    const auto tables = MakeStudyTables(MakeStudy(synthetic), options);
    for (const TableRow& row : TableNamed(tables, "ate.position_m.paired").rows) {
      if (row.cells.empty() || row.cells.back().text == "nothing shown") continue;
      ++wrong;
      break;
    }
  }
  // Holm promises at most 0.05 for any of them, and with tests that hardly depend on one
  // another not much less: four standard errors above; and a test that never fires would be none.
  const double rate = static_cast<double>(wrong) / repetitions;
  const double sigma = std::sqrt(0.05 * 0.95 / repetitions);
  EXPECT_LT(rate, 0.05 + 4.0 * sigma);
  EXPECT_GT(rate, 0.01);
}

TEST(StudyTable, FourSeedsCannotDecide) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room"};
  synthetic.seeds = 4;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 0.5 : 1.0; };
  const auto tables = PositionTables(synthetic);
  const StudyTable& paired = TableNamed(tables, "ate.position_m.paired");
  EXPECT_EQ(paired.rows.back().cells.back().text, "too few pairs");
  EXPECT_THAT(paired.verdict, HasSubstr("4 pairs that differ cannot, 6 can"));
}

TEST(StudyTable, DifferenceBelowTheChaosFloorIsNoVerdict) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room", "hall", "chaos"};
  synthetic.factor = [](const StudyRun& run) {
    // Jitter alone makes 30 %, four times the planted difference.
    if (run.stream == "chaos") return run.seed % 2 == 0 ? 1.0 : 1.3;
    return run.estimator == "window" ? 0.9 : 1.0;
  };
  StudyTableOptions options;
  options.chaos_streams = {"chaos"};
  const auto tables = PositionTables(synthetic, options);
  const StudyTable& paired = TableNamed(tables, "ate.position_m.paired");
  EXPECT_THAT(paired.verdict, HasSubstr("below the chaos floor, no verdict"));
  EXPECT_THAT(paired.verdict, HasSubstr("40 pairs on 2 streams"));
  EXPECT_EQ(paired.rows.size(), 4u);  // two arms' title, two streams, both: none of chaos
  options.chaos_streams = {"choas"};
  EXPECT_THROW(PositionTables(synthetic, options), InputError);
}

TEST(StudyTable, WhoCoversLessIsNotCalledMoreAccurate) {
  SyntheticStudy synthetic;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 0.8 : 1.0; };
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) {
    if (run.estimator == "window") run.metrics[1].second = 0.9;
  }
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 200;
  const auto tables = MakeStudyTables(study, options);
  EXPECT_THAT(TableNamed(tables, "ate.position_m.paired").verdict,
              HasSubstr("covers 0.900 of the span and msckf 0.990, no verdict"));
  for (const TableRow& row : TableNamed(tables, "ate.position_m").rows) {
    EXPECT_EQ(row.cells[4].mark, TableMark::kNone);
  }
}

TEST(StudyTable, FailuresAreCountedAndDecideAsTheWorstRank) {
  SyntheticStudy synthetic;
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) {
    if (run.estimator != "window" || run.seed > 15) continue;
    run.failed = true;
    run.reason = "diverged";
    run.metrics[0].second = 1e-9;  // of the little that it did: in no statistic
  }
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 200;
  const auto tables = MakeStudyTables(study, options);
  const StudyTable& accuracy = TableNamed(tables, "ate.position_m");
  EXPECT_EQ(accuracy.rows[0].cells[5].text, "15/20");
  EXPECT_GT(accuracy.rows[0].cells[4].value, 0.01);
  const StudyTable& paired = TableNamed(tables, "ate.position_m.paired");
  EXPECT_EQ(paired.rows.back().cells[1].value, 15.0);
  EXPECT_EQ(paired.rows.back().cells[2].text, "0 : 45");
  EXPECT_EQ(paired.rows.back().cells.back().text, "msckf");
  EXPECT_THAT(paired.verdict, HasSubstr("window alone failed in 45 pairs"));
  const StudyTable& failures = TableNamed(tables, "failures");
  EXPECT_THAT(failures.verdict, testing::StartsWith("window fails more often than msckf (alone in "
                                                    "45 pairs, the other alone in 0; p < 0.001)"));
  EXPECT_EQ(failures.rows[2].cells.back().text, "diverged");
}

TEST(StudyTable, BestAndSecondAreMarkedByDirection) {
  SyntheticStudy synthetic;
  synthetic.estimators = {"a", "b", "c"};
  synthetic.factor = [](const StudyRun& run) {
    return run.estimator == "a" ? 3.0 : run.estimator == "b" ? 1.0 : 2.0;
  };
  const StudyTable lower = PositionTables(synthetic).front();
  EXPECT_EQ(lower.rows[0].cells[1].mark, TableMark::kNone);
  EXPECT_EQ(lower.rows[0].cells[4].mark, TableMark::kBest);
  EXPECT_EQ(lower.rows[0].cells[7].mark, TableMark::kSecondBest);
  StudyTableOptions options;
  options.metrics = {"coverage_share"};
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) run.metrics[1].second = run.estimator == "a" ? 0.9 : 0.8;
  const StudyTable higher = MakeStudyTables(study, options).front();
  EXPECT_EQ(higher.rows[0].cells[1].mark, TableMark::kBest);
  // Two share the second place.
  EXPECT_EQ(higher.rows[0].cells[3].mark, TableMark::kSecondBest);
  EXPECT_EQ(higher.rows[0].cells[5].mark, TableMark::kSecondBest);
}

TEST(StudyTable, WhoFailsMoreIsNotMarkedBestOfItsSurvivors) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room"};
  synthetic.estimators = {"a", "b", "c"};
  synthetic.factor = [](const StudyRun& run) {
    return run.estimator == "a" ? 0.1 : run.estimator == "b" ? 1.0 : 2.0;
  };
  StudyResult study = MakeStudy(synthetic);
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 0;
  const auto marks = [&](int failed_of_a, int failed_of_others) {
    for (StudyRun& run : study.runs) {
      run.failed = run.seed <= (run.estimator == "a" ? failed_of_a : failed_of_others);
    }
    const StudyTable table = MakeStudyTables(study, options).front();
    return std::vector<TableMark>{table.rows[0].cells[1].mark, table.rows[0].cells[4].mark,
                                  table.rows[0].cells[7].mark};
  };
  using enum TableMark;
  EXPECT_EQ(marks(0, 0), (std::vector{kBest, kSecondBest, kNone}));
  EXPECT_EQ(marks(2, 0), (std::vector{kBest, kSecondBest, kNone}));  // 10 % are no matter
  EXPECT_EQ(marks(3, 0), (std::vector{kNone, kBest, kSecondBest}));
  EXPECT_EQ(marks(12, 11), (std::vector{kNone, kNone, kNone}));  // the median run of each fails
  // Of runs that nearly half failed the median is among the worst survivors.
  EXPECT_EQ(marks(8, 8), (std::vector{kBest, kSecondBest, kNone}));
}

TEST(StudyTable, SixPairsOneWayAreTooFewForThreeTests) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room", "hall"};
  synthetic.seeds = 6;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 0.3 : 1.0; };
  const auto tables = PositionTables(synthetic);
  const StudyTable& paired = TableNamed(tables, "ate.position_m.paired");
  EXPECT_EQ(paired.rows[1].cells[5].value, 1.0 / 32.0);
  // All 12 pairs pass (p = 2^-11, three times that by Holm), and those of one stream cannot.
  EXPECT_EQ(paired.rows[1].cells.back().text, "too few pairs");
  EXPECT_EQ(paired.rows.back().cells.back().text, "window");
  EXPECT_THAT(paired.verdict, HasSubstr("with too few pairs to show it on one stream alone"));
  EXPECT_THAT(paired.verdict, Not(HasSubstr("taken alone")));
  // One stream has enough: said of how many that is so.
  synthetic.seeds = 7;
  StudyResult study = MakeStudy(synthetic);
  std::erase_if(study.runs,
                [](const StudyRun& run) { return run.stream == "hall" && run.seed > 5; });
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 0;
  EXPECT_THAT(
      TableNamed(MakeStudyTables(study, options), "ate.position_m.paired").verdict,
      HasSubstr("shown on 1 of 2 streams taken alone (1 of them with too few pairs for it)"));
  // Nothing at all can be shown: how many could.
  std::erase_if(study.runs, [](const StudyRun& run) { return run.seed > 3; });
  EXPECT_THAT(TableNamed(MakeStudyTables(study, options), "ate.position_m.paired").verdict,
              HasSubstr("6 pairs that differ cannot among 3 tests, 7 can"));
}

TEST(StudyTable, WithoutAnyPairTheSentenceSaysWhy) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room"};
  StudyResult study = MakeStudy(synthetic);
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  for (StudyRun& run : study.runs) {
    if (run.estimator == "window") run.metrics[0].second = std::nan("");
  }
  EXPECT_THAT(TableNamed(MakeStudyTables(study, options), "ate.position_m.paired").verdict,
              HasSubstr("there is no pair with a value of both"));
}

TEST(StudyTable, PValueOfPairsThatFailedIsSaidToBeOfThemToo) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room"};
  synthetic.seeds = 8;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 2.0 : 1.0; };
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) run.failed = run.estimator == "window" && run.seed > 4;
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  EXPECT_THAT(
      TableNamed(MakeStudyTables(study, options), "ate.position_m.paired").verdict,
      HasSubstr("(4 pairs of which both ran on 1 stream, p = 0.008 of these and 4 pairs of which "
                "one failed)"));
}

TEST(StudyTable, StreamByTwoNamesIsOneObservation) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room", "hall"};
  synthetic.seeds = 6;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 0.3 : 1.0; };
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) run.stream_id = run.stream + std::to_string(run.seed);
  const std::vector<StudyRun> runs = study.runs;
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 100;
  const StudyTable before = TableNamed(MakeStudyTables(study, options), "ate.position_m.paired");
  for (StudyRun run : runs) {
    if (run.stream != "room") continue;
    run.stream = "room again";
    study.runs.push_back(run);
  }
  const StudyTable after = TableNamed(MakeStudyTables(study, options), "ate.position_m.paired");
  EXPECT_EQ(after.rows.size(), before.rows.size() + 1);
  const TableRow& all = after.rows.back();
  EXPECT_EQ(all.cells[1].value, 12.0);
  EXPECT_EQ(all.cells[3].value, before.rows.back().cells[3].value);
  EXPECT_EQ(all.cells[3].low, before.rows.back().cells[3].low);
  EXPECT_EQ(all.cells[5].value, before.rows.back().cells[5].value);
  EXPECT_THAT(after.verdict, HasSubstr("12 pairs on 2 streams"));
  EXPECT_THAT(after.verdict, HasSubstr("on 2 streams only: a general verdict takes three"));
  EXPECT_THAT(after.foot, testing::Contains(HasSubstr("room again: its input is that of another")));
}

TEST(StudyTable, SummaryHasTheNumbersOfTheTables) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room"};
  synthetic.seeds = 3;
  StudyResult study = MakeStudy(synthetic);
  study.question = "who?";
  for (StudyRun& run : study.runs) {
    // Signed errors that cancel: -0.002, 0.0005, 0.001.
    run.metrics.emplace_back("calibration.t_d.error", run.seed == 1   ? -0.002
                                                      : run.seed == 2 ? 0.0005
                                                                      : 0.001);
    run.metrics[2].second = 2.0 * run.seed * run.seed;
    run.metrics.emplace_back("frame_ms.median", 1.2345);
  }
  // What the tables say, once.
  std::vector<StudyTable> said(3);
  said[0].verdict = "One is better.\nNothing can be said of two.";
  said[1].verdict = said[2].verdict = "None failed.";
  const StudyTable table = SummaryTable(
      study, {"coverage_share", "calibration.t_d.error", "nees.pose", "frame_ms.median"}, said);
  EXPECT_EQ(table.columns[4].title, "error of t_d at the end");
  EXPECT_EQ(table.columns[4].unit, "s");
  const std::string text = TableText(table);
  EXPECT_THAT(text, testing::StartsWith("synthetic: who?\n"));
  EXPECT_THAT(text, testing::ContainsRegex("msckf +3 +0 +0.990 +0.001000 +9.33 +1.23"));
  EXPECT_THAT(text, HasSubstr("of errors with a sign, of their magnitudes; of NEES the"));
  EXPECT_THAT(text,
              HasSubstr("\n\n- One is better.\n- Nothing can be said of two.\n- None failed.\n\n"));
  EXPECT_THROW((void)SummaryTable(study, {"ate.positon_m"}, {}), InputError);
}

TEST(FailureReasons, ThoseThatDifferInNumbersAloneAreOne) {
  EXPECT_EQ(CommonestReason({}), "");
  EXPECT_EQ(CommonestReason({"diverged", "diverged"}), "diverged");
  EXPECT_EQ(
      CommonestReason({"no frame", "the velocity of cam0 is 1.9 m/s", "no state",
                       "the velocity of cam0 is 1.602 m/s", "the velocity of cam0 is 12 m/s"}),
      "the velocity of cam0 is 1.602 to 12 m/s (3)");
  EXPECT_EQ(CommonestReason({"at -1e-3 s, 5 of 8", "at 2 s, 5 of 8"}), "at -1e-3 to 2 s, 5 of 8");
  EXPECT_EQ(CommonestReason({"cam0 is lost", "cam1 is lost", "cam1 is lost"}), "cam1 is lost (2)");
}

TEST(StudyTable, SettingsAreComparedWithTheBaselineForEachEstimator) {
  SyntheticStudy synthetic;
  synthetic.settings = {"default", "short"};
  synthetic.factor = [](const StudyRun& run) { return run.setting == "short" ? 1.3 : 1.0; };
  StudyTableOptions options;
  options.compare = ComparedAxis::kSettings;
  const auto tables = PositionTables(synthetic, options);
  const StudyTable& paired = TableNamed(tables, "ate.position_m.paired");
  EXPECT_THAT(paired.verdict, HasSubstr("msckf (default) has the smaller position error"));
  EXPECT_THAT(paired.verdict, HasSubstr(".\nwindow (default) has the smaller position error"));
  options.baseline = "shrot";
  EXPECT_THROW(PositionTables(synthetic, options), InputError);
}

TEST(StudyTable, RepeatedRecordCountsOnce) {
  SyntheticStudy synthetic;
  synthetic.streams = {"recording"};
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) run.id = run.estimator;  // nothing in it depends on the seed
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  const auto tables = MakeStudyTables(study, options);
  EXPECT_EQ(TableNamed(tables, "ate.position_m.paired").rows.back().cells[1].value, 1.0);
  EXPECT_THAT(tables.front().foot.back(), HasSubstr("made from 2 different runs"));
}

TEST(StudyTable, StartsInOneRecordingAreOneObservation) {
  SyntheticStudy synthetic;
  synthetic.streams = {"A", "B", "C", "D", "E", "F", "G"};
  synthetic.seeds = 5;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 0.5 : 1.0; };
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) run.stream_id = run.stream;
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 200;
  const auto tables = MakeStudyTables(study, options);
  const StudyTable& paired = TableNamed(tables, "ate.position_m.paired");
  EXPECT_EQ(paired.rows[1].cells[1].value, 1.0);
  EXPECT_EQ(paired.rows[1].cells.back().text, "too few pairs");
  const TableRow& all = paired.rows.back();
  EXPECT_EQ(all.cells[1].value, 7.0);
  EXPECT_LT(all.cells[3].low, all.cells[3].high);  // resampled over the recordings
  EXPECT_EQ(all.cells[5].value, 1.0 / 64.0);
}

TEST(StudyTable, OfManyArmsSentencesNameThoseOfWhichTheySaySomething) {
  StudyResult study = MakeStudy({});
  const std::vector<StudyRun> runs = study.runs;
  study.runs.clear();
  for (const char* condition : {"a", "b", "c", "d"}) {
    for (StudyRun run : runs) {
      run.perturbation = condition;
      run.metrics.emplace_back("ate.position_m.se3", run.metrics[0].second);
      // One of the eight arms is refuted.
      if (condition == std::string("c") && run.estimator == "window") run.metrics[2].second *= 2.0;
      study.runs.push_back(std::move(run));
    }
  }
  StudyTableOptions options;
  options.metrics = {"ate.position_m", "nees.pose"};
  options.bootstrap_resamples = 100;
  const auto tables = MakeStudyTables(study, options);
  const std::string nees = TableNamed(tables, "nees").verdict;
  EXPECT_THAT(nees, HasSubstr("The covariance of window"));
  EXPECT_THAT(nees,
              HasSubstr(".\nThe covariances of the other 7 are refuted in none of 21 tests."));
  EXPECT_EQ(TableNamed(tables, "sensitivity").verdict,
            "Of all measures of the position none says who is better in 4 of the pairs.");
}

TEST(StudyTable, NeesStandsBesideItsBand) {
  SyntheticStudy synthetic;
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) {
    if (run.estimator == "window") run.metrics[2].second *= 1.5;
    run.metrics.emplace_back("nees.calibration", 56.0);
    run.metrics.emplace_back("nees.calibration.dof", 56.0);
  }
  StudyTableOptions options;
  options.metrics = {"nees.pose", "nees.calibration"};
  const StudyTable nees = TableNamed(MakeStudyTables(study, options), "nees");
  EXPECT_THAT(nees.verdict, HasSubstr("covariance of msckf is refuted in none of 6 tests"));
  EXPECT_THAT(nees.verdict, HasSubstr("covariance of window is too sure in 3 of 6 tests"));
  const TableRow& calibration = nees.rows[2];
  EXPECT_EQ(calibration.cells[4].value, 56.0);
  EXPECT_LT(calibration.cells[6].value, 56.0);
  EXPECT_GT(calibration.cells[7].value, 56.0);
}

// 20 runs on one recording share one draw of its noise.
TEST(StudyTable, NeesOfRunsOnOneRecordingIsOneValue) {
  SyntheticStudy synthetic;
  synthetic.streams = {"room"};
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) {
    run.stream_id = "recording";
    run.metrics[2].second = 10.0 + run.seed;
  }
  StudyTableOptions options;
  options.metrics = {"nees.pose"};
  const StudyTable one = TableNamed(MakeStudyTables(study, options), "nees");
  EXPECT_EQ(one.rows[1].cells[2].value, 20.0);
  EXPECT_EQ(one.rows[1].cells[3].value, 1.0);
  EXPECT_EQ(one.rows[1].cells.back().text, "one input, no verdict");
  EXPECT_THAT(one.verdict, HasSubstr("it takes runs with one on two inputs"));
  // 19 runs on one of two recordings have no more weight than the one on the other: means of 10.5
  // (seeds 2 ... 20 lifted to it) and 3.5, where 19 of 20 runs say 10.5.
  for (StudyRun& run : study.runs) {
    run.stream_id = run.seed == 1 ? "first" : "second";
    run.metrics[2].second = run.seed == 1 ? 3.5 : 10.5;
  }
  const StudyTable two = TableNamed(MakeStudyTables(study, options), "nees");
  EXPECT_EQ(two.rows[1].cells[3].value, 2.0);
  EXPECT_EQ(two.rows[1].cells[5].value, 7.0);
  const Band band = MeanChiSquaredBand(6.0, 2, 0.95);
  EXPECT_EQ(two.rows[1].cells[6].value, band.low);
  EXPECT_EQ(two.rows[1].cells[7].value, band.high);
  EXPECT_EQ(two.rows[1].cells.back().text, "not refuted");
}

TEST(StudyTable, SensitivityTellsWhereMeasuresDisagree) {
  SyntheticStudy synthetic;
  synthetic.factor = [](const StudyRun& run) { return run.estimator == "window" ? 0.8 : 1.0; };
  StudyResult study = MakeStudy(synthetic);
  for (StudyRun& run : study.runs) {
    const double position = run.metrics[0].second;
    run.metrics.emplace_back("ate.position_m.se3", position);
    // Over short segments the other is better.
    const double turned = run.estimator == "window" ? 2.0 : 1.0;
    run.metrics.emplace_back("relative.position_m.1", 0.1 * turned * position);
  }
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.bootstrap_resamples = 100;
  EXPECT_EQ(TableNamed(MakeStudyTables(study, options), "sensitivity").verdict,
            "Of 3 measures of the position 1 say msckf and 2 window: who is better depends on how "
            "it is measured.");
  for (StudyRun& run : study.runs) run.metrics.pop_back();
  const auto agreeing = MakeStudyTables(study, options);
  const StudyTable& table = TableNamed(agreeing, "sensitivity");
  EXPECT_EQ(table.verdict, "Of 2 measures of the position all say window and none msckf.");
  EXPECT_EQ(table.rows.size(), 3u);
}

TEST(StudyTable, UnknownMetricNamesTheNearest) {
  try {
    StudyTableOptions options;
    options.metrics = {"ate.positon_m"};
    (void)MakeStudyTables(MakeStudy({}), options);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'ate.position_m'?"));
  }
  EXPECT_THROW((void)MakeStudyTables(StudyResult{}, {}), InputError);
}

}  // namespace
}  // namespace duet
