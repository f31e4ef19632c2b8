#include "backends/window/window_linearizer.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "backends/window/window_problem.h"

namespace duet {
namespace {

// How far from its pixel a landmark may lie at the first estimates.
constexpr double kFirstEstimateReach_px = 100.0;

}  // namespace

WindowLinearizer::WindowLinearizer(const WindowOptions& options,
                                   const ReprojectionSetup& reprojection,
                                   const StandstillOptions& standstill,
                                   const CalibrationLayout& layout)
    : options_(options),
      reprojection_(reprojection),
      standstill_(standstill),
      layout_(layout),
      loss_(MakeLoss(options)) {}

void WindowLinearizer::SetWindow(const std::vector<WindowFrame>& frames,
                                 const RigCalibration& rig) {
  frames_ = &frames;
  now_.nav.clear();
  now_.biases.clear();
  for (const WindowFrame& frame : frames) {
    now_.nav.push_back(frame.state.nav);
    now_.biases.push_back(frame.state.biases);
  }
  now_.rig = rig;
  first_ = now_;
  if (!options_.first_estimates) return;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].pose_in_prior) {
      first_.nav[i].R_GB = frames[i].origin.nav.R_GB;
      first_.nav[i].p_GB = frames[i].origin.nav.p_GB;
    }
    if (frames[i].velocity_in_prior) first_.nav[i].v_GB = frames[i].origin.nav.v_GB;
  }
}

void WindowLinearizer::AddLink(int i, NormalEquations* equations) const {
  const WindowFrame& frame = (*frames_)[i];
  if (frame.link) {
    const ImuDelta& delta = frame.link->delta;
    Vector15d r;
    Vector15d r_first;
    ImuFactorJacobians J;
    EvaluateImuFactor(delta, now_.nav[i - 1], now_.biases[i - 1], now_.nav[i], now_.biases[i],
                      now_.rig.imu, reprojection_.g_G, &r);
    EvaluateImuFactor(delta, first_.nav[i - 1], first_.biases[i - 1], first_.nav[i],
                      first_.biases[i], first_.rig.imu, reprojection_.g_G, &r_first, &J);
    const auto W = frame.link->sqrt_information.triangularView<Eigen::Lower>();
    r = (W * r).eval();
    J.J_i = (W * J.J_i).eval();
    J.J_j = (W * J.J_j).eval();
    J.J_T = (W * J.J_T).eval();
    equations->AddImu(i - 1, i, r, J);
  }
  if (frame.at_rest_since_before) {
    StandstillResidual residual = EvaluateStandstill(first_.nav[i - 1], first_.nav[i], standstill_);
    residual.r = EvaluateStandstill(now_.nav[i - 1], now_.nav[i], standstill_).r;
    equations->AddStandstill(i - 1, i, residual);
  }
}

void WindowLinearizer::AddLandmark(const Landmark& landmark, int last_frame,
                                   NormalEquations* equations) {
  const bool inverse_depth_only =
      options_.landmark_parameters == WindowOptions::LandmarkParameters::kInverseDepthOnly;
  const int anchor = landmark.anchor();
  std::size_t used = 0;
  for (const LandmarkObservation& o : landmark.observations) {
    if (o.frame > last_frame) break;
    if (inverse_depth_only && IsAnchorPixel(landmark, o)) continue;
    if (used == observations_.size()) observations_.emplace_back();
    LinearObservation& linear = observations_[used];
    linear.frame = o.frame;
    Eigen::Vector2d r_first;
    if (!EvaluateReprojection(reprojection_, now_, *frames_, anchor, o, landmark.value,
                              &linear.r)) {
      continue;
    }
    // Where the first estimates put the point behind the camera or far from its pixel, the pixel is
    // left out: Jacobians there say nothing of those here, and any others would add information
    // about yaw.
    if (!EvaluateReprojection(reprojection_, first_, *frames_, layout_, anchor, o, landmark.value,
                              &r_first, &linear.J) ||
        r_first.norm() * reprojection_.pixel_noise_px > kFirstEstimateReach_px) {
      continue;
    }
    if (loss_ != nullptr) {
      double rho[3];
      loss_->Evaluate(linear.r.squaredNorm(), rho);
      const double weight = std::sqrt(rho[1]);
      linear.r *= weight;
      linear.J.landmark *= weight;
      linear.J.anchor *= weight;
      linear.J.state *= weight;
      linear.J.calibration *= weight;
    }
    ++used;
  }
  equations->AddLandmark(anchor, {observations_.data(), used}, reprojection_.off_instant,
                         inverse_depth_only);
}

void WindowLinearizer::ShiftToOrigin(const RigCalibration& rig_origin,
                                     InformationForm* form) const {
  Eigen::VectorXd deviation;
  DeviationFromOrigin(*frames_, now_, rig_origin, layout_, &deviation);
  form->b.noalias() -= form->H * deviation;
}

Eigen::MatrixXd NewestCovariance(const Eigen::MatrixXd& H, int calibration_size) {
  // Scaled to a unit diagonal; with H = L L' the corner of H^-1 is (L_22 L_22')^-1.
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return {};
  Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  if (llt.info() != Eigen::Success) return {};
  const Eigen::Index n = kFrameSize + calibration_size;
  Eigen::MatrixXd L_inverse = Eigen::MatrixXd::Identity(n, n);
  llt.matrixLLT().bottomRightCorner(n, n).triangularView<Eigen::Lower>().solveInPlace(L_inverse);
  L_inverse = (L_inverse * scale.tail(n).asDiagonal()).eval();
  Eigen::MatrixXd covariance = L_inverse.transpose() * L_inverse;
  if (!covariance.allFinite()) return {};
  return covariance;
}

}  // namespace duet
