#pragma once

#include <Eigen/Core>

#include "backends/window/window_state.h"

namespace duet {

/// What a reprojection residual depends on besides the point: whether observations may lie off
/// their state's instant (t_d or t_r estimated, or a rolling shutter).
struct ReprojectionSetup {
  Eigen::Vector3d g_G = Eigen::Vector3d::Zero();
  double pixel_noise_px = 1.0;
  bool off_instant = false;
};

/// Jacobians of a whitened residual of pixel and landmark, errors as in DESIGN.md section 3.
/// Anchor and state are apart even where they are the same frame: they add up then.
struct ReprojectionJacobians {
  static constexpr int kMaxCalibration = 128;
  Eigen::Matrix<double, 2, 3> landmark;
  Eigen::Matrix<double, 2, 6> anchor;  ///< theta, p
  Eigen::Matrix<double, 2, 9> state;   ///< theta, p, v
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMaxCalibration> calibration;
};

/// d uv / d calibration over `layout`'s components, for a pixel of `camera`: what a block does in
/// both roles (C0 as the anchor's camera and as the observing one) adds up.
void CalibrationJacobian(const ObservationJacobians& J, const CalibrationLayout& layout, int camera,
                         Eigen::Ref<Eigen::Matrix<double, 2, Eigen::Dynamic>> out);

/// r = (predicted - measured) / pixel_noise, by the shared measurement model (PredictPixel).
/// False where the point does not lie in front of the camera.
[[nodiscard]] bool EvaluateReprojection(const ReprojectionSetup& setup, const WindowPoint& point,
                                        const std::vector<WindowFrame>& frames, int anchor,
                                        const LandmarkObservation& observation,
                                        const InverseDepth& landmark, Eigen::Vector2d* r);

/// The same with its Jacobians; those to the calibration over `layout`'s components.
[[nodiscard]] bool EvaluateReprojection(const ReprojectionSetup& setup, const WindowPoint& point,
                                        const std::vector<WindowFrame>& frames,
                                        const CalibrationLayout& layout, int anchor,
                                        const LandmarkObservation& observation,
                                        const InverseDepth& landmark, Eigen::Vector2d* r,
                                        ReprojectionJacobians* jacobians);

}  // namespace duet
