#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "common/support/input_error.h"
#include "experiments/study/study_plan.h"
#include "experiments/study/tuning_file.h"
#include "experiments/study/tuning_result.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using testing::ThrowsMessage;

std::string TuningText(const std::string& seeds, const std::string& budget,
                       const std::string& search) {
  return "tuning: t\nstreams: [{name: room, simulate: room_easy}]\nseeds: " + seeds +
         "\nreport_seeds: 1..9\nbudget: " + budget + "\nobjective: ate.position_m\nsearch:\n" +
         search;
}
const std::string kSearch =
    "  shared: {shared.pixel_noise_px: [0.7, 1, 2]}\n"
    "  msckf: {msckf.max_clones: [5, 8, 12, 20]}\n"
    "  window: {window.max_frames: [5, 8], window.max_iterations: [2, 4, 8]}\n";

TuningFile ParseTuning(const std::string& yaml, bool quick = false) {
  return ParseTuningFile(yaml, "t.yaml", quick);
}

std::string ValueOf(const StudyChange& trial, const std::string& estimator,
                    const std::string& name) {
  for (const StudyKey& key : trial.only.at(estimator)) {
    if (key.key == name) return key.value.scalar;
  }
  return "";
}

TEST(TuningTest, TheEffortIsEqualAndEveryTrialIsAnother) {
  const TuningFile tuning = ParseTuning(TuningText("11..12", "10", kSearch));
  ASSERT_THAT(tuning.study.settings, SizeIs(10));
  EXPECT_TRUE(tuning.study.settings[0].only.empty());  // the defaults
  const StudyPlan plan = MakeStudyPlan(tuning.study, "");
  std::map<std::string, std::set<std::string>> ids;
  for (const PlannedRun& run : plan.runs) ids[run.estimator].insert(run.id);
  // A trial may be what the defaults are, and share their records.
  EXPECT_GE(ids["msckf"].size(), 18U);
  EXPECT_GE(ids["window"].size(), 18U);
  EXPECT_LE(ids["msckf"].size(), 20U);
}

TEST(TuningTest, WhatIsSharedIsTheSameForBothInATrial) {
  const TuningFile tuning = ParseTuning(TuningText("11..12", "12", kSearch));
  std::set<std::string> values;
  for (std::size_t i = 1; i < tuning.study.settings.size(); ++i) {
    const StudyChange& trial = tuning.study.settings[i];
    values.insert(ValueOf(trial, "msckf", "shared.pixel_noise_px"));
    EXPECT_EQ(ValueOf(trial, "msckf", "shared.pixel_noise_px"),
              ValueOf(trial, "window", "shared.pixel_noise_px"));
  }
  EXPECT_THAT(values, SizeIs(3));
}

TEST(TuningTest, ASearchSaysTheSameTwiceAndGrowsWithItsBudget) {
  const StudyFile small = ParseTuning(TuningText("11..12", "5", kSearch)).study;
  const StudyFile large = ParseTuning(TuningText("11..12", "9", kSearch)).study;
  for (std::size_t i = 1; i < small.settings.size(); ++i) {
    EXPECT_EQ(ValueOf(small.settings[i], "window", "window.max_frames"),
              ValueOf(large.settings[i], "window", "window.max_frames"));
  }
}

std::string TextOn(const std::string& stream, const std::string& more) {
  std::string text = TuningText("11..12", "4", kSearch);
  const std::string room = "{name: room, simulate: room_easy}";
  return text.replace(text.find(room), room.size(), stream) + more;
}
std::string WithObjective(const std::string& objective) {
  std::string text = TuningText("11..12", "4", kSearch);
  return text.replace(text.find("ate.position_m"), 14, objective);
}

TEST(TuningTest, ARecordingIsReportedOnAnotherOrAnotherPart) {
  const TuningFile tuning = ParseTuning(
      TextOn("{name: a, dataset: MH, duration_s: 30}",
             "report_streams: [{name: b, dataset: MH, starts_s: [30]}, {name: c, dataset: V1}]\n"));
  ASSERT_THAT(tuning.report_streams, SizeIs(2));
  EXPECT_THAT(TuningYaml(tuning), HasSubstr("report_streams:\n  - name: \"b\"\n"));
}

