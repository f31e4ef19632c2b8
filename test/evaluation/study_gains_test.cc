#include "evaluation/study_gains.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/support/random.h"
#include "evaluation/study_table.h"
#include "test/seeds.h"

namespace duet {
namespace {

using testing::HasSubstr;

struct GainStudy {
  std::vector<std::string> streams = {"room", "corridor", "hall"};
  std::vector<std::string> perturbations = {"none"};
  int seeds = 20;
  std::uint64_t seed = 5;
  double msckf_gain = 0.5;  ///< error with t_d estimated over that with t_d fixed
  double window_gain = 0.6;
  double window_failures = 0.0;  ///< probability of each of its runs
};

StudyResult MakeGainStudy(const GainStudy& gains) {
  StudyResult study;
  study.name = "gains";
  Random random(gains.seed);
  for (const std::string& stream : gains.streams) {
    for (const std::string& perturbation : gains.perturbations) {
      for (const char* setting : {"t_d fixed", "t_d estimated"}) {
        for (const char* estimator : {"msckf", "window"}) {
          for (int seed = 1; seed <= gains.seeds; ++seed) {
            StudyRun run;
            run.stream = stream;
            run.estimator = estimator;
            run.setting = setting;
            run.perturbation = perturbation;
            run.seed = seed;
            run.id = stream + perturbation + setting + estimator + std::to_string(seed);
            const bool window = run.estimator == "window";
            double error = (window ? 0.3 : 0.1) * std::exp(0.03 * random.Normal());
            if (run.setting == "t_d estimated") {
              error *= window ? gains.window_gain : gains.msckf_gain;
            }
            run.metrics = {{"ate.position_m", error}, {"coverage_share", 0.99}};
            run.failed = window && random.Uniform() < gains.window_failures;
            study.runs.push_back(run);
          }
        }
      }
    }
  }
  return study;
}

StudyTableOptions GainOptions() {
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.compare = ComparedAxis::kSettings;
  options.baseline = "t_d fixed";
  options.bootstrap_resamples = 200;
  return options;
}

MetricGains GainsOf(const StudyResult& study, const StudyTableOptions& options,
                    const char* metric = "ate.position_m") {
  const StudyGrid grid(study);
  const auto gains = CompareGains(grid, MetricOf(metric), options);
  EXPECT_TRUE(gains.has_value());
  return gains.value_or(MetricGains{});
}

bool HasTable(const std::vector<StudyTable>& tables, const std::string& name) {
  for (const StudyTable& table : tables) {
    if (table.name == name) return true;
  }
  return false;
}

// Both gain, and both are shown to gain: that the one gains more is a test of its own.
TEST(StudyGains, WhoGainsMoreIsSaidInOneSentence) {
  const StudyResult study = MakeGainStudy({});
  const MetricGains gains = GainsOf(study, GainOptions());
  ASSERT_EQ(gains.changes.size(), 1u);
  EXPECT_EQ(gains.comparison.tests, 4);  // three streams, and all
  const ComparisonRow& all = gains.changes[0].arms.overall();
  EXPECT_EQ(all.decision, Decision::kFirstBetter);
  EXPECT_EQ(all.paired.pairs, 60);
  // 60 ratios of four errors with 3 % of noise each: 0.06 / sqrt(60) is 0.8 %; four of these.
  EXPECT_NEAR(all.paired.ratio, 0.5 / 0.6, 0.03);
  EXPECT_NEAR(gains.changes[0].first_gain, 0.5, 0.015);
  EXPECT_NEAR(gains.changes[0].second_gain, 0.6, 0.015);
  const std::string sentence = GainsSentences(gains);
  EXPECT_THAT(sentence, testing::ContainsRegex(
                            "^t_d estimated instead of t_d fixed helps msckf 1.[12][0-9]+ times as "
                            "much as window: position error \\(ATE\\) becomes 0.[45][0-9]+ times "
                            "as large for msckf and 0.[56][0-9]+ times for window \\(95 % interval "
                            "1.[12][0-9]+ to 1.2[0-9]+; 60 pairs on 3 streams, p < 0.001 after "
                            "Holm's correction\\), shown on 3 of 3 streams taken alone\\.$"));
  const auto tables = MakeStudyTables(study, GainOptions());
  ASSERT_TRUE(HasTable(tables, "ate.position_m.gains"));
  for (const StudyTable& table : tables) {
    if (table.name != "ate.position_m.gains") continue;
    EXPECT_EQ(table.verdict, sentence);
    EXPECT_EQ(table.rows[0].section, "t_d estimated instead of t_d fixed: msckf / window");
    EXPECT_EQ(table.rows.back().cells.back().text, "msckf");
    EXPECT_THAT(table.foot, testing::Contains(HasSubstr("corrected over the 4 tests")));
  }
}

TEST(StudyGains, WhatCostsTheOneMoreIsSaidAsACost) {
  const MetricGains gains =
      GainsOf(MakeGainStudy({.msckf_gain = 2.4, .window_gain = 2.0}), GainOptions());
  EXPECT_THAT(GainsSentences(gains),
              testing::ContainsRegex("^t_d estimated instead of t_d fixed costs msckf 1.[12][0-9]+ "
                                     "times as much as window: "));
}

TEST(StudyGains, EqualGainsAreNoVerdictThoughTheErrorsDifferThreefold) {
  const MetricGains gains = GainsOf(MakeGainStudy({.window_gain = 0.5}), GainOptions());
  EXPECT_EQ(gains.changes[0].arms.overall().decision, Decision::kNothing);
  EXPECT_THAT(GainsSentences(gains),
              testing::StartsWith("Nothing can be said of whether t_d estimated instead of t_d "
                                  "fixed helps msckf or window more in position error (ATE): "));
}

TEST(StudyGains, EachPerturbationIsAComparisonOfItsOwn) {
  const MetricGains gains =
      GainsOf(MakeGainStudy({.perturbations = {"none", "10 ms"}}), GainOptions());
  ASSERT_EQ(gains.changes.size(), 2u);
  EXPECT_EQ(gains.comparison.tests, 8);
  EXPECT_EQ(gains.changes[1].change, "t_d estimated instead of t_d fixed (10 ms)");
}

// An estimator that fails as often with the change as without has gained nothing and lost nothing.
TEST(StudyGains, FailuresThatTheChangeDoesNotTouchGiveNoMoreFalseAlarmsThanAlpha) {
  GainStudy study{.streams = {"room"}, .window_gain = 0.5, .window_failures = 0.3};
  StudyTableOptions options = GainOptions();
  options.bootstrap_resamples = 0;
  const int repetitions = test::Seeds(600, 150);
  int wrong = 0;
  for (int i = 0; i < repetitions; ++i) {
    study.seed = static_cast<std::uint64_t>(100 + i);
    const Decision decision =
        GainsOf(MakeGainStudy(study), options).changes[0].arms.overall().decision;
    wrong += decision == Decision::kFirstBetter || decision == Decision::kSecondBetter ? 1 : 0;
  }
  const double rate = static_cast<double>(wrong) / repetitions;
  EXPECT_LT(rate, 0.05 + 4.0 * std::sqrt(0.05 * 0.95 / repetitions));
  EXPECT_GT(rate, 0.005);
}

TEST(StudyGains, FailuresThatTheChangeBringsDecide) {
  StudyResult study = MakeGainStudy({.window_gain = 0.5});
  for (StudyRun& run : study.runs) {
    run.failed = run.estimator == "window" && run.setting == "t_d estimated" && run.seed > 5;
  }
  const MetricGains brings = GainsOf(study, GainOptions());
  EXPECT_EQ(brings.changes[0].arms.overall().decision, Decision::kFirstBetter);
  EXPECT_EQ(brings.changes[0].arms.overall().paired.only_second_failed, 45);
  // The other way round the change cures them.
  for (StudyRun& run : study.runs) {
    run.failed = run.estimator == "window" && run.setting == "t_d fixed" && run.seed > 5;
  }
  const MetricGains cures = GainsOf(study, GainOptions());
  EXPECT_EQ(cures.changes[0].arms.overall().decision, Decision::kSecondBetter);
  EXPECT_EQ(cures.changes[0].arms.overall().paired.only_first_failed, 45);
}

TEST(StudyGains, WhoGainsByCoveringLessIsNotCalledBetter) {
  StudyResult study = MakeGainStudy({});
  for (StudyRun& run : study.runs) {
    if (run.estimator == "msckf" && run.setting == "t_d estimated") run.metrics[1].second = 0.9;
  }
  const MetricGains gains = GainsOf(study, GainOptions());
  EXPECT_EQ(gains.changes[0].arms.overall().decision, Decision::kCoversLess);
  EXPECT_THAT(GainsSentences(gains), HasSubstr("since with it msckf covers less of the span"));
  // Who covers less with the baseline too gains by no such thing.
  for (StudyRun& run : study.runs) {
    if (run.estimator == "msckf") run.metrics[1].second = 0.9;
  }
  EXPECT_EQ(GainsOf(study, GainOptions()).changes[0].arms.overall().decision,
            Decision::kFirstBetter);
}

TEST(StudyGains, SharesAreComparedByDifferences) {
  StudyResult study = MakeGainStudy({});
  Random random(3);
  for (StudyRun& run : study.runs) {
    const bool changed = run.setting == "t_d estimated";
    run.metrics[1].second = 0.8 + 0.01 * random.Uniform() +
                            (!changed                   ? 0.0
                             : run.estimator == "msckf" ? 0.02
                                                        : 0.1);
  }
  const MetricGains gains = GainsOf(study, GainOptions(), "coverage_share");
  EXPECT_FALSE(gains.is_ratio);
  const ComparisonRow& all = gains.changes[0].arms.overall();
  EXPECT_EQ(all.decision, Decision::kSecondBetter);
  EXPECT_NEAR(all.paired.difference, 0.08, 0.005);
  EXPECT_THAT(GainsSentences(gains), testing::ContainsRegex("helps window 0.0[78]"));
  EXPECT_THAT(GainsSentences(gains), HasSubstr(" more for window and 0.02"));
}

TEST(StudyGains, WithoutABaselineOrAValueThereIsNoTable) {
  const StudyResult study = MakeGainStudy({});
  StudyTableOptions options = GainOptions();
  const StudyGrid grid(study);
  // Nothing has this calibration.
  EXPECT_FALSE(CompareGains(grid, MetricOf("calibration.t_d.error"), options).has_value());
  options.compare = ComparedAxis::kEstimators;
  EXPECT_FALSE(CompareGains(grid, MetricOf("ate.position_m"), options).has_value());
  EXPECT_FALSE(HasTable(MakeStudyTables(study, options), "ate.position_m.gains"));
}

}  // namespace
}  // namespace duet
