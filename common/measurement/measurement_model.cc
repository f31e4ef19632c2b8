#include "common/measurement/measurement_model.h"

#include "common/geometry/so3.h"
#include "common/support/logging.h"

namespace duet {

double ObservationDelay(const RigCalibration& rig, const PixelObservation& observation,
                        double t_d_at_instant_s) {
  const double shift = rig.t_d_s - t_d_at_instant_s;
  if (rig.t_r_s == 0.0) return shift;
  const CameraModel& model = rig.cameras[observation.camera].model;
  const int n = rig.readout_by_columns ? model.width_px() : model.height_px();
  const double row = rig.readout_by_columns ? observation.uv.x() : observation.uv.y();
  return shift + (row - 0.5 * (n - 1)) * rig.t_r_s / n;
}

bool PredictPixel(const RigCalibration& rig, const Pose& anchor_T_GB, const InverseDepth& landmark,
                  const ObservingState& state, const PixelObservation& observation,
                  const Eigen::Vector3d& g_G, Eigen::Vector2d* uv,
                  ObservationJacobians* jacobians) {
  const CameraCalibration& anchor_camera = rig.cameras[0];
  const CameraCalibration& camera = rig.cameras[observation.camera];
  const double rho = landmark.z();

  const double tau = ObservationDelay(rig, observation, state.t_d_at_instant_s);
  const bool moved = state.rates != nullptr;
  CHECK(moved || tau == 0.0) << "an observation off its state's instant needs the rates there";
  RateProfile::Motion motion;
  Eigen::Quaterniond R_t = state.nav.R_GB;
  Eigen::Vector3d p_t = state.nav.p_GB;
  Eigen::Vector3d Ri_y = Eigen::Vector3d::Zero();
  if (moved) {
    motion = state.memo != nullptr ? state.rates->At(tau, state.memo) : state.rates->At(tau);
    if (tau != 0.0) {
      R_t = state.nav.R_GB * motion.R;
      Ri_y = state.nav.R_GB * motion.y;
      p_t += tau * state.nav.v_GB + 0.5 * tau * tau * g_G + Ri_y;
    }
  }

  const Eigen::Matrix3d R_BC0 = anchor_camera.R_CB.conjugate().toRotationMatrix();
  const Eigen::Matrix3d R_a = anchor_T_GB.R.toRotationMatrix();
  const Eigen::Matrix3d R_GC0 = R_a * R_BC0;  // at the anchor
  const Eigen::Vector3d m(landmark.x(), landmark.y(), 1.0);
  const Eigen::Vector3d u = m - rho * anchor_camera.p_CB;
  const Eigen::Vector3d R_a_q_B = R_GC0 * u;
  const Eigen::Vector3d v = R_a_q_B + rho * (anchor_T_GB.p - p_t);  // q_G - rho p(t)
  const Eigen::Matrix3d R_CB = camera.R_CB.toRotationMatrix();
  const Eigen::Matrix3d M = R_CB * R_t.toRotationMatrix().transpose();  // R_CG
  const Eigen::Vector3d R_q_Bi = M * v;
  const Eigen::Vector3d q_C = R_q_Bi + rho * camera.p_CB;

  if (jacobians == nullptr) return camera.model.Project(q_C, uv);

  Eigen::Matrix<double, 2, 3> J_q;
  if (!camera.model.Project(q_C, uv, &J_q, &jacobians->parameters)) return false;
  const Eigen::Matrix<double, 2, 3> J_G = J_q * M;  // d uv / d q_G
  const Eigen::Matrix<double, 2, 3> J_C0 = J_G * R_GC0;
  const Eigen::Matrix<double, 2, 3> J_position = rho * J_G;

  jacobians->landmark.leftCols<2>() = J_C0.leftCols<2>();
  jacobians->landmark.col(2) =
      J_G * (anchor_T_GB.p - p_t) - J_C0 * anchor_camera.p_CB + J_q * camera.p_CB;

  jacobians->anchor.leftCols<3>() = -J_G * Hat(R_a_q_B);
  jacobians->anchor.rightCols<3>() = J_position;

  const Eigen::Matrix<double, 2, 3> J_theta_t = J_G * Hat(v);
  jacobians->state.leftCols<3>() = J_theta_t;
  jacobians->state.middleCols<3>(3) = -J_position;
  if (tau != 0.0) {
    jacobians->state.leftCols<3>() += J_position * Hat(Ri_y);
    jacobians->state.rightCols<3>() = -tau * J_position;
  } else {
    jacobians->state.rightCols<3>().setZero();
  }

  jacobians->anchor_extrinsics.leftCols<3>() = -rho * J_C0;
  jacobians->anchor_extrinsics.rightCols<3>() = J_C0 * Hat(u);
  jacobians->extrinsics.leftCols<3>() = rho * J_q;
  jacobians->extrinsics.rightCols<3>() = -J_q * Hat(R_q_Bi);

  jacobians->t_d.setZero();
  jacobians->t_r.setZero();
  if (moved) {
    const Eigen::Vector3d theta_rate = R_t * motion.omega_B;
    const Eigen::Vector3d p_rate = state.nav.v_GB + tau * g_G + state.nav.R_GB * motion.s;
    jacobians->t_d = J_theta_t * theta_rate - J_position * p_rate;
    const int n = rig.readout_by_columns ? camera.model.width_px() : camera.model.height_px();
    const double row = rig.readout_by_columns ? observation.uv.x() : observation.uv.y();
    jacobians->t_r = ((row - 0.5 * (n - 1)) / n) * jacobians->t_d;
  }
  return true;
}

Eigen::Vector3d LandmarkInGlobal(const RigCalibration& rig, const Pose& anchor_T_GB,
                                 const InverseDepth& landmark) {
  const CameraCalibration& camera = rig.cameras[0];
  const Eigen::Vector3d x_C0 = Eigen::Vector3d(landmark.x(), landmark.y(), 1.0) / landmark.z();
  return anchor_T_GB * (camera.R_CB.conjugate() * (x_C0 - camera.p_CB));
}

bool LandmarkFromGlobal(const RigCalibration& rig, const Pose& anchor_T_GB,
                        const Eigen::Vector3d& p_G, InverseDepth* landmark) {
  const CameraCalibration& camera = rig.cameras[0];
  const Eigen::Vector3d x_C0 = camera.R_CB * (anchor_T_GB.Inverse() * p_G) + camera.p_CB;
  if (!(x_C0.z() > 1e-6)) return false;
  *landmark = Eigen::Vector3d(x_C0.x(), x_C0.y(), 1.0) / x_C0.z();
  return true;
}

}  // namespace duet