struct BadTuning {
  std::string yaml;
  std::string error;
};
class BadTuningTest : public testing::TestWithParam<BadTuning> {};
TEST_P(BadTuningTest, IsRefused) {
  EXPECT_THAT([] { ParseTuning(GetParam().yaml); },
              ThrowsMessage<InputError>(HasSubstr(GetParam().error)));
}
INSTANTIATE_TEST_SUITE_P(
    All, BadTuningTest,
    testing::Values(
        BadTuning{TuningText("5..12", "4", kSearch), "seeds that the search has too"},
        BadTuning{TuningText("11..12", "13", kSearch), "msckf has fewer combinations"},
        BadTuning{TuningText("11..12", "1", kSearch), "budget: expected an integer from 2"},
        BadTuning{TuningText("11..12", "4", "  msckv: {}\n"), "did you mean 'msckf'?"},
        BadTuning{TuningText("11..12", "4", "  msckf: {window.max_frames: [5, 8]}\n"),
                  "search.msckf.window.max_frames: has no place here"},
        BadTuning{TuningText("11..12", "4", "  msckf: {msckf.max_clones: 5}\n"),
                  "expected a list of at least two values"},
        BadTuning{TuningText("11..12", "4", kSearch) + "settings: [{name: a}]\n",
                  "settings: has no place"},
        BadTuning{TuningText("11..12", "4",
                             kSearch + "report_streams: [{name: same, simulate: "
                                       "room_easy, simulation_seed: 12}]\n"),
                  "'same' of the report is what the search runs on"},
        BadTuning{TextOn("{name: a, dataset: MH, starts_s: [0, 9]}", ""),
                  "'a' of the report is what the search runs on"},
        BadTuning{TextOn("{name: a, dataset: MH, duration_s: 30}",
                         "report_streams: [{name: b, dataset: ./MH, starts_s: [29]}]\n"),
                  "'b' of the report is what the search runs on"},
        BadTuning{WithObjective("ate.position"),
                  "objective: no metric is called 'ate.position'; "
                  "did you mean 'ate.position_m'?"},
        BadTuning{WithObjective("nees.calibration"), "does not tell which of two values"},
        BadTuning{TuningText("11..12", "20",
                             "  shared: {shared.pixel_noise_px: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]}\n"
                             "  msckf: {msckf.max_clones: [5, 8]}\n"
                             "  window: {window.max_frames: [5, 8]}\n"),
                  "budget: msckf has no combination left for trial"},
        BadTuning{TuningText("11..12", "4", kSearch) + "sed: 3\n", "sed: unknown key"}));

StudyRun RunOf(const std::string& setting, int seed, double ate, bool failed = false,
               double coverage = 1.0) {
  StudyRun run;
  run.id = setting + std::to_string(seed);
  run.stream = "room";
  run.estimator = "msckf";
  run.setting = setting;
  run.perturbation = "none";
  run.seed = seed;
  run.failed = failed;
  run.metrics = {{"ate.position_m", ate}, {"coverage_share", coverage}};
  return run;
}

TEST(TuningTest, TheBestCoversFailsNotAndIsBetterSeedBySeed) {
  StudyResult result;
  result.runs = {RunOf("default", 1, 0.1), RunOf("default", 2, 0.4),
                 // Twice as good on the easy seed, half as good on the hard one: no better.
                 RunOf("a", 1, 0.05), RunOf("a", 2, 0.8),
                 // Better on both.
                 RunOf("b", 1, 0.09), RunOf("b", 2, 0.36),
                 // Still better, but one run failed; but it covers half.
                 RunOf("c", 1, 0.01), RunOf("c", 2, 0.01, true), RunOf("d", 1, 0.01, false, 0.5),
                 RunOf("d", 2, 0.01, false, 0.5)};
  const std::vector<TuningTrial> trials = TuningTrials(result, "ate.position_m");
  ASSERT_THAT(trials, SizeIs(5));
  EXPECT_DOUBLE_EQ(trials[0].ratio, 1.0);
  EXPECT_NEAR(trials[1].ratio, 1.0, 1e-12);
  EXPECT_NEAR(trials[2].ratio, 0.9, 1e-12);
  EXPECT_EQ(trials[3].failed, 1);
  EXPECT_EQ(BestTrial(trials, "msckf").setting, "b");
}

