#pragma once

#include <span>
#include <vector>

#include "backends/msckf/filter_state.h"
#include "backends/msckf/nullspace.h"
#include "common/measurement/measurement_model.h"

namespace duet {

/// Which components of the error state the columns of a visual measurement act on:
///
///   | oldest clone | next clone | ... | newest clone | cameras and times | residual |
///
/// A clone has 6 columns (theta, p), or 9 (with v) where t_d or t_r is estimated or t_r is not
/// zero: only then does a pixel depend on the velocity. The newest state's own components are left
/// out: its error *is* the newest clone's. The T matrices are left out: a pixel depends on them by
/// the IMU within tau only, which DESIGN.md leaves out by definition.
class VisualColumns {
 public:
  /// Columns for the state's present window. `components` is what KalmanUpdate wants.
  void Assign(const FilterState& state);

  [[nodiscard]] int width() const { return static_cast<int>(components_.size()); }
  [[nodiscard]] int CloneColumn(int clone) const { return clone * clone_size_; }
  /// Column of a calibration block, -1 where it is not estimated.
  [[nodiscard]] int CalibrationColumn(const CalibrationLayout& layout, CalibrationBlock block,
                                      int camera = -1) const;
  [[nodiscard]] std::span<const int> components() const { return components_; }

 private:
  int clone_size_ = 6;
  int first_calibration_column_ = 0;
  int first_calibration_offset_ = 0;  // of the cameras' part, in the layout
  std::vector<int> components_;
};

/// A pixel of the landmark that is being linearized.
struct CloneObservation {
  int clone = 0;  ///< index into FilterState::clones()
  PixelObservation pixel;
};

struct LinearizationSettings {
  /// Jacobians at first estimates that are not the current ones (FilterState).
  bool separate_first_estimates = false;
  double pixel_noise_px = 1.0;
  Eigen::Vector3d g_G = Eigen::Vector3d(0, 0, -9.81);
};

/// The stacked, whitened measurements of one landmark (thesis 6.19 to 6.22, figure 6.3): two rows
/// an observation, [H_x | r] in `rows` and H_f (against alpha, beta, rho) in `H_f`.
///
/// The residual is taken at the current estimates, the Jacobians at the clones' first estimates and
/// at the landmark as triangulated, in its anchor's frame: an anchored landmark has no part in the
/// unobservable directions, so every row is orthogonal to N(first estimates) of transition.h,
/// whatever the landmark. Calibration is taken at its current value. False where the point is not
/// in front of a camera at either of the two linearization points.
[[nodiscard]] bool LinearizeLandmark(const FilterState& state, const VisualColumns& columns,
                                     const LinearizationSettings& settings, int anchor_clone,
                                     const InverseDepth& landmark,
                                     std::span<const CloneObservation> observations,
                                     LandmarkRowsRef H_f, MeasurementRowsRef rows);

}  // namespace duet
