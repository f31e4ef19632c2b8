#pragma once

#include <ceres/manifold.h>

namespace duet {

/// Ceres's view of the project's rotation error: ambient x, y, z, w (Eigen's storage of R),
/// tangent theta (global, full angle, rad): Plus(R, theta) = Exp(theta) R.
///
/// Ceres's own EigenQuaternionManifold is global too but half-angle, so that its covariances are a
/// quarter of ours. Jacobians are the true ones (4x3 and 3x4), not the [I; 0] shortcut: a cost
/// function's ambient Jacobian is J_tangent * MinusJacobian(R). Minus does not take the shortest
/// way round (2 atan2(|v|, w)): Ceres's round trip Plus(x, Minus(y, x)) = y needs the sign.
class RotationManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace duet