StudyRun WithMetric(const std::string& setting, const std::string& key, double value) {
  StudyRun run = RunOf(setting, 1, 0.1);
  run.metrics.emplace_back(key, value);
  return run;
}

// Below 1 is better, whichever way the metric goes.
TEST(TuningTest, TheRatioFollowsTheMetricsDirection) {
  const auto ratio = [](const std::string& key, double of_default, double of_trial) {
    StudyResult result;
    result.runs = {WithMetric("default", key, of_default), WithMetric("a", key, of_trial)};
    return TuningTrials(result, key)[1].ratio;
  };
  EXPECT_NEAR(ratio("calibration.t_d.error", -0.002, 0.001), 0.5, 1e-12);
  EXPECT_NEAR(ratio("nees.pose", 12.0, 3.0), 1.0, 1e-12);  // twice too sure, twice too unsure
  EXPECT_NEAR(ratio("nees.pose", 12.0, 6.0), 0.5, 1e-12);
  EXPECT_NEAR(ratio("nees.pose", 6.0, 1.0), 6.0, 1e-12);
}

TEST(TuningTest, ASearchsFolderThatContradictsItselfIsRefused) {
  const TuningReport report =
      ParseTuningYaml(TuningYaml(ParseTuning(TuningText("11..12", "2", kSearch))), "t.yaml");
  EXPECT_EQ(report.objective, "ate.position_m");
  EXPECT_EQ(report.seeds.last, 9);
  StudyFolder folder;
  folder.study = ParseStudyFile(
      "study: s\nstreams: [{name: room, simulate: room_easy}]\nestimators: [msckf]\n"
      "settings: [{name: default}, {name: a}]\n",
      "s.yaml", false);
  folder.result.runs = {RunOf("default", 1, 0.1), RunOf("a", 1, 0.2)};
  EXPECT_THAT(TuningTexts(folder, report), SizeIs(3));
  StudyFolder with_more = folder;
  with_more.result.runs.push_back(RunOf("b", 1, 0.2));
  EXPECT_THAT([&] { (void)TuningTexts(with_more, report); },
              ThrowsMessage<InputError>(HasSubstr("settings: has no 'b', which plan.csv has")));
  folder.study.estimators.push_back("window");
  EXPECT_THAT([&] { (void)TuningTexts(folder, report); },
              ThrowsMessage<InputError>(HasSubstr("has window, of which plan.csv has no run")));
  for (const char* yaml : {"objective: a\nreport_seeds: 1..2\n", "objective: ate.position_m\n",
                           "objective: ate.position_m\nreport_seeds: 2..1\n",
                           "objective: ate.position_m\nreport_seeds: 1..2\nreport_streams: 3\n"}) {
    EXPECT_THROW((void)ParseTuningYaml(yaml, "t.yaml"), InputError) << yaml;
  }
}

TEST(TuningTest, ARunWithoutTheObjectiveHasNotFailed) {
  StudyResult result;
  result.runs = {WithMetric("default", "calibration.t_d.error", 0.1), RunOf("a", 1, 0.1)};
  const TuningTrial trial = TuningTrials(result, "calibration.t_d.error")[1];
  EXPECT_EQ(trial.failed, 0);
  EXPECT_EQ(trial.without, 1);
  result.runs = {RunOf("default", 1, 0.1)};
  EXPECT_THAT([&] { (void)TuningTrials(result, "calibration.t_d.error"); },
              ThrowsMessage<InputError>(HasSubstr("no run holds 'calibration.t_d.error'")));
}

}  // namespace
}  // namespace duet
