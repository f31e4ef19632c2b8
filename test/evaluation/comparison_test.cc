#include "evaluation/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "evaluation/requirements.h"
#include "test/evaluation/test_trajectories.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::Not;

Comparison Example() {
  Random random(1);
  const NamedTrajectory truth{"truth", Walk(10.0, 200.0)};
  const NamedTrajectory msckf{"msckf", WithNoise(Walk(10.0, 20.0), 0.01, 0.005, &random)};
  NamedTrajectory window{"window", WithNoise(Walk(10.0, 20.0), 0.02, 0.01, &random)};
  window.poses.erase(window.poses.begin() + 100, window.poses.begin() + 120);
  Comparison comparison;
  comparison.dataset = "walk";
  comparison.cameras = "0";
  comparison.start = "ground truth";
  comparison.tracks_sha256 = "abc";
  comparison.evaluation = Evaluate(truth, {msckf, window}, {});
  comparison.frontend = FrontendRun{.frames = 201, .tracking_ms = Summarize({1.0, 2.0, 3.0})};
  EstimatorRun run;
  run.status = "tracking";
  run.frames = 201;
  run.estimator_ms = Summarize({2.0, 4.0});
  run.peak_memory_mb = 40.0;
  run.nees = {{NeesBlock::kPose, 160, 6.2, 5.3}};
  run.settings = {{"first estimates", "yes"}};
  comparison.runs = {run, run};
  comparison.runs[1].status = "failed";
  comparison.runs[1].reason = "cost is not finite";
  comparison.runs[1].failed_at_s = 9.5;
  comparison.runs[1].settings = {{"first estimates", "no"}, {"robust loss", "huber"}};
  return comparison;
}

TEST(Comparison, JsonHasTheFieldsThatThePromiseNames) {
  const Comparison comparison = Example();
  const auto json = ComparisonJson(comparison);
  for (const char* name : {"msckf", "window"}) {
    const auto& e = json.at(name);
    EXPECT_TRUE(e.at("ate").at("position_m").is_number());
    EXPECT_TRUE(e.at("ate").at("orientation_deg").is_number());
    EXPECT_TRUE(e.at("ate").at("tilt_deg").is_number());
    EXPECT_TRUE(e.at("coverage_s").is_number());
    EXPECT_TRUE(e.at("estimator_ms").at("median").is_number());
    EXPECT_TRUE(e.at("estimator_ms").at("p99").is_number());
    EXPECT_TRUE(e.at("peak_memory_mb").is_number());
    EXPECT_TRUE(e.at("status").is_string());
  }
  EXPECT_EQ(json.at("msckf").at("ate").at("position_m").get<double>(),
            comparison.evaluation.estimates[0].absolute.position_m.rmse);
  EXPECT_EQ(json.at("frontend").at("tracking_ms").at("median").get<double>(), 2.0);
  EXPECT_TRUE(json.at("frontend").at("tracking_ms").at("p99").is_number());
  EXPECT_EQ(json.at("tracks_sha256").get<std::string>(), "abc");
  EXPECT_EQ(json.at("window").at("gaps").size(), 1u);
  EXPECT_EQ(json.at("msckf").at("nees").at("pose").at("mean").get<double>(), 6.2);
  // Text that reads back to the same numbers, and is the same every time.
  const std::string text = json.dump(2);
  EXPECT_EQ(nlohmann::ordered_json::parse(text), json);
  EXPECT_EQ(text, ComparisonJson(Example()).dump(2));
}

