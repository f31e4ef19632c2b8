#include "evaluation/errors.h"

#include <gtest/gtest.h>

#include <numbers>

#include "evaluation/relative_errors.h"
#include "test/evaluation/test_trajectories.h"

namespace duet {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

TEST(AbsoluteErrors, ByHandWithoutAlignment) {
  std::vector<PosePair> pairs(2);
  pairs[0].T_EB.p = {3, 4, 0};    // 5 m
  pairs[1].T_EB.p = {0, 0, -12};  // 12 m
  pairs[0].T_EB.R = YawRotation(3.0 * kRadPerDeg);
  pairs[1].T_EB.R = ExpQuaternion({0.0, 4.0 * kRadPerDeg, 0.0});
  const AbsoluteErrors e = ComputeAbsoluteErrors(pairs, AlignmentMode::kNone);
  EXPECT_NEAR(e.position_m.rmse, std::sqrt(169.0 / 2.0), 1e-12);
  EXPECT_NEAR(e.position_m.median, 8.5, 1e-12);
  EXPECT_NEAR(e.position_rmse_xyz_m.z(), std::sqrt(144.0 / 2.0), 1e-12);
  EXPECT_NEAR(e.orientation_deg.rmse, std::sqrt(25.0 / 2.0), 1e-12);
  EXPECT_NEAR(e.yaw_deg.max, 3.0, 1e-12);
  EXPECT_NEAR(e.yaw_deg.min, 0.0, 1e-12);
  EXPECT_NEAR(e.tilt_deg.max, 4.0, 1e-12);
  EXPECT_NEAR(e.tilt_deg.min, 0.0, 1e-12);
}

TEST(AbsoluteErrors, APureErrorOfYawAndATiltAreToldApart) {
  const auto truth = Walk(10.0, 20.0);
  // A tilt about the body's own axes, whatever the heading; with it a constant yaw.
  auto estimate = truth;
  for (StampedPose& pose : estimate) {
    pose.T_GB.R = YawRotation(0.4) * ExpQuaternion({2.0 * kRadPerDeg, 0, 0}) * pose.T_GB.R;
  }
  const auto e = ComputeAbsoluteErrors(PairUp(truth, estimate), AlignmentMode::kPositionYaw);
  EXPECT_NEAR(e.tilt_deg.rmse, 2.0, 1e-9);
  EXPECT_NEAR(e.orientation_deg.rmse, 2.0, 1e-9);
  EXPECT_NEAR(e.yaw_deg.rmse, 0.0, 1e-9);
  // The positions are exact and say that the yaw is zero: the other programs' number has it all.
  EXPECT_GT(e.orientation_by_positions_deg.rmse, 0.4 / kRadPerDeg);
  // Full rotations may be fitted too: then the constant tilt is taken out with the yaw.
  const auto se3 = ComputeAbsoluteErrors(PairUp(truth, estimate), AlignmentMode::kSe3);
  EXPECT_NEAR(se3.orientation_deg.rmse, 0.0, 1e-9);
}

struct Moving {
  AlignmentMode mode;
  bool any_rotation;
  bool scale;
};

/// Each metric is unchanged when the estimate is moved by a transformation of its class.
TEST(AbsoluteErrors, InvariantUnderTransformationsOfTheClass) {
  Random random(17);
  const auto truth = Walk(12.0, 10.0);
  const auto estimate = WithNoise(truth, 0.05, 0.02, &random);
  for (const Moving& moving :
       {Moving{AlignmentMode::kPositionYaw, false, false}, Moving{AlignmentMode::kSe3, true, false},
        Moving{AlignmentMode::kSim3, true, true}, Moving{AlignmentMode::kFirstPose, true, false}}) {
    const auto before = ComputeAbsoluteErrors(PairUp(truth, estimate), moving.mode);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Quaterniond R =
          moving.any_rotation ? RandomRotation(&random) : YawRotation(random.Uniform(-3.14, 3.14));
      const double scale = moving.scale ? random.Uniform(0.2, 4.0) : 1.0;
      const auto moved = Moved(estimate, R, 20.0 * random.NormalVector<3>(), scale);
      const auto after = ComputeAbsoluteErrors(PairUp(truth, moved), moving.mode);
      const char* name = AlignmentModeName(moving.mode);
      // Positions of some 100 m carry rounding of 1e-14 m each.
      EXPECT_NEAR(after.position_m.rmse, before.position_m.rmse, 1e-12) << name;
      EXPECT_NEAR(after.position_m.p95, before.position_m.p95, 1e-12) << name;
      EXPECT_NEAR(after.orientation_deg.rmse, before.orientation_deg.rmse, 1e-10) << name;
      EXPECT_NEAR(after.tilt_deg.rmse, before.tilt_deg.rmse, 1e-10) << name;
      EXPECT_NEAR(after.yaw_deg.median, before.yaw_deg.median, 1e-10) << name;
    }
  }
}

