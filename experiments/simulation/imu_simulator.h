#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/imu/imu_model.h"
#include "common/imu/imu_sample.h"
#include "common/imu/nav_state.h"
#include "experiments/simulation/trajectory.h"

namespace duet {

/// How an IMU departs from one that samples evenly and reads any rate.
struct ImuSampling {
  double rate_hz = 200.0;
  /// The largest reading of an axis, either sign; what is beyond (noise included) reads as that. 0:
  /// none. [rad/s, m/s^2]
  double gyroscope_range = 0.0;
  double accelerometer_range = 0.0;
  /// 1 sigma of each sampling instant about its even place [s]; no instant leaves its place by more
  /// than 0.45 of an interval, so that their order stays.
  double jitter_s = 0.0;
  /// Stamps are the true instants; otherwise they stay even and are off by the jitter.
  bool jitter_is_stamped = true;
  /// Share of samples that are lost, each for itself; never the first and the last.
  double drop_share = 0.0;
};

/// What an IMU is, and the gravity that it is exposed to.
struct ImuUnderSimulation {
  ImuCalibration calibration = {};
  ImuNoise noise = {};
  ImuBiases biases = {};  ///< at the first sample
  Eigen::Vector3d g_G = Eigen::Vector3d::Zero();
};

struct SimulatedImu {
  std::vector<ImuSample> samples;
  /// One at every even or jittered stamp, those of lost samples too: the exact state at the stamp,
  /// the biases of its sample.
  std::vector<InertialState> truth;
  int dropped = 0;
  int clipped_gyroscope = 0;  ///< samples of which an axis was at the end of its range
  int clipped_accelerometer = 0;
};

/// What the IMU reads along the trajectory, from its start to its end, by the model of DESIGN.md
/// section 3 (thesis 4.3, B.8, B.9): exact rates at the sampling instants, through T_g, T_s, T_a
/// and the biases. White noise has the variance density^2 * rate a sample; the biases' walks the
/// variance density^2 * dt a step (4.6, 4.7). `start` is the stamp of the trajectory's t = 0.
/// Noise, jitter and losses are separate sequences of `seed`: each stays the same whatever the
/// others are.
[[nodiscard]] SimulatedImu SimulateImu(const Trajectory& trajectory, Timestamp start,
                                       const ImuUnderSimulation& imu, const ImuSampling& sampling,
                                       std::uint64_t seed);

/// The stamp of sample (or frame) `index` of an even sequence from `start` on.
[[nodiscard]] Timestamp EvenStamp(Timestamp start, int index, double rate_hz);

}  // namespace duet
