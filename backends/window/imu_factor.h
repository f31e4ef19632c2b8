#pragma once

#include <Eigen/Core>

#include "common/imu/imu_delta.h"
#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"

namespace duet {

/// Jacobians of the IMU factor, rows (theta, s, y, b_g, b_a), columns as in InertialState
/// (theta, p, v, b_g, b_a) and T_g, T_s, T_a by rows.
struct ImuFactorJacobians {
  Matrix15d J_i;
  Matrix15d J_j;
  Eigen::Matrix<double, 15, 27> J_T;
};

/// The IMU delta between two states as a residual (thesis 6.15 to 6.17; DESIGN.md section 3):
///
///   r_theta = Log(R_i' R_j dR')                          rad, in the frame of state i
///   r_s     = R_i' (v_j - v_i - g dt) - s                m/s
///   r_y     = R_i' (p_j - p_i - v_i dt - g dt^2 / 2) - y m
///   r_bg    = b_g,j - b_g,i,   r_ba = b_a,j - b_a,i
///
/// with (dR, s, y) corrected to first order to the biases of state i and to `calibration`. r is the
/// delta's error e, so that its covariance is delta.covariance. Not whitened.
void EvaluateImuFactor(const ImuDelta& delta, const NavState& nav_i, const ImuBiases& biases_i,
                       const NavState& nav_j, const ImuBiases& biases_j,
                       const ImuCalibration& calibration, const Eigen::Vector3d& g_G, Vector15d* r,
                       ImuFactorJacobians* jacobians = nullptr);

/// W with W'W = covariance^-1 (lower triangular: the inverse of the Cholesky factor). Components
/// without any variance (a density of zero) get the one that corresponds to 1e-9 of the unit.
[[nodiscard]] Matrix15d SquareRootInformation(const Matrix15d& covariance);

}  // namespace duet
