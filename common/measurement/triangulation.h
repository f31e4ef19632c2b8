#pragma once

#include <span>

#include "common/measurement/measurement_model.h"

namespace duet {

enum class TriangulationStatus {
  kOk,
  kTooFewObservations,  ///< fewer than two rays
  kNoParallax,          ///< the rays do not fix the depth
  kBehindCamera,
  kNotConverged,
  kTooNear,
  kTooFar,
  kLargeResidual,
};
[[nodiscard]] const char* TriangulationStatusName(TriangulationStatus status);

struct TriangulationOptions {
  int max_iterations = 8;
  double min_depth_m = 0.1;
  double max_depth_m = 200.0;
  /// Largest angle between two rays must exceed this, rad.
  double min_parallax_rad = 0.003;
  /// Root mean square reprojection error above which the track is refused, px.
  double max_rms_px = 8.0;
};

struct TrackObservationInState {
  ObservingState state;
  PixelObservation observation;
};

/// A point from its pixels and the states that saw it (thesis 5.1): linear least squares on the
/// rays, then damped Gauss-Newton in (alpha, beta, rho) on pixels through PredictPixel. `anchor` is
/// the index of the anchor among the observations' states (its own pixel is a residual like every
/// other). Allocates nothing. `landmark` is written for kOk only.
[[nodiscard]] TriangulationStatus Triangulate(const RigCalibration& rig,
                                              std::span<const TrackObservationInState> observations,
                                              const Pose& anchor_T_GB, const Eigen::Vector3d& g_G,
                                              const TriangulationOptions& options,
                                              InverseDepth* landmark);

}  // namespace duet
