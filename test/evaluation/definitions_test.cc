#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/dataset/ground_truth.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "evaluation/definitions/definitions_report.h"
#include "evaluation/definitions/nearest_index.h"
#include "evaluation/definitions/tool_pairs.h"
#include "test/evaluation/test_trajectories.h"

namespace duet {
namespace {

using DefinitionsJson = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

/// A walker along x at 1 m/s from `start`: the position names the time.
std::vector<StampedPose> LineFrom(Timestamp start, const std::vector<int>& stamps_ms) {
  std::vector<StampedPose> poses;
  for (const int ms : stamps_ms) {
    poses.push_back({start + ms * kMs, {}});
    poses.back().T_GB.p.x() = 1e-3 * ms;
  }
  return poses;
}

/// Without steps of way that rounding could decide: x is given.
std::vector<StampedPose> AlongX(const std::vector<double>& x) {
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < x.size(); ++i) {
    poses.push_back({static_cast<Timestamp>(i) * 100 * kMs, {}});
    poses.back().T_GB.p.x() = x[i];
  }
  return poses;
}

const std::filesystem::path kData = std::filesystem::path(DUET_SOURCE_DIR) / "test/evaluation/data";

/// Numbers to 1e-9, all else exactly; keys of `got` that `expected` lacks are not looked at.
void ExpectSameJson(const DefinitionsJson& expected, const DefinitionsJson& got,
                    const std::string& path) {
  if (expected.is_object()) {
    for (const auto& [key, value] : expected.items()) {
      ASSERT_TRUE(got.contains(key)) << path << "." << key;
      ExpectSameJson(value, got[key], path + "." + key);
    }
  } else if (expected.is_array()) {
    ASSERT_EQ(got.size(), expected.size()) << path;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ExpectSameJson(expected[i], got[i], path + "." + std::to_string(i));
    }
  } else if (expected.is_number_float()) {
    ASSERT_TRUE(got.is_number()) << path << ": " << got;
    const double value = expected.get<double>();
    EXPECT_NEAR(got.get<double>(), value, 1e-9 * std::max(1.0, std::abs(value))) << path;
  } else {
    EXPECT_EQ(got, expected) << path;
  }
}

class DefinitionsExample : public testing::TestWithParam<const char*> {
 protected:
  const DefinitionsJson expected_ =
      DefinitionsJson::parse(ReadTextFile(kData / "other_tools_expected.json"))[GetParam()];
  const std::vector<StampedPose> truth_ =
      ReadTrajectoryFile(kData / ("other_tools_" + std::string(GetParam()) + "_truth.tum")).poses;
  const std::vector<StampedPose> estimate_ =
      ReadTrajectoryFile(kData / ("other_tools_" + std::string(GetParam()) + "_estimate.tum"))
          .poses;
};

TEST_P(DefinitionsExample, NumbersAreThoseWorkedOutFromTheProgramsSources) {
  const auto lengths_m = expected_["lengths_m"].get<std::vector<double>>();
  EXPECT_EQ(expected_["definitions"].size(), 20u);
  for (const auto& [name, errors] : expected_["definitions"].items()) {
    const ToolDefinition definition = ParseToolDefinition(name);
    EXPECT_EQ(definition.Name(), name);
    ExpectSameJson(errors, ToolErrorsJson(EvaluateByTool(truth_, estimate_, definition, lengths_m)),
                   name);
  }
}

TEST_P(DefinitionsExample, PairsAreThoseWorkedOutFromTheProgramsSources) {
  for (const auto& [tool, pairs] : expected_["matches"].items()) {
    std::vector<StampMatch> matches;
    for (const auto& pair : pairs) matches.push_back({pair[0].get<int>(), pair[1].get<int>()});
    EXPECT_EQ(EvaluateByTool(truth_, estimate_, ParseToolDefinition(tool), {}).matches, matches)
        << tool;
  }
}

INSTANTIATE_TEST_SUITE_P(All, DefinitionsExample, testing::Values("gap", "fast"),
                         [](const auto& example) { return std::string(example.param); });

