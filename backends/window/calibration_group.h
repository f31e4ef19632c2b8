#pragma once

#include <ceres/manifold.h>

#include <vector>

#include "common/measurement/calibration.h"

namespace duet {

/// Neighbouring blocks of a calibration that the solver takes as one parameter: few large blocks
/// make its Schur complement quicker than many small ones. There are at most two groups: the T
/// matrices, on which IMU factors depend, and the cameras with the times, on which pixels do.
struct CalibrationGroup {
  int first_entry = 0;  ///< of CalibrationLayout::entries()
  int entry_count = 0;
  int offset = 0;        ///< first component of the calibration's error
  int size = 0;          ///< components of the error
  int ambient_size = 0;  ///< numbers: a rotation has four
  bool has_rotation = false;
};

/// The groups of a layout that are not empty, in its order.
[[nodiscard]] std::vector<CalibrationGroup> GroupCalibration(const CalibrationLayout& layout);

/// A group's manifold: rotations as RotationManifold, all else flat.
class CalibrationManifold final : public ceres::Manifold {
 public:
  CalibrationManifold(const CalibrationLayout& layout, const CalibrationGroup& group)
      : layout_(layout), group_(group) {}
  int AmbientSize() const override { return group_.ambient_size; }
  int TangentSize() const override { return group_.size; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  CalibrationLayout layout_;
  CalibrationGroup group_;
};

}  // namespace duet