TEST(AbsoluteErrors, NoiseThatWasPutInComesOut) {
  Random random(19);
  const auto truth = Walk(200.0, 20.0);
  const double sigma_m = 0.01;
  const double sigma_rad = 0.5 * kRadPerDeg;
  const auto estimate =
      Moved(WithNoise(truth, sigma_m, sigma_rad, &random), YawRotation(2.5), {5, 6, 7});
  const auto e = ComputeAbsoluteErrors(PairUp(truth, estimate), AlignmentMode::kPositionYaw);
  // 4001 poses of three components: the rmse scatters by 1 / sqrt(2 * 12003) = 0.65 %; 4 sigma.
  EXPECT_NEAR(e.position_m.rmse, std::sqrt(3.0) * sigma_m, 0.026 * std::sqrt(3.0) * sigma_m);
  EXPECT_NEAR(e.orientation_deg.rmse, std::sqrt(3.0) * 0.5, 0.026 * std::sqrt(3.0) * 0.5);
  EXPECT_NEAR(e.tilt_deg.rmse, std::sqrt(2.0) * 0.5, 0.032 * std::sqrt(2.0) * 0.5);
  EXPECT_NEAR(e.yaw_deg.rmse, 0.5, 0.045 * 0.5);
}

TEST(AbsoluteErrors, AStandingTruthHasNoPositionErrorButAnOrientationError) {
  std::vector<PosePair> pairs(50);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].T_EB.p.x() = 1e-3 * static_cast<double>(i);
    pairs[i].T_EB.R = YawRotation(0.3) * ExpQuaternion({1e-3, 0, 0});
  }
  const auto e = ComputeAbsoluteErrors(pairs, AlignmentMode::kPositionYaw);
  EXPECT_EQ(e.alignment.refusal, AlignmentRefusal::kCoincidentTruth);
  EXPECT_EQ(e.position_m.count, 0);
  EXPECT_TRUE(e.position_series_m.empty());
  EXPECT_EQ(e.orientation_deg.count, 50);
  EXPECT_NEAR(e.tilt_deg.rmse, 1e-3 / kRadPerDeg, 1e-12);
}

TEST(AbsoluteErrors, DriftFromTheOwnFirstPose) {
  std::vector<Pose> poses(3);
  poses[0].p = {1, 1, 1};
  poses[1].p = {1, 1, 1.5};
  poses[1].R = YawRotation(2.0 * kRadPerDeg);
  poses[2].p = {1.3, 1.4, 1};
  const auto drift = DriftFromFirstPose(poses);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->position_max_m, 0.5, 1e-15);
  EXPECT_NEAR(drift->position_end_m, 0.5, 1e-15);
  EXPECT_NEAR(drift->orientation_max_deg, 2.0, 1e-12);
  EXPECT_NEAR(drift->orientation_end_deg, 0.0, 1e-12);
  EXPECT_FALSE(DriftFromFirstPose({}));
}

// ---------------------------------------------------------------------------- relative errors

/// Along x at 1 m/s.
std::vector<StampedPose> Straight(double duration_s, double rate_hz) {
  auto poses = Walk(duration_s, rate_hz);
  for (StampedPose& pose : poses) {
    pose.T_GB.p = {SecondsBetween(kEpoch, pose.timestamp), 0, 0};
    pose.T_GB.R.setIdentity();
  }
  return poses;
}

