#pragma once

#include <ceres/manifold.h>

#include <vector>

#include "common/measurement/calibration.h"

namespace duet {

/// Neighbouring components of a calibration that the solver takes as one parameter: few large
/// blocks make its Schur complement quicker than many small ones. The T matrices, on which IMU
/// factors depend, are one; the cameras and the times, on which pixels do, are blocks of as many
/// components as a frame's block has: where all that a landmark's pixels depend on is of one size,
/// Ceres eliminates landmarks by code compiled for that size. What the last component leaves free
/// of a block is filled with numbers that nothing depends on: they have columns of zeros, and stay.
struct CalibrationGroup {
  /// Consecutive components of one entry of the layout; or filling.
  struct Part {
    int entry = kFilling;  ///< of CalibrationLayout::entries()
    int first = 0;         ///< component of the entry
    int size = 0;          ///< components
    int component = 0;     ///< the first one's place in the group's error
    int number = 0;        ///< the same in its numbers: a rotation has four, and is never split
    bool is_rotation = false;
  };
  static constexpr int kFilling = -1;

  std::vector<Part> parts = {};
  bool of_imu = false;
  int offset = 0;        ///< first component in the calibration's error
  int size = 0;          ///< components of the calibration
  int tangent_size = 0;  ///< with filling
  int ambient_size = 0;  ///< numbers
  bool has_rotation = false;
};

/// The groups of a layout that are not empty, in its order. `pixel_width`: components of the blocks
/// that pixels depend on, at least a rotation's three.
[[nodiscard]] std::vector<CalibrationGroup> GroupCalibration(const CalibrationLayout& layout,
                                                             int pixel_width);

/// A group's manifold: rotations as RotationManifold, all else flat.
class CalibrationManifold final : public ceres::Manifold {
 public:
  explicit CalibrationManifold(const CalibrationGroup& group) : group_(group) {}
  int AmbientSize() const override { return group_.ambient_size; }
  int TangentSize() const override { return group_.tangent_size; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  CalibrationGroup group_;
};

}  // namespace duet
