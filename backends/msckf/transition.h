#pragma once

#include <Eigen/Core>

#include "common/imu/imu_delta.h"
#include "common/imu/nav_state.h"

namespace duet {

/// The error-state transition of one IMU interval (thesis appendix B), made of the shared ImuDelta:
///
///   x' = Phi x + Gamma T + w,   cov(w) = Q
///
/// with x = (theta, p, v, b_g, b_a) and T the 27 numbers of T_g, T_s, T_a (by rows). The rows of
/// Gamma for the biases are zero (B.2) and left out.
struct Transition {
  Matrix15d Phi = Matrix15d::Identity();
  Eigen::Matrix<double, 9, 27> Gamma = Eigen::Matrix<double, 9, 27>::Zero();
  Matrix15d Q = Matrix15d::Zero();
};

/// Phi (B.2), Gamma (B.22 to B.24, B.39 ff.) and Q of the delta between the two end states at which
/// the error is linearized: current estimates, or first ones. The blocks against theta,
///
///   Phi_p_theta = -[p' - p - v dt - g dt^2 / 2]x,   Phi_v_theta = -[v' - v - g dt]x
///
/// are differences of the end states rather than R_GB y and R_GB s of the delta, so that the
/// directions that cannot be observed, N = (g, -[p]x g, -[v]x g) and a shift of p, go over into one
/// another exactly: Phi N(start) = N(end), whatever the end states are.
/// `g_G` in m/s^2. Deviation from B.6: the rotation error is global and of the body (R_true =
/// Exp(theta) R), so that what the delta's errors are rotated by is R_GB at the start.
[[nodiscard]] Transition MakeTransition(const ImuDelta& delta, const NavState& start,
                                        const NavState& end, const Eigen::Vector3d& g_G);

}  // namespace duet
