#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace duet {

/// The car of thesis 3.4: a Kalman filter with the state (position, velocity), driven by a measured
/// acceleration (3.20, 3.21) and corrected by a measured velocity (3.22, 3.23). The car goes
/// forwards and backwards along a sine. Its position is never measured and not observable (3.24,
/// 3.25): its uncertainty grows without bound, while the error stays within it.
struct CarOptions {
  double duration_s = 200.0;
  double step_s = 0.1;
  double amplitude_m = 10.0;
  double period_s = 20.0;
  /// Standard deviations of one measurement. 3.21 calls Q's entry delta_a^2; with the input matrix
  /// (0, step) it is (step delta_a)^2.
  double acceleration_sigma = 0.5;  ///< m/s^2
  double velocity_sigma = 0.5;      ///< m/s
  std::uint64_t seed = 1;
};

/// One instant after its update; both hold position [m] and velocity [m/s].
struct CarState {
  double t_s = 0.0;
  Eigen::Vector2d truth = Eigen::Vector2d::Zero();
  Eigen::Vector2d estimate = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

/// From a start that is known exactly. The truth follows the filter's own model, step by step.
[[nodiscard]] std::vector<CarState> DriveCar(const CarOptions& options);

/// O_k of 3.24 after `steps` steps: rows C, C A, C A^2, ...
[[nodiscard]] Eigen::MatrixXd CarObservabilityMatrix(const CarOptions& options, int steps);

}  // namespace duet
