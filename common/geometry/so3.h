#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace duet {

/// The rotation group. Vectors are in rad; Exp(theta) rotates by |theta| about theta. The
/// exponential, its inverse and their Jacobians are exact to rounding at every angle: where the
/// closed forms cancel (below 0.5 rad at the worst) by their series.

/// [v]x with [v]x w = v x w.
[[nodiscard]] Eigen::Matrix3d Hat(const Eigen::Vector3d& v);

/// Unit quaternion of the rotation vector; any angle.
[[nodiscard]] Eigen::Quaterniond ExpQuaternion(const Eigen::Vector3d& theta);
/// Rotation matrix of the rotation vector; any angle.
[[nodiscard]] Eigen::Matrix3d Exp(const Eigen::Vector3d& theta);
/// Shortest rotation vector of R, |theta| <= pi; the sign of q does not matter.
[[nodiscard]] Eigen::Vector3d Log(const Eigen::Quaterniond& q);
[[nodiscard]] Eigen::Vector3d Log(const Eigen::Matrix3d& R);

/// Exp(theta + d) = Exp(J_l(theta) d) Exp(theta) + O(d^2).
[[nodiscard]] Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& theta);
[[nodiscard]] Eigen::Matrix3d LeftJacobianInverse(const Eigen::Vector3d& theta);
/// Exp(theta + d) = Exp(theta) Exp(J_r(theta) d) + O(d^2); J_r(theta) = J_l(-theta).
[[nodiscard]] Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& theta);
[[nodiscard]] Eigen::Matrix3d RightJacobianInverse(const Eigen::Vector3d& theta);

/// The rotation matrix nearest to M (Frobenius).
[[nodiscard]] Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& M);

/// Global, full-angle error (DESIGN.md section 3): R_true = Exp(theta) R_estimate.
[[nodiscard]] inline Eigen::Quaterniond BoxPlus(const Eigen::Quaterniond& R,
                                                const Eigen::Vector3d& theta) {
  return (ExpQuaternion(theta) * R).normalized();
}
/// theta with R_a = Exp(theta) R_b, shortest.
[[nodiscard]] inline Eigen::Vector3d BoxMinus(const Eigen::Quaterniond& R_a,
                                              const Eigen::Quaterniond& R_b) {
  return Log(R_a * R_b.conjugate());
}

}  // namespace duet
