#include "experiments/simulation/recorded_motion.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "common/geometry/so3.h"
#include "common/support/input_error.h"
#include "experiments/simulation/imu_simulator.h"
#include "experiments/simulation/scenario.h"
#include "experiments/simulation/trajectory_library.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr Timestamp kMotionStart = 1'400'000'000'000'000'000;
const Vector3d kBiasGyro(-0.002, 0.021, 0.075);
const Vector3d kBiasAccelerometer(-0.05, 0.12, 0.07);

// A flight's IMU, and a truth at 200 Hz that begins a second later.
Recording Flight(double duration_s) {
  const auto flight = MakeTrajectory("V1_02_medium", duration_s, 0.0);
  ImuUnderSimulation imu{.noise = {1.7e-4, 2e-3, 1.9e-5, 1e-4},
                         .biases = {.b_g = kBiasGyro, .b_a = kBiasAccelerometer},
                         .g_G = {0, 0, -9.81}};
  Recording recording;
  recording.folder = "flight";
  recording.imu = SimulateImu(*flight, kMotionStart, imu, {}, 3).samples;
  recording.imu_sensor.noise = imu.noise;
  recording.truth.emplace();
  recording.truth_file = "truth.csv";
  for (int i = 200; i / 200.0 <= duration_s; ++i) {
    recording.truth->poses.push_back(
        {kMotionStart + ToNanoseconds(i / 200.0), flight->At(i / 200.0).T_GB});
  }
  return recording;
}

TEST(RecordedMotion, GoesWithTheImuOfItsRecording) {
  const Recording recording = Flight(30.0);
  const RecordedMotion motion = FollowRecording(recording, "V1_02_like");
  EXPECT_EQ(motion.report.label, "real IMU, synthetic vision along V1_02_like's truth");
  // But for the shift that the gyroscope's noise makes it find.
  EXPECT_NEAR(SecondsBetween(recording.truth->poses.front().timestamp, motion.start), 0.0, 2e-4);
  EXPECT_TRUE(motion.report.jumps.empty());
  ASSERT_EQ(motion.imu.size(), recording.imu.size());
  EXPECT_EQ(motion.imu[77].omega_m, recording.imu[77].omega_m);
  // The sample's white noise: density * sqrt(200 Hz).
  EXPECT_NEAR(motion.report.agreement.gyroscope_rms, 1.7e-4 * 14.142, 3e-4);
  EXPECT_NEAR(motion.report.agreement.accelerometer_rms, 2e-3 * 14.142, 2e-3);
  // 1 s of the accelerometer's noise is 2e-3 sqrt(1/3) an axis, 2 mm over three; the bias, known to
  // 2e-3 / sqrt(10 s) = 6e-4, half of that.
  EXPECT_LT(motion.report.prediction.median_m, 4e-3);
  EXPECT_LT(motion.report.prediction.median_deg, 0.05);
  for (std::size_t i = 0; i < motion.states.size(); i += 500) {
    EXPECT_LT((motion.states[i].biases.b_g - kBiasGyro).norm(), 1e-3);
    EXPECT_LT((motion.states[i].biases.b_a - kBiasAccelerometer).norm(), 1e-2);
  }
}

TEST(RecordedMotion, FindsShiftAndRotationAndAppliesThemWhereTold) {
  Recording recording = Flight(30.0);
  const Eigen::Quaterniond R_IB = ExpQuaternion(Vector3d(0.004, -0.006, 0.008));
  for (StampedPose& pose : recording.truth->poses) {
    pose.timestamp -= 4'000'000;
    pose.T_GB.R = pose.T_GB.R * R_IB;
  }
  const RecordedMotion aligned = FollowRecording(recording, "x", {.apply_rotation = true});
  ASSERT_TRUE(aligned.report.fit.has_value());
  const GyroTruthFit& fit = *aligned.report.fit;
  EXPECT_NEAR(fit.time_shift_s, 4e-3, 5.0 * fit.time_sigma_s + 2e-5);
  EXPECT_LT(Log(fit.R_IB * R_IB.conjugate()).norm(), 5e-4);
  EXPECT_LT(aligned.report.prediction.median_m, 5e-3);
  EXPECT_EQ(aligned.start,
            recording.truth->poses.front().timestamp + ToNanoseconds(fit.time_shift_s));

  const RecordedMotion as_told =
      FollowRecording(recording, "x", {.apply_time_shift = false, .apply_rotation = false});
  EXPECT_EQ(as_told.start, recording.truth->poses.front().timestamp);
  EXPECT_EQ(as_told.report.applied_shift_s, 0.0);
  EXPECT_GT(as_told.report.agreement.slow_gyroscope_rms,
            5.0 * aligned.report.agreement.slow_gyroscope_rms);
}

