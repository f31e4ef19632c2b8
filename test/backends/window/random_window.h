#pragma once

#include <Eigen/Core>
#include <vector>

#include "backends/window/reprojection_factor.h"
#include "backends/window/window_state.h"
#include "common/imu/imu_buffer.h"
#include "common/measurement/calibration.h"
#include "common/support/random.h"

namespace duet::window_test {

inline constexpr double kFrameInterval_s = 0.1;

/// Densities like EuRoC's.
[[nodiscard]] ImuNoise EurocNoise();

/// Calibration priors with every block estimated.
[[nodiscard]] CalibrationPriors EverythingEstimated();

/// A window with two cameras, a rolling shutter, t_d off by 3 ms, T matrices up to 5 % off, an
/// excited IMU, and landmarks with noisy pixels: nothing in it is special. Estimates are off from
/// what generated the measurements, so that no residual is zero.
struct RandomWindow {
  RandomWindow(int frame_count, int landmark_count, std::uint64_t seed);

  RigCalibration rig;
  CalibrationLayout layout;
  ReprojectionSetup reprojection;
  ImuBuffer imu;
  std::vector<WindowFrame> frames;
  std::vector<Landmark> landmarks;

  [[nodiscard]] WindowPoint Point() const;
};

[[nodiscard]] Eigen::Vector3d RandomVector(Random* random, double sigma);

}  // namespace duet::window_test
