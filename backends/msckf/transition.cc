#include "backends/msckf/transition.h"

#include "common/geometry/so3.h"

namespace duet {
namespace {

constexpr int kTheta = 0;
constexpr int kP = 3;
constexpr int kV = 6;
constexpr int kBg = 9;
constexpr int kBa = 12;
// The delta's own order is (theta, s, y).
constexpr int kDeltaTheta = 0;
constexpr int kDeltaS = 3;
constexpr int kDeltaY = 6;

/// Rows of the delta's error (theta, s, y), in the frame of its start, as (theta, p, v) in G.
template <int kColumns>
Eigen::Matrix<double, 9, kColumns> ToGlobal(const Eigen::Matrix3d& R_GB,
                                            const Eigen::Matrix<double, 9, kColumns>& rows) {
  Eigen::Matrix<double, 9, kColumns> global;
  global.template middleRows<3>(kTheta).noalias() = R_GB * rows.template middleRows<3>(kDeltaTheta);
  global.template middleRows<3>(kP).noalias() = R_GB * rows.template middleRows<3>(kDeltaY);
  global.template middleRows<3>(kV).noalias() = R_GB * rows.template middleRows<3>(kDeltaS);
  return global;
}

}  // namespace

Transition MakeTransition(const ImuDelta& delta, const NavState& start, const NavState& end,
                          const Eigen::Vector3d& g_G) {
  const double dt = delta.dt_s;
  const Eigen::Matrix3d R_GB = start.R_GB.toRotationMatrix();

  Transition t;
  t.Phi.block<3, 3>(kP, kTheta) =
      -Hat(end.p_GB - start.p_GB - start.v_GB * dt - 0.5 * dt * dt * g_G);
  t.Phi.block<3, 3>(kV, kTheta) = -Hat(end.v_GB - start.v_GB - dt * g_G);
  t.Phi.block<3, 3>(kP, kV) = dt * Eigen::Matrix3d::Identity();
  t.Phi.block<9, 3>(kTheta, kBg) = ToGlobal(R_GB, delta.J_b_g);
  t.Phi.block<9, 3>(kTheta, kBa) = ToGlobal(R_GB, delta.J_b_a);
  t.Gamma = ToGlobal(R_GB, delta.J_T);

  Eigen::Matrix<double, 9, 9> half = ToGlobal<9>(R_GB, delta.covariance.topLeftCorner<9, 9>());
  half = ToGlobal<9>(R_GB, half.transpose());
  t.Q.topLeftCorner<9, 9>() = 0.5 * (half + half.transpose());
  t.Q.topRightCorner<9, 6>() = ToGlobal<6>(R_GB, delta.covariance.topRightCorner<9, 6>());
  t.Q.bottomLeftCorner<6, 9>() = t.Q.topRightCorner<9, 6>().transpose();
  t.Q.bottomRightCorner<6, 6>() = delta.covariance.bottomRightCorner<6, 6>();
  return t;
}

}  // namespace duet
