#include "common/geometry/rotation_manifold.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/geometry/so3.h"

namespace duet {
namespace {

using ConstQuaternionMap = Eigen::Map<const Eigen::Quaterniond>;
using ConstVectorMap = Eigen::Map<const Eigen::Vector3d>;

// Derivative of the components (x, y, z, w) of Exp(theta) q by theta at 0.
Eigen::Matrix<double, 4, 3> LiftJacobian(const Eigen::Quaterniond& q) {
  Eigen::Matrix<double, 4, 3> J;
  J.topRows<3>() = -0.5 * Hat(q.vec());
  J.topRows<3>().diagonal().array() += 0.5 * q.w();
  J.bottomRows<1>() = -0.5 * q.vec().transpose();
  return J;
}

}  // namespace

bool RotationManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond sum = BoxPlus(ConstQuaternionMap(x), ConstVectorMap(delta));
  Eigen::Map<Eigen::Quaterniond> result(x_plus_delta);
  result = sum;
  return true;
}

bool RotationManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> J(jacobian);
  J = LiftJacobian(ConstQuaternionMap(x));
  return true;
}

bool RotationManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Eigen::Quaterniond q = ConstQuaternionMap(y) * ConstQuaternionMap(x).conjugate();
  const double n = q.vec().stableNorm();
  Eigen::Map<Eigen::Vector3d> theta(y_minus_x);
  if (n > 0.0) {
    theta = (2.0 * std::atan2(n, q.w()) / n) * q.vec();
  } else {
    // y = x, or y = -x: a full turn, about any axis.
    theta = q.w() < 0.0 ? Eigen::Vector3d(2.0 * std::numbers::pi, 0.0, 0.0)
                        : Eigen::Vector3d(0.0, 0.0, 0.0);
  }
  return true;
}

bool RotationManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> J(jacobian);
  // The columns of the lift are orthogonal and of length 1/2.
  J = 4.0 * LiftJacobian(ConstQuaternionMap(x)).transpose();
  return true;
}

}  // namespace duet