TEST(RecordedMotion, BridgesJumpsAndListsThem) {
  Recording recording = Flight(20.0);
  std::vector<StampedPose>& poses = recording.truth->poses;
  for (std::size_t i = 1000; i < poses.size(); ++i) poses[i].T_GB.p += Vector3d(0.05, -0.02, 0.01);
  for (std::size_t i = 2500; i < poses.size(); ++i) poses[i].T_GB.p += Vector3d(-0.01, 0.0, 0.004);
  EXPECT_THROW(static_cast<void>(SplineThrough(poses, "truth.csv")), InputError)
      << "without the IMU it is no motion";
  const RecordedMotion motion = FollowRecording(recording, "x");
  ASSERT_EQ(motion.report.jumps.size(), 2u);
  EXPECT_EQ(motion.report.jumps[0].index, 999u);
  EXPECT_EQ(motion.report.jumps[1].index, 2499u);
  EXPECT_NEAR(motion.report.jumps[0].displacement.norm(), 0.0548, 3e-4);
  EXPECT_NEAR(motion.report.final_offset_m, Vector3d(0.04, -0.02, 0.014).norm(), 5e-4);
  EXPECT_LT(motion.report.prediction.largest_m, 0.015);
  const std::string text = RecordedMotionText(motion.report, motion.start, true);
  EXPECT_NE(text.find("at    5.000 s    54.8 mm"), std::string::npos) << text;
}

TEST(RecordedMotion, RefusesRecordingsThatAreNone) {
  Recording recording = Flight(10.0);
  recording.truth->poses.resize(500);
  EXPECT_THROW(static_cast<void>(FollowRecording(recording, "short")), InputError);
  recording.truth.reset();
  EXPECT_THROW(static_cast<void>(FollowRecording(recording, "none")), InputError);
}

// Frames and states are on the recorded IMU's clock and within its samples.
TEST(RecordedMotion, SimulatesVisionForTheRecordedImu) {
  const Recording recording = Flight(12.0);
  const RecordedMotion motion = FollowRecording(recording, "x");
  SimulationOptions options;
  options.max_tracks = 40;
  const SimulatedRecording simulated = SimulateIn(MakeScenario(options, motion, false), options);
  ASSERT_EQ(simulated.imu.size(), recording.imu.size());
  EXPECT_EQ(simulated.imu[5].a_m, recording.imu[5].a_m);
  EXPECT_EQ(simulated.noise.gyroscope_density, recording.imu_sensor.noise.gyroscope_density);
  EXPECT_GT(simulated.frames.size(), 200u);
  for (const TrackFrameSet& set : simulated.frames) {
    EXPECT_GT(set.timestamp, motion.start);
    EXPECT_EQ(set.frames[0].timestamp, set.timestamp);
    const InertialState truth = simulated.TruthAt(set.timestamp);
    EXPECT_LT((truth.nav.p_GB - motion.trajectory->spline().At(set.timestamp).T_GB.p).norm(),
              1e-12);
  }
  EXPECT_LT(simulated.frames.back().timestamp, recording.imu.back().timestamp);
}

// EuRoC: what remains is real, about 0.05 m/s^2 between accelerometer and truth over half a second
// (20 mm after 1 s), the same with the data set's own biases.
class RecordedMotionOf : public testing::TestWithParam<const char*> {};

TEST_P(RecordedMotionOf, TruthAndImuBelongTogether) {
  const char* told = std::getenv("DUET_DATA");
  const fs::path data =
      told != nullptr ? fs::path(told) : fs::path(DUET_SOURCE_DIR).parent_path() / "shared/data";
  const fs::path folder = data / "inertial" / GetParam();
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "no recording at " << folder << " (set DUET_DATA to the folder of recordings)";
  }
  const RecordedMotion motion = LoadRecordedMotion(folder);
  std::fputs(RecordedMotionText(motion.report, motion.start, false).c_str(), stdout);
  EXPECT_LT(motion.report.prediction.median_m, 0.04);
  EXPECT_LT(motion.report.prediction.p95_m, 0.08);
  EXPECT_LT(motion.report.prediction.median_deg, 0.1);
  ASSERT_TRUE(motion.report.fit.has_value());
  EXPECT_LT(std::abs(motion.report.fit->time_shift_s), 1e-3);
  EXPECT_LT(motion.report.b_g_difference.value_or(0.0), 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Recordings, RecordedMotionOf,
                         testing::Values("MH_03_medium", "MH_04_difficult", "V1_03_difficult",
                                         "V2_01_easy"));

}  // namespace
}  // namespace duet