TEST(Comparison, TableSaysErrorsCoverageFailureAndWhatWasOn) {
  const std::string text = ComparisonText(Example());
  for (const char* part :
       {"msckf", "window", "position rmse [m]", "covered [%]", "100.0", "cost is not finite",
        "failed at 9.50 s", "tracks SHA-256: abc", "first estimates", "robust loss", "huber",
        "gap in the estimate from 4.950 s to 6.000 s", "pose, expected 6", "How to read"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

TEST(Comparison, AnEstimatorWithoutPosesIsAResult) {
  const NamedTrajectory truth{"truth", Walk(10.0, 200.0)};
  Comparison comparison = Example();
  comparison.evaluation = Evaluate(truth, {{"msckf", Walk(10.0, 20.0)}, {"window", {}}}, {});
  const auto json = ComparisonJson(comparison);
  EXPECT_TRUE(json.at("window").at("ate").at("position_m").is_null());
  EXPECT_EQ(json.at("window").at("coverage_s").get<double>(), 0.0);
  EXPECT_THAT(json.at("window").at("alignment").at("refused").get<std::string>(),
              HasSubstr("no estimated pose"));
  EXPECT_LT(json.at("msckf").at("ate").at("position_m").get<double>(), 1e-3);
  EXPECT_THAT(ComparisonText(comparison), HasSubstr("window: no position error"));
  const auto outcome = EvaluateRequirement(ParseRequirement("window.ate.position_m<1"), json);
  EXPECT_FALSE(outcome.met);
  EXPECT_THAT(outcome.text, HasSubstr("not known"));
}

TEST(Requirements, OperatorsAndBlanks) {
  nlohmann::ordered_json json;
  json["a"]["b"] = 2.0;
  json["a"]["name"] = "tracking";
  json["list"] = {{{"x", 1}}, {{"x", 5}}};
  json["file.txt"]["n"] = 3;
  const auto met = [&](const char* text) {
    return EvaluateRequirement(ParseRequirement(text), json).met;
  };
  EXPECT_TRUE(met("a.b<2.5"));
  EXPECT_FALSE(met("a.b<2"));
  EXPECT_TRUE(met("a.b <= 2"));
  EXPECT_FALSE(met("a.b>2"));
  EXPECT_TRUE(met("a.b>=2"));
  EXPECT_TRUE(met("a.b==2.0"));
  EXPECT_FALSE(met("a.b==2.1"));
  EXPECT_TRUE(met("a.b > -1e3"));
  EXPECT_TRUE(met("a.name==tracking"));
  EXPECT_FALSE(met("a.name==failed"));
  EXPECT_FALSE(met("a.name<3"));
  EXPECT_TRUE(met("list.1.x==5"));
  EXPECT_TRUE(met("file.txt.n==3"));
}

TEST(Requirements, MistakesNameWhatWasMeant) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      CheckRequirementPath(ParseRequirement(text), ComparisonTemplate({"msckf", "window"}), true);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("msckf.ate.position_m<0.01"), "");
  EXPECT_EQ(message("frontend.tracking_ms.p99<6"), "");
  EXPECT_EQ(message("window.nees.pose.mean<7"), "");
  EXPECT_EQ(message("window.relative.1.translation_percent.median<1"), "");
  EXPECT_EQ(message("window.stages_ms.solve<10"), "");
  EXPECT_THAT(message("msckf.ate.positon_m<0.01"), HasSubstr("msckf.ate.position_m"));
  EXPECT_THAT(message("mskf.ate.position_m<0.01"), HasSubstr("'msckf.ate.position_m'"));
  EXPECT_THAT(message("msckf.ate<0.01"), HasSubstr("it goes on with \".position_m\""));
  for (const char* bad : {"msckf.ate.position_m", "<0.1", "a<", "a=1", "a<b", "a<nan", ""}) {
    EXPECT_THAT(message(bad), HasSubstr("--require: expected PATH<BOUND")) << bad;
  }
}

TEST(Evaluate, SpanIsCutAndCoverageIsItsShare) {
  const NamedTrajectory truth{"truth", Walk(10.0, 200.0)};
  EvaluationOptions options;
  options.start = kEpoch + 2 * kSecond;
  options.end = kEpoch + 6 * kSecond;
  std::vector<StampedPose> half = Walk(10.0, 20.0);
  half.resize(81);  // to 4 s
  const Evaluation evaluation =
      Evaluate(truth, {{"all", Walk(10.0, 20.0)}, {"half", half}}, options);
  EXPECT_NEAR(evaluation.span_s(), 4.0, 1e-12);
  EXPECT_NEAR(evaluation.estimates[0].coverage_share, 1.0, 1e-12);
  EXPECT_NEAR(evaluation.estimates[1].coverage_share, 0.5, 1e-12);
  EXPECT_EQ(evaluation.estimates[0].association.estimate_count, 81);
}

TEST(Evaluate, InputThatCannotBeMeantIsRefused) {
  const NamedTrajectory truth{"truth", Walk(10.0, 200.0)};
  const NamedTrajectory one{"one", Walk(10.0, 20.0)};
  EXPECT_THROW((void)Evaluate(truth, {one, one}, {}), InputError);
  EvaluationOptions backwards;
  backwards.start = 5;
  backwards.end = 4;
  EXPECT_THROW((void)Evaluate(truth, {one}, backwards), InputError);
  const NamedTrajectory elsewhere{"elsewhere", Walk(10.0, 20.0, 0)};
  EXPECT_NO_THROW(RequireOverlap(Evaluate(truth, {one}, {})));
  try {
    RequireOverlap(Evaluate(truth, {elsewhere}, {}));
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("elsewhere"));
  }
  EXPECT_THROW((void)EvaluationJson(Evaluate(truth, {{"evaluation", one.poses}}, {})), InputError);
}

TEST(Evaluate, TextAndJsonOfForeignTrajectories) {
  const NamedTrajectory truth{"gt.tum", Walk(10.0, 200.0)};
  EvaluationOptions options;
  options.alignment = AlignmentMode::kSim3;
  const Eigen::Quaterniond R = ExpQuaternion({1.0, 2.0, 0.5});
  const auto estimate = Moved(Walk(10.0, 20.0), R, {1, 2, 3}, 0.5);
  const Evaluation evaluation = Evaluate(truth, {{"orb.txt", estimate}}, options);
  const std::string text = EvaluationText(evaluation);
  EXPECT_THAT(text, HasSubstr("orb.txt"));
  EXPECT_THAT(text, HasSubstr("2.00"));  // the scale that brings it back, found to 1e-4
  const auto json = EvaluationJson(evaluation);
  EXPECT_NEAR(json.at("orb.txt").at("alignment").at("scale").get<double>(), 2.0, 1e-3);
  EXPECT_TRUE(EvaluateRequirement(ParseRequirement("orb.txt.ate.position_m<1e-3"), json).met);
}

TEST(Evaluate, AtStandstillTheDriftIsShown) {
  auto truth = Walk(3.0, 20.0);
  for (StampedPose& pose : truth) pose.T_GB = Pose{};
  auto estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].T_GB.p.z() = 0.02 * static_cast<double>(i) / 60.0;
  }
  const Evaluation evaluation = Evaluate({"truth", truth}, {{"rest", estimate}}, {});
  const auto json = EvaluationJson(evaluation);
  EXPECT_TRUE(json.at("rest").at("ate").at("position_m").is_null());
  EXPECT_NEAR(json.at("rest").at("drift").at("position_max_m").get<double>(), 0.02, 1e-12);
  EXPECT_NEAR(json.at("rest").at("drift_of_truth").at("position_max_m").get<double>(), 0.0, 1e-12);
  EXPECT_THAT(EvaluationText(evaluation), HasSubstr("drift from the own first pose"));
}

}  // namespace
}  // namespace duet
