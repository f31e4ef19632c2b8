#pragma once

#include <Eigen/Core>

#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"
#include "common/measurement/rate_profile.h"

namespace duet {

/// A landmark of both estimators (thesis 5.4): (alpha, beta, rho) with
/// x_C0 = (alpha, beta, 1) / rho in the frame of camera C0 at its anchor *state's* instant.
/// rho [1/m] may be zero or slightly negative during an optimization: everything below is
/// homogeneous in (alpha, beta, 1, rho).
using InverseDepth = Eigen::Vector3d;

/// One observation of a landmark by camera `camera` in the frame of a state.
struct PixelObservation {
  int camera = 0;      ///< index into RigCalibration::cameras
  Eigen::Vector2d uv;  ///< measured, raw px
};

/// The frame that an observation belongs to.
struct ObservingState {
  NavState nav;                        ///< at the instant s_i
  double t_d_at_instant_s = 0.0;       ///< the t_d that s_i was made with
  const RateProfile* rates = nullptr;  ///< may be null where t_d and t_r are fixed and tau is 0
  RateProfile::Memo* memo = nullptr;   ///< of `rates` and one observation; null for none
};

/// d uv / d everything, px per unit; errors as in DESIGN.md section 3. Blocks of the anchor are
/// for the anchor state's (theta, p); where anchor and observing state are the same state, the
/// blocks add up (the caller adds). `anchor_extrinsics` are camera C0's, `extrinsics` the observing
/// camera's: they too add up where that is C0.
struct ObservationJacobians {
  Eigen::Matrix<double, 2, 3> landmark;           ///< alpha, beta, rho
  Eigen::Matrix<double, 2, 6> anchor;             ///< theta, p
  Eigen::Matrix<double, 2, 9> state;              ///< theta, p, v
  Eigen::Matrix<double, 2, 6> anchor_extrinsics;  ///< p_CB, phi_CB of C0
  Eigen::Matrix<double, 2, 6> extrinsics;         ///< p_CB, phi_CB of the observing camera
  CameraModel::ParameterJacobian parameters;      ///< intrinsics and distortion of that camera
  Eigen::Vector2d t_d;                            ///< px/s
  Eigen::Vector2d t_r;                            ///< px/s
};

/// tau of 6.22: the observation's time after its state's instant, (t_d - t_d_at_instant) + k t_r/N
/// with k = row - (N-1)/2 of the *measured* row (or column).
[[nodiscard]] double ObservationDelay(const RigCalibration& rig,
                                      const PixelObservation& observation, double t_d_at_instant_s);

/// THE measurement model (5.2, 5.3, 6.20 to 6.22), used by the filter, the window and
/// triangulation:
///
///   q_B  = R_C0B' ((alpha, beta, 1) - rho p_C0B)         anchor's body frame, times rho
///   q_G  = R_a q_B + rho p_a
///   q_C  = R_CB R(s_i + tau)' (q_G - rho p(s_i + tau)) + rho p_CB,     uv = project(q_C)
///
/// with R(s_i + tau) = R_i dR, p(s_i + tau) = p_i + v_i tau + g tau^2 / 2 + R_i y from the rates
/// frozen in the profile. False where the point is not in front of the camera.
[[nodiscard]] bool PredictPixel(const RigCalibration& rig, const Pose& anchor_T_GB,
                                const InverseDepth& landmark, const ObservingState& state,
                                const PixelObservation& observation, const Eigen::Vector3d& g_G,
                                Eigen::Vector2d* uv, ObservationJacobians* jacobians = nullptr);

/// The landmark's point in G; rho must be positive.
[[nodiscard]] Eigen::Vector3d LandmarkInGlobal(const RigCalibration& rig, const Pose& anchor_T_GB,
                                               const InverseDepth& landmark);

/// The landmark of a point in G; nothing where it lies behind the anchor's camera C0 (z <= 1e-6 m).
[[nodiscard]] bool LandmarkFromGlobal(const RigCalibration& rig, const Pose& anchor_T_GB,
                                      const Eigen::Vector3d& p_G, InverseDepth* landmark);

}  // namespace duet