TEST(TravelledDistance, AlongAStraightLineAndBack) {
  const TravelledDistance way(Straight(10.0, 200.0), 0.05);
  EXPECT_NEAR(way.total_m(), 10.0, 1e-12);
  EXPECT_NEAR(way.At(kEpoch + 2525 * kMs), 2.525, 1e-12);
  EXPECT_EQ(way.At(kEpoch - 1), 0.0);
  EXPECT_NEAR(way.At(kEpoch + 99 * kSecond), 10.0, 1e-12);
  ASSERT_TRUE(way.WhenReached(4.0));
  EXPECT_NEAR(SecondsBetween(kEpoch, *way.WhenReached(4.0)), 4.0, 2e-9);
  EXPECT_FALSE(way.WhenReached(10.1));
}

TEST(TravelledDistance, NoiseAtAHighRateDoesNotAddUp) {
  // Standing still for 10 s at 200 Hz with 1 mm of noise a component.
  std::vector<StampedPose> still = Straight(10.0, 200.0);
  Random random(23);
  for (StampedPose& pose : still) pose.T_GB.p = 1e-3 * random.NormalVector<3>();
  EXPECT_GT(TravelledDistance(still, 0.0).total_m(), 4.0);
  EXPECT_LT(TravelledDistance(still, 0.05).total_m(), 0.5);
}

TEST(RelativeErrors, AnErrorOfScaleIsItsPercentage) {
  const auto truth = Straight(10.0, 200.0);
  auto estimate = Straight(10.0, 20.0);
  for (StampedPose& pose : estimate) pose.T_GB.p *= 1.03;
  const std::vector<std::vector<PosePair>> pairs = {Associate(truth, estimate, {}).pairs};
  const auto report = ComputeRelativeErrors(truth, pairs, {.lengths_m = {1.0, 4.0}});
  ASSERT_EQ(report.of_estimator[0].size(), 2u);
  const RelativeErrors& of_4m = report.of_estimator[0][1];
  // Starts every 50 ms from 0 to 6 s.
  EXPECT_EQ(of_4m.segments, 121);
  EXPECT_NEAR(of_4m.translation_percent.min, 3.0, 1e-7);
  EXPECT_NEAR(of_4m.translation_percent.max, 3.0, 1e-7);
  EXPECT_NEAR(of_4m.translation_m.median, 0.12, 1e-9);
  EXPECT_NEAR(of_4m.rotation_deg.max, 0.0, 1e-9);
  EXPECT_EQ(report.dropped, 0);
  EXPECT_NEAR(report.way_m, 10.0, 1e-9);
}

TEST(RelativeErrors, ATurningEstimateByHand) {
  // The estimate's yaw runs away by 0.01 rad/m while it believes to go straight ahead: it walks an
  // arc of radius 100 m. Over 2 m: 0.02 rad, and off the line by the chord of the arc.
  const auto truth = Straight(10.0, 200.0);
  auto estimate = Straight(10.0, 20.0);
  for (StampedPose& pose : estimate) {
    const double angle = 0.01 * pose.T_GB.p.x();
    pose.T_GB.R = YawRotation(angle);
    pose.T_GB.p = {100.0 * std::sin(angle), 100.0 * (1.0 - std::cos(angle)), 0.0};
  }
  const std::vector<std::vector<PosePair>> pairs = {Associate(truth, estimate, {}).pairs};
  const auto report = ComputeRelativeErrors(truth, pairs, {.lengths_m = {2.0}});
  const RelativeErrors& errors = report.of_estimator[0][0];
  const double expected_m = std::hypot(2.0 - 100.0 * std::sin(0.02), 100.0 * (1 - std::cos(0.02)));
  EXPECT_NEAR(errors.translation_m.min, expected_m, 1e-9);
  EXPECT_NEAR(errors.translation_m.max, expected_m, 1e-9);
  EXPECT_NEAR(errors.rotation_deg.median, 0.02 / kRadPerDeg, 1e-9);
  EXPECT_NEAR(errors.yaw_deg.median, 0.02 / kRadPerDeg, 1e-9);
  EXPECT_NEAR(errors.tilt_deg.max, 0.0, 1e-9);
}

