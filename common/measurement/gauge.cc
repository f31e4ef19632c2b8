#include "common/measurement/gauge.h"

#include <Eigen/LU>

#include "common/geometry/so3.h"

namespace duet {
namespace {

Eigen::Vector3d AboveDiagonal(const Eigen::Matrix3d& T) { return {T(0, 1), T(0, 2), T(1, 2)}; }

// Q with the numbers above the diagonal of T Q' equal to `told`'s: Newton's method from Q = I.
Eigen::Quaterniond AlignAboveDiagonal(const Eigen::Matrix3d& T, const Eigen::Matrix3d& told) {
  constexpr int kIterations = 20;
  constexpr double kConverged = 1e-15;
  Eigen::Quaterniond Q = Eigen::Quaterniond::Identity();
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::Matrix3d T_Q = T * Q.toRotationMatrix().transpose();
    const Eigen::Vector3d residual = AboveDiagonal(T_Q) - AboveDiagonal(told);
    // Q <- Exp(phi) Q turns T Q' into T Q' (I - [phi]x).
    Eigen::Matrix3d J;
    for (int k = 0; k < 3; ++k) {
      J.col(k) = AboveDiagonal(-T_Q * Hat(Eigen::Vector3d(Eigen::Vector3d::Unit(k))));
    }
    const Eigen::Vector3d phi = J.partialPivLu().solve(-residual);
    Q = (ExpQuaternion(phi) * Q).normalized();
    if (phi.norm() < kConverged) break;
  }
  return Q;
}

}  // namespace

bool GaugeActs(const CalibrationPriors& priors) {
  if (!priors.T_g.estimated || !priors.T_a.estimated) return false;
  const bool first_R_CB = priors.R_CB.estimated && priors.Estimates(0);
  switch (priors.imu_frame) {
    case ImuFrame::kGyroscope:
    case ImuFrame::kAccelerometer:
      return first_R_CB;
    case ImuFrame::kCamera:
      return !first_R_CB;
    case ImuFrame::kFree:
      return false;
  }
  return false;
}

std::string GaugeError(const CalibrationPriors& priors) {
  if (priors.imu_frame != ImuFrame::kCamera || !priors.T_g.estimated || !priors.T_a.estimated ||
      !priors.R_CB.estimated || !priors.Estimates(0)) {
    return "";
  }
  return "camera ties the body's axes to the first camera: R_CB cannot be estimated beside full "
         "T_g "
         "and T_a; expected R_CB.state fixed, or imu_frame gyroscope or accelerometer";
}

Eigen::Quaterniond GaugeRotation(const RigCalibration& true_rig, const RigCalibration& told_rig,
                                 const CalibrationPriors& priors) {
  if (!GaugeActs(priors)) return Eigen::Quaterniond::Identity();
  switch (priors.imu_frame) {
    case ImuFrame::kGyroscope:
      return AlignAboveDiagonal(true_rig.imu.T_g, told_rig.imu.T_g);
    case ImuFrame::kAccelerometer:
      return AlignAboveDiagonal(true_rig.imu.T_a, told_rig.imu.T_a);
    case ImuFrame::kCamera:  // R_true Q' = R_told
      return told_rig.cameras[0].R_CB.conjugate() * true_rig.cameras[0].R_CB;
    case ImuFrame::kFree:
      break;
  }
  return Eigen::Quaterniond::Identity();
}

RigCalibration Reoriented(const RigCalibration& rig, const Eigen::Quaterniond& Q) {
  RigCalibration turned = rig;
  const Eigen::Matrix3d Q_transposed = Q.toRotationMatrix().transpose();
  turned.imu.T_g = rig.imu.T_g * Q_transposed;
  turned.imu.T_s = rig.imu.T_s * Q_transposed;
  turned.imu.T_a = rig.imu.T_a * Q_transposed;
  for (CameraCalibration& camera : turned.cameras) {
    camera.R_CB = (camera.R_CB * Q.conjugate()).normalized();
  }
  return turned;
}

InertialState Reoriented(const InertialState& state, const Eigen::Quaterniond& Q) {
  InertialState turned = state;
  turned.nav.R_GB = (state.nav.R_GB * Q.conjugate()).normalized();
  return turned;
}

}  // namespace duet
