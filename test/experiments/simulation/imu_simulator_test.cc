#include "experiments/simulation/imu_simulator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/so3.h"
#include "experiments/simulation/trajectory_library.h"
#include "experiments/simulation/write_recording.h"

namespace duet {
namespace {

using Eigen::Vector3d;

constexpr Timestamp kImuStart = 1'400'000'000'000'000'000;

ImuUnderSimulation NoisyImu() {
  ImuUnderSimulation imu;
  imu.noise = {1.7e-4, 2e-3, 1.9e-5, 3e-3};
  imu.g_G = {0, 0, -9.81};
  return imu;
}

ImuUnderSimulation ExactImu() {
  ImuUnderSimulation imu;
  imu.g_G = {0, 0, -9.81};
  return imu;
}

Vector3d SpecificForce(const Kinematics& k) {
  return k.T_GB.R.conjugate() * (k.a_G + Vector3d(0, 0, 9.81));
}

TEST(ImuSimulator, ReadsTheExactRatesAtAnyRate) {
  const auto trajectory = MakeTrajectory("aggressive", 5.0, 0.0);
  for (const double rate_hz : {37.0, 200.0, 1000.0}) {
    const SimulatedImu simulated =
        SimulateImu(*trajectory, kImuStart, ExactImu(), {.rate_hz = rate_hz}, 1);
    ASSERT_EQ(simulated.samples.size(), static_cast<std::size_t>(5.0 * rate_hz) + 1);
    for (const ImuSample& sample : simulated.samples) {
      const Kinematics k = trajectory->At(SecondsBetween(kImuStart, sample.timestamp));
      EXPECT_EQ(sample.omega_m, k.omega_B);
      EXPECT_LT((sample.a_m - SpecificForce(k)).norm(), 1e-13);
    }
  }
}

TEST(ImuSimulator, ReadingsEndAtTheRange) {
  const auto trajectory = MakeTrajectory("aggressive", 20.0, 0.0);
  const SimulatedImu free = SimulateImu(*trajectory, kImuStart, NoisyImu(), {}, 3);
  const SimulatedImu clipped = SimulateImu(*trajectory, kImuStart, NoisyImu(),
                                           {.gyroscope_range = 1.0, .accelerometer_range = 9.9}, 3);
  int gyroscope = 0;
  int accelerometer = 0;
  for (std::size_t i = 0; i < free.samples.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(clipped.samples[i].omega_m[axis],
                std::clamp(free.samples[i].omega_m[axis], -1.0, 1.0));
      EXPECT_EQ(clipped.samples[i].a_m[axis], std::clamp(free.samples[i].a_m[axis], -9.9, 9.9));
    }
    gyroscope += free.samples[i].omega_m.cwiseAbs().maxCoeff() > 1.0 ? 1 : 0;
    accelerometer += free.samples[i].a_m.cwiseAbs().maxCoeff() > 9.9 ? 1 : 0;
  }
  EXPECT_GT(gyroscope, 100);
  EXPECT_GT(accelerometer, 100);
  EXPECT_EQ(clipped.clipped_gyroscope, gyroscope);
  EXPECT_EQ(clipped.clipped_accelerometer, accelerometer);
  EXPECT_EQ(free.clipped_gyroscope, 0);
}

TEST(ImuSimulator, JitterMovesTheInstantsAndWhereToldTheStamps) {
  const auto trajectory = MakeTrajectory("lissajous", 30.0, 0.0);
  const double jitter_s = 4e-4;
  const SimulatedImu stamped =
      SimulateImu(*trajectory, kImuStart, ExactImu(), {.jitter_s = jitter_s}, 5);
  const SimulatedImu even = SimulateImu(*trajectory, kImuStart, ExactImu(),
                                        {.jitter_s = jitter_s, .jitter_is_stamped = false}, 5);
  ASSERT_EQ(stamped.samples.size(), even.samples.size());
  double square = 0.0;
  for (std::size_t i = 0; i < even.samples.size(); ++i) {
    EXPECT_EQ(even.samples[i].timestamp, EvenStamp(kImuStart, static_cast<int>(i), 200.0));
    // The same instants: the stamps alone differ.
    EXPECT_EQ(stamped.samples[i].omega_m, even.samples[i].omega_m);
    const Kinematics k = trajectory->At(SecondsBetween(kImuStart, stamped.samples[i].timestamp));
    EXPECT_LT((stamped.samples[i].omega_m - k.omega_B).norm(), 1e-12);
    EXPECT_EQ(stamped.truth[i].instant, stamped.samples[i].timestamp);
    EXPECT_LT((stamped.truth[i].nav.p_GB - k.T_GB.p).norm(), 1e-12);
    // The truth of even stamps is the state there, not where the sample was taken.
    EXPECT_EQ(even.truth[i].instant, even.samples[i].timestamp);
    if (i > 0) {
      EXPECT_GT(stamped.samples[i].timestamp, stamped.samples[i - 1].timestamp);
    }
    square += std::pow(SecondsBetween(even.samples[i].timestamp, stamped.samples[i].timestamp), 2);
  }
  // 6001 numbers: their root mean square is known to 0.9 %; four of those.
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(even.samples.size())) / jitter_s, 1.0, 0.037);
}

TEST(ImuSimulator, LostSamplesAreCountedAndChangeNoOther) {
  const auto trajectory = MakeTrajectory("room_walk", 30.0, 0.0);
  const SimulatedImu whole = SimulateImu(*trajectory, kImuStart, NoisyImu(), {}, 7);
  const SimulatedImu lossy =
      SimulateImu(*trajectory, kImuStart, NoisyImu(), {.drop_share = 0.1}, 7);
  EXPECT_EQ(lossy.samples.size() + static_cast<std::size_t>(lossy.dropped), whole.samples.size());
  EXPECT_EQ(lossy.truth.size(), whole.truth.size());
  // Binomial, 6001 samples: sigma 23; four of those.
  EXPECT_NEAR(lossy.dropped, 600, 93);
  EXPECT_EQ(lossy.samples.front().timestamp, whole.samples.front().timestamp);
  EXPECT_EQ(lossy.samples.back().timestamp, whole.samples.back().timestamp);
  std::size_t i = 0;
  for (const ImuSample& sample : lossy.samples) {
    while (whole.samples[i].timestamp < sample.timestamp) ++i;
    EXPECT_EQ(whole.samples[i].omega_m, sample.omega_m);
    EXPECT_EQ(whole.samples[i].a_m, sample.a_m);
  }
}

// Through the options of a simulation, and said in its truth.yaml.
TEST(ImuSimulator, OptionsReachTheRecording) {
  SimulationOptions options;
  options.duration_s = 5.0;
  options.imu_drop_share = 0.05;
  options.gyroscope_range_rad_per_s = 0.2;
  options.imu_jitter_s = 2e-4;
  const SimulatedRecording recording = Simulate(options);
  EXPECT_GT(recording.dropped_imu_samples, 0);
  EXPECT_GT(recording.clipped_gyroscope_samples, 0);
  EXPECT_EQ(recording.clipped_accelerometer_samples, 0);
  const std::string yaml = TruthYaml(recording);
  EXPECT_NE(yaml.find("imu_lost_samples: " + std::to_string(recording.dropped_imu_samples)),
            std::string::npos);
  EXPECT_NE(yaml.find("gyroscope_clipped_samples: "), std::string::npos);
  EXPECT_EQ(yaml.find("accelerometer_clipped_samples"), std::string::npos);
  EXPECT_NEAR(ToRecording(recording).imu_sensor.rate_hz, 200.0, 0.1);
}

}  // namespace
}  // namespace duet
