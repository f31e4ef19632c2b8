#include "evaluation/association.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/support/input_error.h"
#include "evaluation/errors.h"
#include "test/evaluation/test_trajectories.h"

namespace duet {
namespace {

StampedPose At(Timestamp t, double x) {
  StampedPose pose{t, {}};
  pose.T_GB.p.x() = x;
  return pose;
}

/// A walker along x at 1 m/s: the position names the time.
std::vector<StampedPose> Line(const std::vector<int>& stamps_ms) {
  std::vector<StampedPose> poses;
  for (const int ms : stamps_ms) poses.push_back(At(kEpoch + ms * kMs, 1e-3 * ms));
  return poses;
}

std::vector<int> Milliseconds(const std::vector<PosePair>& pairs, bool of_truth) {
  std::vector<int> ms;
  for (const PosePair& pair : pairs) {
    ms.push_back(
        static_cast<int>(std::lround(1e3 * (of_truth ? pair.T_GB_true : pair.T_EB).p.x())));
  }
  return ms;
}

TEST(Association, TruthIsInterpolatedAtTheEstimatesStamps) {
  std::vector<StampedPose> truth = Line({0, 50});
  truth[1].T_GB.R = ExpQuaternion({0.0, 0.0, 0.5});
  const Association a = Associate(truth, Line({10, 35}), {});
  ASSERT_EQ(a.pairs.size(), 2u);
  EXPECT_NEAR(a.pairs[0].T_GB_true.p.x(), 0.010, 1e-15);
  EXPECT_NEAR(a.pairs[1].T_GB_true.p.x(), 0.035, 1e-15);
  EXPECT_NEAR(BoxMinus(a.pairs[1].T_GB_true.R, ExpQuaternion({0, 0, 0.35})).norm(), 0.0, 1e-15);
  EXPECT_EQ(a.pairs[1].timestamp, kEpoch + 35 * kMs);
  EXPECT_DOUBLE_EQ(a.MatchedShare(), 1.0);
}

TEST(Association, TruthGapsAreNotBridgedAndAreListed) {
  // The truth has nothing between 100 and 200 ms; the estimate goes on at 20 Hz.
  const auto truth = Line({0, 50, 100, 200, 250, 300});
  const Association a = Associate(truth, Line({0, 50, 100, 150, 200, 250, 300, 350}), {});
  EXPECT_THAT(Milliseconds(a.pairs, true), testing::ElementsAre(0, 50, 100, 200, 250, 300));
  EXPECT_EQ(a.outside_truth, 1);
  EXPECT_EQ(a.in_truth_gap, 1);
  EXPECT_DOUBLE_EQ(a.MatchedShare(), 6.0 / 8.0);
  EXPECT_NEAR(a.coverage_s, 0.2, 1e-12);
  ASSERT_EQ(a.gaps.size(), 1u);
  EXPECT_EQ(a.gaps[0].start, kEpoch + 100 * kMs);
  EXPECT_EQ(a.gaps[0].end, kEpoch + 200 * kMs);
  EXPECT_EQ(a.gaps[0].cause, TimeGap::Cause::kTruth);
}

TEST(Association, AGapOfExactlyTheBoundIsBridged) {
  const auto estimate = Line({30});
  EXPECT_EQ(Associate(Line({0, 60}), estimate, {}).pairs.size(), 1u);
  EXPECT_EQ(Associate(Line({0, 61}), estimate, {}).pairs.size(), 0u);
  // An exact hit needs no neighbour.
  EXPECT_EQ(Associate(Line({0, 30, 500}), estimate, {}).pairs.size(), 1u);
}

TEST(Association, EstimateGapsCostCoverage) {
  const auto truth = Walk(2.0, 200.0);
  std::vector<StampedPose> estimate = Walk(2.0, 20.0);
  EXPECT_NEAR(Associate(truth, estimate, {}).coverage_s, 2.0, 1e-9);
  // One frame dropped (a step of 0.1 s): no gap. Nine dropped (0.5 s): one.
  estimate.erase(estimate.begin() + 5);
  EXPECT_NEAR(Associate(truth, estimate, {}).coverage_s, 2.0, 1e-9);
  estimate.erase(estimate.begin() + 20, estimate.begin() + 29);
  const Association a = Associate(truth, estimate, {});
  EXPECT_NEAR(a.coverage_s, 1.5, 1e-9);
  ASSERT_EQ(a.gaps.size(), 1u);
  EXPECT_EQ(a.gaps[0].cause, TimeGap::Cause::kEstimate);
}

TEST(Association, JumpsOfTheTruthAreNotInterpolatedAcross) {
  AssociationOptions options;
  options.truth_jumps = {kEpoch + 100 * kMs};
  const Association a = Associate(Line({0, 50, 100, 150, 200}), Line({90, 110, 140, 160}), options);
  EXPECT_THAT(Milliseconds(a.pairs, true), testing::ElementsAre(90, 160));
  EXPECT_EQ(a.at_truth_jump, 2);
  EXPECT_EQ(a.in_truth_gap, 0);
  // The estimate was there all the time: one pose lost to a jump costs no coverage.
  const Association covered =
      Associate(Line({0, 50, 100, 150, 200}), Line({30, 80, 130, 180}), options);
  EXPECT_EQ(covered.at_truth_jump, 1);
  EXPECT_NEAR(covered.coverage_s, 0.15, 1e-12);
  EXPECT_TRUE(covered.gaps.empty());
}

TEST(Association, SignsOfQuaternionsChangeNothing) {
  const auto truth = Walk(3.0, 20.0);
  Random random(3);
  const auto estimate = WithNoise(Walk(2.9, 33.0), 0.01, 0.01, &random);
  auto truth_flipped = truth;
  auto estimate_flipped = estimate;
  for (std::size_t i = 7; i < truth.size(); i += 3) truth_flipped[i].T_GB.R.coeffs() *= -1.0;
  for (std::size_t i = 1; i < estimate.size(); i += 2) estimate_flipped[i].T_GB.R.coeffs() *= -1.0;
  const auto errors =
      ComputeAbsoluteErrors(Associate(truth, estimate, {}).pairs, AlignmentMode::kPositionYaw);
  const auto flipped = ComputeAbsoluteErrors(Associate(truth_flipped, estimate_flipped, {}).pairs,
                                             AlignmentMode::kPositionYaw);
  EXPECT_GT(errors.orientation_deg.rmse, 0.1);
  EXPECT_NEAR(flipped.orientation_deg.rmse, errors.orientation_deg.rmse, 1e-12);
  EXPECT_NEAR(flipped.orientation_deg.max, errors.orientation_deg.max, 1e-9);
  EXPECT_NEAR(flipped.tilt_deg.rmse, errors.tilt_deg.rmse, 1e-12);
  EXPECT_NEAR(flipped.yaw_deg.rmse, errors.yaw_deg.rmse, 1e-12);
}

TEST(Association, EmptyTrajectoriesGiveNothing) {
  EXPECT_TRUE(Associate({}, Line({0}), {}).pairs.empty());
  const Association none = Associate(Line({0, 1}), {}, {});
  EXPECT_EQ(none.MatchedShare(), 0.0);
  EXPECT_EQ(none.coverage_s, 0.0);
}

TEST(Association, LikeEvoTwoPosesOfTheShorterMayShareOne) {
  // evo walks the shorter trajectory (here the estimate): both 8 and 12 ms take the truth at 10.
  AssociationOptions options{.mode = AssociationMode::kEvoNearest};
  const Association a = Associate(Line({0, 10, 100, 200}), Line({8, 12, 111}), options);
  EXPECT_THAT(Milliseconds(a.pairs, false), testing::ElementsAre(8, 12));  // 111 is 11 ms away
  EXPECT_THAT(Milliseconds(a.pairs, true), testing::ElementsAre(10, 10));
  // With the estimate longer it walks the truth, and the estimate's poses are shared.
  const Association b = Associate(Line({9, 11}), Line({0, 10, 20, 30}), options);
  EXPECT_THAT(Milliseconds(b.pairs, true), testing::ElementsAre(9, 11));
  EXPECT_THAT(Milliseconds(b.pairs, false), testing::ElementsAre(10, 10));
}

TEST(Association, LikeRpgTheClosestPairsComeFirstAndEachPoseIsUsedOnce) {
  // 12 takes 10 (2 ms apart), so that 7, 3 ms from 10, is left with 0 (7 ms).
  AssociationOptions options{.mode = AssociationMode::kRpgNearest};
  const Association a = Associate(Line({0, 10, 100}), Line({7, 12}), options);
  EXPECT_THAT(Milliseconds(a.pairs, false), testing::ElementsAre(7, 12));
  EXPECT_THAT(Milliseconds(a.pairs, true), testing::ElementsAre(0, 10));
}

TEST(Association, LikeOvEvalTheFirstThatComesNearTakesTheTruth) {
  AssociationOptions options{.mode = AssociationMode::kOvEvalNearest};
  const Association a = Associate(Line({100, 200}), Line({85, 95, 181, 201}), options);
  EXPECT_THAT(Milliseconds(a.pairs, false), testing::ElementsAre(85, 181));
  EXPECT_THAT(Milliseconds(a.pairs, true), testing::ElementsAre(100, 200));
  // The program overwrites the estimate's stamp; here it stays.
  EXPECT_EQ(a.pairs[0].timestamp, kEpoch + 85 * kMs);
}

TEST(Association, TrajectoriesThatAreNoneAreRefused) {
  EXPECT_NO_THROW(CheckTrajectory("a", Walk(1.0, 10.0)));
  EXPECT_THROW(CheckTrajectory("a", Line({0, 10, 10})), InputError);
  auto poses = Line({0, 10});
  poses[1].T_GB.p.y() = std::nan("");
  EXPECT_THROW(CheckTrajectory("a", poses), InputError);
  poses = Line({0, 10});
  poses[1].T_GB.R.coeffs() *= 1.01;
  EXPECT_THROW(CheckTrajectory("a", poses), InputError);
}

}  // namespace
}  // namespace duet
