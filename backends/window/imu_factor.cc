#include "backends/window/imu_factor.h"

#include <Eigen/Cholesky>

#include "common/geometry/so3.h"
#include "common/support/logging.h"

namespace duet {

void EvaluateImuFactor(const ImuDelta& delta, const NavState& nav_i, const ImuBiases& biases_i,
                       const NavState& nav_j, const ImuBiases& biases_j,
                       const ImuCalibration& calibration, const Eigen::Vector3d& g_G, Vector15d* r,
                       ImuFactorJacobians* jacobians) {
  const double dt = delta.dt_s;
  const CorrectedDelta corrected = CorrectToFirstOrder(delta, biases_i, calibration);
  const Eigen::Matrix3d R_BiG = nav_i.R_GB.toRotationMatrix().transpose();
  const Eigen::Vector3d dv_G = nav_j.v_GB - nav_i.v_GB - g_G * dt;
  const Eigen::Vector3d dp_G = nav_j.p_GB - nav_i.p_GB - nav_i.v_GB * dt - 0.5 * dt * dt * g_G;
  const Eigen::Vector3d r_theta =
      Log(nav_i.R_GB.conjugate() * nav_j.R_GB * corrected.R.conjugate());
  r->segment<3>(0) = r_theta;
  r->segment<3>(3) = R_BiG * dv_G - corrected.s;
  r->segment<3>(6) = R_BiG * dp_G - corrected.y;
  r->segment<3>(9) = biases_j.b_g - biases_i.b_g;
  r->segment<3>(12) = biases_j.b_a - biases_i.b_a;
  if (jacobians == nullptr) return;

  Matrix15d& J_i = jacobians->J_i;
  Matrix15d& J_j = jacobians->J_j;
  J_i.setZero();
  J_j.setZero();

  const Eigen::Matrix3d J_r_theta = LeftJacobianInverse(r_theta) * R_BiG;
  J_i.block<3, 3>(0, 0) = -J_r_theta;
  J_j.block<3, 3>(0, 0) = J_r_theta;
  J_i.block<3, 3>(3, 0) = R_BiG * Hat(dv_G);
  J_i.block<3, 3>(3, 6) = -R_BiG;
  J_j.block<3, 3>(3, 6) = R_BiG;
  J_i.block<3, 3>(6, 0) = R_BiG * Hat(dp_G);
  J_i.block<3, 3>(6, 3) = -R_BiG;
  J_i.block<3, 3>(6, 6) = -R_BiG * dt;
  J_j.block<3, 3>(6, 3) = R_BiG;

  // The correction c turns dR into Exp(c) dR, so r_theta = Log(R_i' R_j dR' Exp(-c)).
  const Eigen::Vector3d c = Log(corrected.R * delta.R.conjugate());
  const Eigen::Matrix3d J_r_c = -RightJacobianInverse(r_theta) * LeftJacobian(c);
  J_i.block<3, 3>(0, 9) = J_r_c * delta.J_b_g.topRows<3>();
  J_i.block<6, 3>(3, 9) = -delta.J_b_g.bottomRows<6>();
  J_i.block<3, 3>(0, 12) = J_r_c * delta.J_b_a.topRows<3>();
  J_i.block<6, 3>(3, 12) = -delta.J_b_a.bottomRows<6>();
  J_i.block<6, 6>(9, 9) = -Eigen::Matrix<double, 6, 6>::Identity();
  J_j.block<6, 6>(9, 9) = Eigen::Matrix<double, 6, 6>::Identity();

  jacobians->J_T.topRows<3>() = J_r_c * delta.J_T.topRows<3>();
  jacobians->J_T.middleRows<6>(3) = -delta.J_T.bottomRows<6>();
  jacobians->J_T.bottomRows<6>().setZero();
}

Matrix15d SquareRootInformation(const Matrix15d& covariance) {
  Matrix15d floored = covariance;
  floored.diagonal() = floored.diagonal().cwiseMax(1e-18);
  const Eigen::LLT<Matrix15d> llt(floored);
  CHECK(llt.info() == Eigen::Success) << "covariance of an IMU delta is not positive definite";
  Matrix15d W = Matrix15d::Identity();
  llt.matrixL().solveInPlace(W);
  return W;
}

}  // namespace duet