TEST(DefinitionsExamples, ShowWhatTheyAreFor) {
  // If the examples are made anew: they must go on to tell the programs apart.
  const auto example = [](const std::string& name, const std::string& tool) {
    return EvaluateByTool(
        ReadTrajectoryFile(kData / ("other_tools_" + name + "_truth.tum")).poses,
        ReadTrajectoryFile(kData / ("other_tools_" + name + "_estimate.tum")).poses,
        ParseToolDefinition(tool), std::vector<double>{2.0});
  };
  EXPECT_GT(example("gap", "evo").poses_matched_again, 0);
  EXPECT_EQ(example("gap", "rpg").poses_matched_again, 0);
  // Same pairs and alignment, yet rpg's segments are others after the gap.
  const ToolErrors rpg = example("gap", "rpg"), ov_eval = example("gap", "ov_eval");
  EXPECT_EQ(rpg.matches, ov_eval.matches);
  EXPECT_DOUBLE_EQ(rpg.position_m.rmse, ov_eval.position_m.rmse);
  EXPECT_GT(rpg.relative.back().translation_m.median,
            1.2 * ov_eval.relative.back().translation_m.median);
  // The estimate is denser than the truth: ov_eval does not take the nearest.
  EXPECT_NE(example("fast", "ov_eval").matches, example("fast", "rpg").matches);
  EXPECT_GT(
      std::abs(example("fast", "ov_eval").position_m.rmse / example("fast", "rpg").position_m.rmse -
               1.0),
      0.03);
}

TEST(StampMatching, EvoMayTakeAPoseTwice) {
  const auto near = MatchLikeEvo(LineFrom(0, {0, 10, 100, 200}), LineFrom(0, {8, 12, 111}));
  EXPECT_THAT(near, ElementsAre(StampMatch{0, 1}, StampMatch{1, 1}));
  // Longer, the estimate is the one that is searched; equally near: the first.
  const auto searched = MatchLikeEvo(LineFrom(0, {5, 11}), LineFrom(0, {0, 10, 20, 30}));
  EXPECT_THAT(searched, ElementsAre(StampMatch{0, 0}, StampMatch{1, 1}));
  EXPECT_TRUE(MatchLikeEvo({}, LineFrom(0, {1})).empty());
  EXPECT_TRUE(MatchLikeEvo(LineFrom(0, {1}), {}).empty());
}

TEST(StampMatching, RpgTakesTheClosestFirstAndEachOnce) {
  EXPECT_THAT(MatchLikeRpg(LineFrom(0, {0, 10, 100}), LineFrom(0, {7, 12})),
              ElementsAre(StampMatch{0, 0}, StampMatch{1, 1}));
  EXPECT_TRUE(MatchLikeRpg({}, LineFrom(0, {1})).empty());
}

TEST(StampMatching, OvEvalGivesATruePoseToTheFirstThatComesNear) {
  // 85 is 15 ms early and takes 100; 95, 105 and 115 find nothing; 181 is nearer to 200 than 185.
  EXPECT_THAT(MatchLikeOvEval(LineFrom(0, {100, 200}), LineFrom(0, {85, 95, 105, 115, 181, 185})),
              ElementsAre(StampMatch{0, 0}, StampMatch{4, 1}));
  // Of two true poses the nearer; the one passed over is lost to all later poses.
  EXPECT_THAT(MatchLikeOvEval(LineFrom(0, {90, 100, 110}), LineFrom(0, {99, 101, 102})),
              ElementsAre(StampMatch{0, 1}, StampMatch{1, 2}));
  EXPECT_TRUE(MatchLikeOvEval({}, LineFrom(0, {1})).empty());
}

TEST(StampMatching, BoundsAreEachProgramsOwn) {
  const auto truth = LineFrom(0, {0, 500, 1000});
  EXPECT_EQ(MatchLikeEvo(truth, LineFrom(0, {10})).size(), 1u);     // <=
  EXPECT_EQ(MatchLikeRpg(truth, LineFrom(0, {20})).size(), 0u);     // <
  EXPECT_EQ(MatchLikeOvEval(truth, LineFrom(0, {20})).size(), 0u);  // <
  EXPECT_EQ(MatchLikeRpg(truth, LineFrom(0, {19})).size(), 1u);
  EXPECT_EQ(MatchLikeOvEval(truth, LineFrom(0, {19})).size(), 1u);
}

TEST(StampMatching, OffsetsAreEachProgramsOwn) {
  const auto truth = LineFrom(0, {0, 100});
  const auto estimate = LineFrom(0, {1000, 1100});
  EXPECT_EQ(MatchLikeEvo(truth, estimate, 0.01, -1.0).size(), 2u);
  EXPECT_EQ(MatchLikeRpg(truth, estimate, 0.02, 1.0).size(), 2u);
  EXPECT_EQ(MatchLikeOvEval(truth, estimate, 0.02, -1.0).size(), 2u);
}