TEST(RelativeErrors, NoAlignmentMatters) {
  Random random(29);
  const auto truth = Walk(20.0, 100.0);
  const auto estimate = WithNoise(Walk(20.0, 20.0), 0.02, 0.02, &random);
  const auto moved = Moved(estimate, RandomRotation(&random), {10, -20, 30});
  const std::vector<std::vector<PosePair>> pairs = {Associate(truth, estimate, {}).pairs,
                                                    Associate(truth, moved, {}).pairs};
  const auto report = ComputeRelativeErrors(truth, pairs, {.lengths_m = {2.0}});
  const RelativeErrors& a = report.of_estimator[0][0];
  const RelativeErrors& b = report.of_estimator[1][0];
  ASSERT_GT(a.segments, 50);
  EXPECT_NEAR(a.translation_m.rmse, b.translation_m.rmse, 1e-12);
  EXPECT_NEAR(a.rotation_deg.p95, b.rotation_deg.p95, 1e-10);
  EXPECT_NEAR(a.yaw_deg.median, b.yaw_deg.median, 1e-10);
  EXPECT_NEAR(a.tilt_deg.median, b.tilt_deg.median, 1e-10);
}

/// The definition, written the usual way: (T_s^-1 T_e)_true^-1 (T_s^-1 T_e)_est.
TEST(RelativeErrors, AreTheNormsOfTheUsualDefinition) {
  Random random(31);
  const auto truth = Straight(3.0, 20.0);
  auto estimate = WithNoise(truth, 0.1, 0.1, &random);
  const std::vector<std::vector<PosePair>> pairs = {Associate(truth, estimate, {}).pairs};
  const auto report = ComputeRelativeErrors(truth, pairs, {.lengths_m = {3.0}});
  ASSERT_EQ(report.of_estimator[0][0].segments, 1);
  const Pose moved_true = truth.front().T_GB.Inverse() * truth.back().T_GB;
  const Pose moved_est = estimate.front().T_GB.Inverse() * estimate.back().T_GB;
  const Pose error = moved_true.Inverse() * moved_est;
  EXPECT_NEAR(report.of_estimator[0][0].translation_m.median, error.p.norm(), 1e-12);
  EXPECT_NEAR(report.of_estimator[0][0].rotation_deg.median, Log(error.R).norm() / kRadPerDeg,
              1e-10);
}

TEST(RelativeErrors, SegmentsAreTheSameForAllOnTheCommonSpan) {
  const auto truth = Straight(10.0, 200.0);
  std::vector<StampedPose> late = Straight(10.0, 20.0);
  late.erase(late.begin(), late.begin() + 60);  // starts after 3 s
  std::vector<StampedPose> early = Straight(10.0, 20.0);
  early.erase(early.begin() + 181, early.end());        // ends after 9 s
  early.erase(early.begin() + 70, early.begin() + 90);  // lost for a second
  const std::vector<std::vector<PosePair>> pairs = {
      Associate(truth, late, {}).pairs, {}, Associate(truth, early, {}).pairs};
  const auto report = ComputeRelativeErrors(truth, pairs, {.lengths_m = {2.0}});
  EXPECT_EQ(report.start, kEpoch + 3 * kSecond);
  EXPECT_EQ(report.end, kEpoch + 9 * kSecond);
  EXPECT_EQ(report.of_estimator[0][0].segments, report.of_estimator[2][0].segments);
  EXPECT_EQ(report.of_estimator[1][0].segments, 0);
  EXPECT_GT(report.dropped, 0);
  // 81 starts from 3 to 7 s.
  EXPECT_EQ(report.of_estimator[0][0].segments + report.dropped, 81);
}

TEST(RelativeErrors, AutomaticLengthsAreHalfTheWayAtMost) {
  const auto truth = Straight(100.0, 20.0);
  const std::vector<std::vector<PosePair>> pairs = {PairUp(truth, truth)};
  const auto report = ComputeRelativeErrors(truth, pairs, {});
  std::vector<double> lengths;
  for (const RelativeErrors& e : report.of_estimator[0]) lengths.push_back(e.length_m);
  EXPECT_EQ(lengths, (std::vector<double>{5.0, 10.0, 20.0, 50.0}));
}

}  // namespace
}  // namespace duet
