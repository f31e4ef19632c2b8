#pragma once

#include <ceres/loss_function.h>

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "backends/window/normal_equations.h"
#include "backends/window/prior.h"
#include "backends/window/window_options.h"
#include "backends/window/window_state.h"

namespace duet {

/// Linearizes a window's factors for marginalization and for the covariance:
///
///   r(x) ~ r(x_now) + J(x_first) (x - x_now)
///
/// x_first takes frames' theta, p, v where they are in a prior already from the value they entered
/// it with (first estimates: no factor may linearize a frame elsewhere than the prior did, or the
/// sum gains information about yaw and position that nobody measured); biases, calibration,
/// landmarks and frames outside the prior stand at their current values. A pixel of a robust loss
/// enters with the loss's slope at its residual as its weight, as in the solver's last step.
class WindowLinearizer {
 public:
  WindowLinearizer(const WindowOptions& options, const ReprojectionSetup& reprojection,
                   const StandstillOptions& standstill, const CalibrationLayout& layout);

  /// Sets the points from the window's current state; both are kept by reference.
  void SetWindow(const std::vector<WindowFrame>& frames, const RigCalibration& rig);

  [[nodiscard]] const WindowPoint& now() const { return now_; }
  [[nodiscard]] const WindowPoint& first() const { return first_; }

  /// The IMU and the standstill measurement between frame `i` and the one before, where there are.
  void AddLink(int i, NormalEquations* equations) const;

  /// The landmark's pixels in frames up to `last_frame`.
  void AddLandmark(const Landmark& landmark, int last_frame, NormalEquations* equations);

  /// How the depth follows from all of the landmark's pixels.
  void LinearizeDepth(const Landmark& landmark, DepthRow* depth);

  /// Moves a quadratic about the current values to the origins of the prior.
  void ShiftToOrigin(const RigCalibration& rig_origin, InformationForm* form) const;

 private:
  /// The landmark's pixels in frames up to `last_frame`; valid until the next call.
  [[nodiscard]] std::span<const LinearObservation> Linearize(const Landmark& landmark,
                                                             int last_frame);

  const WindowOptions& options_;
  const ReprojectionSetup& reprojection_;
  const StandstillOptions& standstill_;
  const CalibrationLayout& layout_;
  std::unique_ptr<ceres::LossFunction> loss_;
  const std::vector<WindowFrame>* frames_ = nullptr;
  WindowPoint now_;
  WindowPoint first_;
  std::vector<LinearObservation> observations_;  // scratch
};

/// The covariance of the newest frame (theta, p, v, b_g, b_a) and the calibration from the
/// information over the whole window, whose last components these are: the lower right corner of
/// H^-1, from a Cholesky factor. Empty where H is not positive definite.
[[nodiscard]] Eigen::MatrixXd NewestCovariance(const Eigen::MatrixXd& H, int calibration_size);

}  // namespace duet
