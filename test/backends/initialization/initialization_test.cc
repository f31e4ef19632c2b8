#include "backends/initialization/initialization.h"

#include <gtest/gtest.h>

#include "common/geometry/so3.h"
#include "experiments/simulation/simulator.h"

namespace duet {
namespace {

struct Started {
  SimulatedRecording recording;
  EstimatorSetup setup;
  ImuBuffer imu;
  std::vector<StampedPose> poses;
};

Started Make(const SimulationOptions& options) {
  Started s;
  s.recording = Simulate(options);
  s.setup = MakeSetup(s.recording, {});
  for (const ImuSample& sample : s.recording.imu) s.imu.Add(sample);
  for (const InertialState& x : s.recording.truth) s.poses.push_back({x.instant, x.nav.pose()});
  return s;
}

SimulationOptions Moving() {
  SimulationOptions options = SimulationPreset("room_easy");
  options.duration_s = 6.0;
  return options;
}

TEST(InitializeFromPoses, FindsVelocityAndBiases) {
  const Started s = Make(Moving());
  for (const double start_s : {0.0, 1.0, 2.5}) {
    const Timestamp instant = s.recording.start + ToNanoseconds(start_s);
    const auto result = InitializeFromPoses(s.poses, s.imu, instant, s.setup, {});
    ASSERT_TRUE(std::holds_alternative<InitialCondition>(result));
    const InertialState& x = std::get<InitialCondition>(result).state;
    const Vector15d e = BoxMinus(s.recording.TruthAt(instant), x);
    EXPECT_EQ(x.instant, instant);
    EXPECT_LT(e.head<3>().norm(), 1e-4);  // exact poses
    EXPECT_LT(e.segment<3>(3).norm(), 1e-4);
    EXPECT_LT(e.segment<3>(6).norm(), 5e-3);  // b_a times half the width
    EXPECT_LT(e.segment<3>(9).norm(), 2e-3);  // density / sqrt(0.5 s) = 2.4e-4 rad/s per axis
    // Half a metre of truth in half a second: y noise of 2e-3 over 0.25 s is 0.02 m/s^2 per axis.
    EXPECT_LT(e.segment<3>(12).norm(), 0.1);
  }
}

TEST(InitializeFromPoses, AJumpOfTheTruthDoesNotMoveIt) {
  Started s = Make(Moving());
  const Timestamp instant = s.recording.start + ToNanoseconds(2.0);
  const auto clean = InitializeFromPoses(s.poses, s.imu, instant, s.setup, {});
  const Timestamp jump = instant + ToNanoseconds(0.015);
  for (StampedPose& pose : s.poses) {
    if (pose.timestamp >= jump) pose.T_GB.p += Eigen::Vector3d(0.004, -0.003, 0.002);
  }
  const auto jumped = InitializeFromPoses(s.poses, s.imu, instant, s.setup, {});
  ASSERT_TRUE(std::holds_alternative<InitialCondition>(jumped));
  const Vector15d moved =
      BoxMinus(std::get<InitialCondition>(jumped).state, std::get<InitialCondition>(clean).state);
  EXPECT_LT(moved.segment<3>(3).norm(), 1e-3);  // half the window is left; 5.4 mm were added
  EXPECT_LT(moved.segment<3>(6).norm(), 0.02);
  EXPECT_LT(moved.segment<3>(12).norm(), 0.3);
}

TEST(InitializeFromPoses, SaysWhatIsMissing) {
  const Started s = Make(Moving());
  const auto none = InitializeFromPoses({}, s.imu, s.recording.start, s.setup, {});
  ASSERT_TRUE(std::holds_alternative<InitializationFailure>(none));
  EXPECT_NE(std::get<InitializationFailure>(none).reason.find("poses"), std::string::npos);
  const auto outside =
      InitializeFromPoses(s.poses, s.imu, s.recording.start - ToNanoseconds(9.0), s.setup, {});
  ASSERT_TRUE(std::holds_alternative<InitializationFailure>(outside));
  EXPECT_NE(std::get<InitializationFailure>(outside).reason.find("IMU"), std::string::npos);
}

TEST(RestInitializer, StartsAtRestWithTheErrorsItClaims) {
  SimulationOptions options = SimulationPreset("room_rest");
  options.duration_s = 4.0;
  options.pixel_noise_px = 0.2;
  constexpr int kSeeds = 10;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    const Started s = Make(options);
    RestInitializer initializer(s.setup, {});
    const InitialCondition* found = nullptr;
    InitializationResult result;
    for (const TrackFrameSet& frames : s.recording.frames) {
      result = initializer.Update(frames, s.imu);
      found = std::get_if<InitialCondition>(&result);
      if (found != nullptr) break;
    }
    ASSERT_NE(found, nullptr);
    const InertialState truth = s.recording.TruthAt(found->state.instant);
    // Yaw and position are a gauge: the truth is turned to the estimate's.
    const Eigen::Vector3d up_true = truth.nav.R_GB.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d up = found->state.nav.R_GB.conjugate() * Eigen::Vector3d::UnitZ();
    const double tilt = std::acos(std::clamp(up_true.dot(up), -1.0, 1.0));
    // The simulated accelerometer's lateral bias of about 0.13 m/s^2 cannot be told from tilt.
    EXPECT_LT(tilt, 0.02);
    EXPECT_LT((found->state.biases.b_g - truth.biases.b_g).norm(), 2e-3);
    EXPECT_LT(std::abs((found->state.biases.b_a - truth.biases.b_a).dot(up)), 0.01);
    EXPECT_EQ(found->state.nav.v_GB.norm(), 0.0);
    const Eigen::Matrix3d R = found->state.nav.R_GB.toRotationMatrix();
    EXPECT_NEAR(std::atan2(R(1, 0), R(0, 0)), 0.0, 1e-9);
    const Matrix15d& P = found->covariance;
    EXPECT_EQ(Eigen::LLT<Matrix15d>(P).info(), Eigen::Success);
    // Tilt and lateral bias are one unknown: what gravity says of both together, theta x up g =
    // R b_a, is known far better than either.
    Eigen::Matrix<double, 2, 15> together = Eigen::Matrix<double, 2, 15>::Zero();
    together.leftCols<3>() = -9.81 * Hat(Eigen::Vector3d::UnitZ()).topRows<2>();
    together.rightCols<3>() = -R.topRows<2>();
    const Eigen::Matrix2d known = together * P * together.transpose();
    EXPECT_LT(
        known.trace(),
        0.1 * (R.topRows<2>() * P.bottomRightCorner<3, 3>() * R.topRows<2>().transpose()).trace());
  }
}

// T_s and T_a that are told wrong turn gravity into what looks like biases and tilt. What is left
// of the first errors once the calibration's part is taken out is as small as with right ones.
TEST(RestInitializer, TellsHowItsErrorsGoWithThoseOfTheCalibration) {
  SimulationOptions options = SimulationPreset("room_rest");
  options.duration_s = 2.0;
  options.pixel_noise_px = 0.2;
  options.told_errors.T_s = 1e-3;
  options.told_errors.T_a = 1e-2;
  SharedOptions shared;
  shared.calibration.T_s.estimated = shared.calibration.T_a.estimated = true;
  double whole = 0.0;
  double rest = 0.0;
  constexpr int kSeeds = 10;
  constexpr int kNumbers = 6;  // of b_g, b_a along gravity and the two of tilt with b_a across
  for (int seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    Started s = Make(options);
    s.setup = MakeSetup(s.recording, shared);
    const CalibrationLayout layout(shared.calibration, s.setup.rig);
    RestInitializer initializer(s.setup, {});
    InitializationResult result;
    const InitialCondition* found = nullptr;
    for (const TrackFrameSet& frames : s.recording.frames) {
      result = initializer.Update(frames, s.imu);
      found = std::get_if<InitialCondition>(&result);
      if (found != nullptr) break;
    }
    ASSERT_NE(found, nullptr);
    ASSERT_EQ(found->calibration_gain.cols(), 18);
    const InertialState truth = s.recording.TruthAt(found->state.instant);
    const Eigen::Matrix3d R = found->state.nav.R_GB.toRotationMatrix();
    Vector15d error = Vector15d::Zero();
    error.head<3>() = -Eigen::Vector3d::UnitZ().cross(
        R * (truth.nav.R_GB.conjugate() * Eigen::Vector3d::UnitZ()));
    error.segment<3>(9) = truth.biases.b_g - found->state.biases.b_g;
    error.segment<3>(12) = truth.biases.b_a - found->state.biases.b_a;
    const Vector15d left =
        error - found->calibration_gain * BoxMinus(s.recording.true_rig, s.setup.rig, layout);
    // theta x up g = R b_a across gravity; along it b_a alone.
    Eigen::Matrix<double, kNumbers, 15> known = Eigen::Matrix<double, kNumbers, 15>::Zero();
    known.block<3, 3>(0, 9).setIdentity();
    known.block<2, 3>(3, 0) = -9.81 * Hat(Eigen::Vector3d::UnitZ()).topRows<2>();
    known.block<2, 3>(3, 12) = -R.topRows<2>();
    known.block<1, 3>(5, 12) = R.row(2);
    const Eigen::Matrix<double, kNumbers, kNumbers> P =
        known * found->covariance * known.transpose();
    const auto nees = [&](const Vector15d& e) {
      const Eigen::Matrix<double, kNumbers, 1> r = known * e;
      return r.dot(P.ldlt().solve(r)) / kSeeds;
    };
    whole += nees(error);
    rest += nees(left);
  }
  EXPECT_LT(rest, 2.0 * kNumbers);
  EXPECT_GT(whole, 10.0 * kNumbers);
}

TEST(RestInitializer, RefusesMotion) {
  const Started s = Make(Moving());
  RestInitializer initializer(s.setup, {});
  for (const TrackFrameSet& frames : s.recording.frames) {
    const auto result = initializer.Update(frames, s.imu);
    ASSERT_TRUE(std::holds_alternative<InitializationFailure>(result));
    EXPECT_FALSE(std::get<InitializationFailure>(result).reason.empty());
  }
}

}  // namespace
}  // namespace duet
