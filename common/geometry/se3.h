#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/geometry/so3.h"
#include "common/support/timestamp.h"

namespace duet {

/// A rigid transform T_AB: x_A = R_AB * x_B + p_AB.
struct Pose {
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& x_B) const { return R * x_B + p; }
  [[nodiscard]] Pose operator*(const Pose& T_BC) const {
    return {(R * T_BC.R).normalized(), R * T_BC.p + p};
  }
  [[nodiscard]] Pose Inverse() const { return {R.conjugate(), -(R.conjugate() * p)}; }
};

/// A pose of B in G at an instant.
struct StampedPose {
  Timestamp timestamp = 0;
  Pose T_GB;
};

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// SE(3) exponential of (theta [rad], rho [m]): R = Exp(theta), p = J_l(theta) rho.
[[nodiscard]] Pose ExpSe3(const Vector6d& theta_rho);
/// Its inverse, the shortest.
[[nodiscard]] Vector6d LogSe3(const Pose& T);
/// ExpSe3(x + d) = ExpSe3(J d) ExpSe3(x) + O(d^2), both in the order (theta, rho).
[[nodiscard]] Matrix6d LeftJacobianSe3(const Vector6d& theta_rho);

}  // namespace duet