TEST(StampMatching, StampsAreTheDoublesNearestToTheirDecimals) {
  EXPECT_EQ(StampSeconds(1'140'000'000), 1.14);
  EXPECT_EQ(StampSeconds(kEpoch), 1403636583.763555584);
  EXPECT_EQ(StampSeconds(kEpoch + 1), 1403636583.763555585);
  EXPECT_EQ(StampSeconds(-2'500'000'000), -2.5);
  // At today's stamps a difference of 10 ms is seldom 0.01: here evo leaves the pair out.
  const auto truth = LineFrom(kEpoch, {0, 500, 1000});
  const bool within = StampSeconds(kEpoch + 10 * kMs) - StampSeconds(kEpoch) <= 0.01;
  EXPECT_EQ(MatchLikeEvo(truth, LineFrom(kEpoch, {10})).size(), within ? 1u : 0u);
}

TEST(NearestIndex, IsWhatExhaustiveSearchFinds) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<double> values;
    // Quarters: plenty of equal values, as way has at standstill, and of exact ties.
    for (int i = 0; i < 12; ++i) values.push_back(0.25 * std::round(random.Uniform(0.0, 16.0)));
    std::sort(values.begin(), values.end());
    const double target = 0.125 * std::round(random.Uniform(-4.0, 36.0));
    const int first = static_cast<int>(random.Uniform(0.0, 12.0));
    const auto off = [&](double value) { return std::abs(value - target); };
    int best = first;
    for (int i = first; i < 12; ++i) best = off(values[i]) < off(values[best]) ? i : best;
    ASSERT_EQ(NearestIndex(values, first, target, off), best) << trial;
  }
  EXPECT_EQ(NearestIndex({1.0}, 1, 0.0, [](double v) { return std::abs(v); }), -1);
}

TEST(ToolDefinitions, AfterAStartWithoutAnEndRpgTakesWrongStarts) {
  // Way 0 1 2 3, then a gap of 5 m, 8 9 10 11. Of length 2: from 2 and 3 on nothing is near 4 or 5;
  // ends are those of 0, 1 | 8, 9, but the third end (10) is laid to the third pose (2).
  const auto truth = AlongX({0, 1, 2, 3, 8, 9, 10, 11});
  auto estimate = truth;
  for (StampedPose& pose : estimate) pose.T_GB.p.x() *= 1.1;  // an error of a tenth of the way
  const auto at_2m = [&](const std::string& name) {
    return EvaluateByTool(truth, estimate, ParseToolDefinition(name), std::vector<double>{2.0})
        .relative.back();
  };
  const ToolRelativeErrors rpg = at_2m("rpg:none");
  EXPECT_EQ(rpg.segments, 4);
  EXPECT_NEAR(rpg.translation_m.max, 0.1 * 8.0, 1e-12);  // from 2 to 10 and from 3 to 11
  EXPECT_NEAR(rpg.translation_m.mean, 0.1 * (2 + 2 + 8 + 8) / 4, 1e-12);
  const ToolRelativeErrors ov_eval = at_2m("ov_eval:none");
  EXPECT_EQ(ov_eval.segments, 4);
  EXPECT_NEAR(ov_eval.translation_m.max, 0.1 * 2.0, 1e-12);
}

TEST(ToolDefinitions, EvoChoosesSegmentsOnTheEstimate) {
  // The estimate's metres are twice too many: 2 m of its way are 1 m of the truth's.
  const auto truth = AlongX({0, 1, 2, 3, 4, 5, 6});
  auto estimate = truth;
  for (StampedPose& pose : estimate) pose.T_GB.p.x() *= 2.0;
  const ToolErrors errors =
      EvaluateByTool(truth, estimate, ParseToolDefinition("evo:none"), std::vector<double>{4.0});
  ASSERT_EQ(errors.relative.size(), 3u);
  const ToolRelativeErrors& frames = errors.relative[0];
  EXPECT_TRUE(frames.in_frames && frames.own_default && !frames.all_pairs);
  EXPECT_EQ(frames.segments, 6);
  const ToolRelativeErrors& all = errors.relative[1];
  EXPECT_EQ(all.segments, 5);
  EXPECT_NEAR(all.translation_m.max, 2.0, 1e-12);  // over 2 m of truth, not 4
  // Consecutive: kept are 2, 4, 6: what lies before the first is in no segment.
  EXPECT_FALSE(errors.relative[2].all_pairs);
  EXPECT_EQ(errors.relative[2].segments, 2);
}

TEST(ToolDefinitions, WhereTheProgramsStopTheySaySo) {
  const auto truth = LineFrom(0, {0, 100, 200, 300});
  const auto refused = [&](const std::vector<StampedPose>& estimate, const std::string& name) {
    const ToolErrors errors = EvaluateByTool(truth, estimate, ParseToolDefinition(name), {});
    EXPECT_TRUE(errors.refused.empty() || errors.position_m.count == 0);
    return errors.refused;
  };
  const auto elsewhere = LineFrom(kEpoch, {0, 100});
  for (const char* tool : {"evo", "rpg", "ov_eval"}) {
    EXPECT_THAT(refused(elsewhere, tool), HasSubstr("no stamps")) << tool;
    if (tool == std::string("rpg")) break;
  }
  EXPECT_THAT(refused(elsewhere, "ov_eval"), HasSubstr("fewer than three"));
  EXPECT_THAT(refused(LineFrom(0, {0, 100}), "ov_eval"), HasSubstr("fewer than three"));
  EXPECT_THAT(refused(truth, "evo:se3"), HasSubstr("line"));
  EXPECT_EQ(refused(truth, "evo:origin"), "");
  EXPECT_THAT(refused(truth, "rpg:posyaw:5"), HasSubstr("fewer pairs"));
  EXPECT_EQ(refused(truth, "rpg:posyaw:4"), "");
}

TEST(ToolDefinitions, WhatAnAlignmentTakesOutChangesNothing) {
  Random random(7);
  const std::vector<StampedPose> truth = Walk(30.0, 20.0);
  const std::vector<StampedPose> estimate =
      WithNoise(Walk(29.0, 33.0, kEpoch + 3 * kMs), 0.03, 0.01, &random);
  const Eigen::Vector3d p(4.0, -3.0, 2.0);
  const Eigen::Quaterniond yaw = YawRotation(1.1);
  const Eigen::Quaterniond R = RandomRotation(&random);
  struct Case {
    const char* definition;
    Eigen::Quaterniond R;
    double scale;
  };
  const std::vector<double> lengths_m = {3.0};
  for (const Case& c : std::vector<Case>{{"evo:origin", R, 1.0},
                                         {"evo:se3", R, 1.0},
                                         {"evo:se3:50", R, 1.0},
                                         {"evo:sim3", R, 0.7},
                                         {"rpg:posyaw", yaw, 1.0},
                                         {"rpg:posyaw:1", yaw, 1.0},
                                         {"rpg:se3", R, 1.0},
                                         {"rpg:se3:1", R, 1.0},
                                         {"rpg:sim3", R, 1.4},
                                         {"ov_eval:posyaw", yaw, 1.0},
                                         {"ov_eval:posyawsingle", yaw, 1.0},
                                         {"ov_eval:se3", R, 1.0},
                                         {"ov_eval:se3single", R, 1.0},
                                         {"ov_eval:sim3", R, 1.4}}) {
    const ToolDefinition definition = ParseToolDefinition(c.definition);
    const ToolErrors errors = EvaluateByTool(truth, estimate, definition, lengths_m);
    const ToolErrors moved =
        EvaluateByTool(truth, Moved(estimate, c.R, p, c.scale), definition, lengths_m);
    EXPECT_GT(errors.position_m.rmse, 0.01) << c.definition;
    EXPECT_NEAR(moved.position_m.rmse, errors.position_m.rmse, 1e-9) << c.definition;
    EXPECT_NEAR(moved.position_m.max, errors.position_m.max, 1e-9) << c.definition;
    EXPECT_NEAR(moved.orientation_deg.rmse, errors.orientation_deg.rmse, 1e-7) << c.definition;
    const ToolRelativeErrors& relative = errors.relative.back();
    EXPECT_EQ(moved.relative.back().segments, relative.segments) << c.definition;
    EXPECT_NEAR(moved.relative.back().translation_m.mean, relative.translation_m.mean, 1e-9)
        << c.definition;
    EXPECT_NEAR(moved.relative.back().rotation_deg.mean, relative.rotation_deg.mean, 1e-7)
        << c.definition;
    EXPECT_NEAR(moved.alignment.scale * c.scale, errors.alignment.scale, 1e-9) << c.definition;
  }
}

TEST(ToolDefinitions, NumbersThatAreNoneSpoilTheirOwnSummaryOnly) {
  // Both start at the origin: rpg's scale there is 0 / 0.
  const auto truth = Moved(Walk(5.0, 20.0), Eigen::Quaterniond::Identity(), -WalkPose(0.0).p);
  const ToolErrors errors = EvaluateByTool(truth, truth, ParseToolDefinition("rpg:none"), {});
  EXPECT_EQ(errors.further[0].name, "scale_percent");
  EXPECT_EQ(errors.further[0].summary.count, 101);
  EXPECT_TRUE(std::isnan(errors.further[0].summary.median));
  EXPECT_EQ(errors.position_m.max, 0.0);
}

TEST(ToolDefinitions, NamesAreReadAndWrittenAlike) {
  EXPECT_EQ(ParseToolDefinition("evo").Name(), "evo:se3");
  EXPECT_EQ(ParseToolDefinition("rpg").Name(), "rpg:posyaw");
  EXPECT_EQ(ParseToolDefinition("ov_eval").Name(), "ov_eval:posyaw");
  EXPECT_EQ(AllToolDefinitions().size(), 3u);
  EXPECT_EQ(ParseToolDefinition("rpg:se3:1").DuetAlignment(), AlignmentMode::kFirstPose);
  EXPECT_EQ(ParseToolDefinition("rpg:se3:2").DuetAlignment(), std::nullopt);
  EXPECT_EQ(ParseToolDefinition("ov_eval:se3single").DuetAlignment(), AlignmentMode::kFirstPose);
  EXPECT_EQ(ParseToolDefinition("evo:scale").DuetAlignment(), std::nullopt);
  const auto message = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(ParseToolDefinition(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("tum"), HasSubstr("evo, rpg, ov_eval"));
  EXPECT_THAT(message(""), HasSubstr("--definition"));
  EXPECT_THAT(message("evo:posyaw"), HasSubstr("se3, sim3, origin, scale, none"));
  EXPECT_THAT(message("rpg:posyaw:"), HasSubstr("number of poses"));
  EXPECT_THAT(message("rpg:posyaw:0"), HasSubstr("from 1 on"));
  EXPECT_THAT(message("rpg:sim3:1"), HasSubstr("from 2 on"));
  EXPECT_THAT(message("evo:se3:1"), HasSubstr("from 2 on"));
  EXPECT_THAT(message("ov_eval:se3:5"), HasSubstr("no number of poses"));
  EXPECT_THAT(message("evo:se3:5:6"), HasSubstr("number of poses"));
}

TEST(ToolDefinitions, AgreeWithDuetWhereNothingIsLeftToDefine) {
  // The same stamps, no gap, one alignment: positions are alike to the last digits.
  Random random(11);
  const NamedTrajectory truth{"truth", Walk(20.0, 20.0)};
  const NamedTrajectory estimate{
      "estimate", Moved(WithNoise(truth.poses, 0.02, 0.01, &random), YawRotation(0.4),
                        Eigen::Vector3d(1.0, 2.0, 3.0))};
  const Evaluation evaluation = Evaluate(truth, {estimate}, {});
  const auto comparisons =
      CompareDefinitions(truth, {estimate}, evaluation,
                         {ParseToolDefinition("evo:sim3"), ParseToolDefinition("rpg"),
                          ParseToolDefinition("ov_eval"), ParseToolDefinition("rpg:posyaw:9")});
  ASSERT_EQ(comparisons.size(), 1u);
  const DefinitionComparison& comparison = comparisons[0];
  for (int i = 0; i < 3; ++i) {
    const AbsoluteErrors& alike = comparison.duet_aligned_alike[i];
    const ToolErrors& tool = comparison.tools[i];
    EXPECT_EQ(tool.position_m.count, 401);
    EXPECT_NEAR(tool.position_m.rmse, alike.position_m.rmse, 1e-12) << i;
    EXPECT_NEAR(tool.position_m.max, alike.position_m.max, 1e-12) << i;
    EXPECT_NEAR(tool.orientation_deg.rmse, alike.orientation_by_positions_deg.rmse, 1e-9) << i;
  }
  EXPECT_EQ(comparison.duet_aligned_alike[3].position_m.count, 0);

  const std::string text = DefinitionsText(evaluation, comparisons);
  EXPECT_THAT(text, HasSubstr("duet:posyaw"));
  EXPECT_THAT(text, HasSubstr("rpg:posyaw:9"));
  EXPECT_THAT(text, HasSubstr("Why they differ"));
  EXPECT_THAT(text, HasSubstr("evo: 1 frame, consecutive"));
  DefinitionsJson json = EvaluationJson(evaluation);
  AddDefinitionsJson(comparisons, &json);
  EXPECT_NEAR(json["estimate"]["definitions"]["rpg:posyaw"]["position_m"]["rmse"],
              json["estimate"]["ate"]["position_m"], 1e-12);
}

}  // namespace
}  // namespace duet
