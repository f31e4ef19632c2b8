#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "common/imu/imu_model.h"
#include "common/imu/imu_sample.h"
#include "common/imu/nav_state.h"
#include "common/support/timestamp.h"

namespace duet {

/// The one IMU step of the project (thesis 6.15 to 6.17; DESIGN.md section 3): what the IMU says of
/// the motion over [start, end], in the frame of its start, free of gravity and of the state:
///
///   R_end = R_start * R
///   v_end = v_start + g dt + R_start * s
///   p_end = p_start + v_start dt + g dt^2 / 2 + R_start * y
///
/// Its error is e = (theta, s, y, b_g, b_a), 15 numbers: R_true = Exp(theta) R (theta on the left,
/// in the frame of the start), the others true minus estimate, biases those at the *end* given the
/// ones at the start. From it the filter makes Phi, Gamma and Q of appendix B and the window its
/// factor. dt may be negative (rows before the middle of a rolling shutter).
struct ImuDelta {
  Timestamp start = 0;
  Timestamp end = 0;
  double dt_s = 0.0;

  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d s = Eigen::Vector3d::Zero();  ///< m/s
  Eigen::Vector3d y = Eigen::Vector3d::Zero();  ///< m

  /// Covariance of e from the white noises and the bias walks inside the interval; zero at dt = 0.
  Matrix15d covariance = Matrix15d::Zero();

  /// d(theta, s, y) / d(biases at the start) and / d(T_g, T_s, T_a by rows).
  Eigen::Matrix<double, 9, 3> J_b_g = Eigen::Matrix<double, 9, 3>::Zero();
  Eigen::Matrix<double, 9, 3> J_b_a = Eigen::Matrix<double, 9, 3>::Zero();
  Eigen::Matrix<double, 9, 27> J_T = Eigen::Matrix<double, 9, 27>::Zero();

  /// What it was integrated with.
  ImuBiases biases;
  ImuCalibration calibration;
};

struct ImuDeltaOptions {
  bool covariance = true;             ///< fill ImuDelta::covariance
  bool bias_jacobians = true;         ///< fill J_b_g and J_b_a (needed by covariance)
  bool calibration_jacobians = true;  ///< fill J_T
};

/// Integrates the readings (ends included, as ImuBuffer::Extract gives them; ascending or
/// descending) by the classic Runge-Kutta method of fourth order on (R, s, y), rates linear between
/// readings (6.11 to 6.13). Jacobians and covariance by quadratures of the same order along it.
/// CHECKs that `readings` is not empty.
[[nodiscard]] ImuDelta IntegrateImu(std::span<const ImuSample> readings, const ImuBiases& biases,
                                    const ImuCalibration& calibration, const ImuNoise& noise,
                                    const ImuDeltaOptions& options = {});

/// The delta over both intervals; second.start must be first.end, both integrated with the same
/// biases and calibration (the biases of the second are those at its own start, whose walk over
/// the first the covariance accounts for).
[[nodiscard]] ImuDelta Compose(const ImuDelta& first, const ImuDelta& second);

/// First-order correction of (R, s, y) to other biases and calibration; covariance and Jacobians
/// stay those of the linearization point.
struct CorrectedDelta {
  Eigen::Quaterniond R;
  Eigen::Vector3d s;
  Eigen::Vector3d y;
};
[[nodiscard]] CorrectedDelta CorrectToFirstOrder(const ImuDelta& delta, const ImuBiases& biases,
                                                 const ImuCalibration& calibration);

/// How far biases and calibration have moved from the linearization point, as the largest change of
/// theta [rad] and of s [m/s] and y [m] to first order, neglected second order about its square.
/// The window integrates again beyond a threshold.
[[nodiscard]] double DistanceFromLinearization(const ImuDelta& delta, const ImuBiases& biases,
                                               const ImuCalibration& calibration);

/// The state at the end of the delta. g_G in m/s^2, e.g. (0, 0, -9.81).
[[nodiscard]] NavState Predict(const NavState& start, const ImuDelta& delta,
                               const Eigen::Vector3d& g_G);

/// T_g, T_s, T_a by rows, 27 numbers, and back.
[[nodiscard]] Eigen::Matrix<double, 27, 1> ToVector(const ImuCalibration& calibration);
[[nodiscard]] ImuCalibration ImuCalibrationFromVector(const Eigen::Matrix<double, 27, 1>& vector);

}  // namespace duet
