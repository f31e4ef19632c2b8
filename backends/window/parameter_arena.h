#pragma once

#include <ceres/evaluation_callback.h>

#include <Eigen/Core>
#include <vector>

#include "backends/window/calibration_group.h"
#include "backends/window/window_state.h"

namespace duet {

/// The solver's parameters, all in one piece of memory in the order of frames, calibration,
/// landmarks (Ceres 2.1 orders parameter blocks by address; so its order is ours):
///
///   frame i: x y z w of R_GB | p_GB | v_GB | b_g b_a,   then the blocks of the calibration layout
///   (R_CB as x y z w) in groups that are one parameter each, then alpha beta rho of each landmark
///
/// Where pixels lie off their state's instant, they depend on a frame's velocity as well as on its
/// pose: both are one parameter then (theta, p, v), and two else.
///
/// As Ceres's evaluation callback it unpacks them into a WindowPoint once for every evaluation,
/// with the lift of each rotation: MinusJacobian (3 x 4) at its value, which turns a Jacobian over
/// the rotation's error into the one over its four numbers that Ceres asks for.
class ParameterArena final : public ceres::EvaluationCallback {
 public:
  using Lift = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

  ParameterArena(const CalibrationLayout& layout, bool off_instant)
      : layout_(&layout),
        pose_with_velocity_(off_instant),
        groups_(GroupCalibration(layout, off_instant ? 9 : 6)) {}

  /// Makes room; earlier pointers end.
  void Resize(int frame_count, int landmark_count);

  /// Writes the values in, and takes over what the point holds besides the parameters.
  void Pack(const std::vector<WindowFrame>& frames, const RigCalibration& rig);
  /// Reads the parameters into the point.
  void Unpack();
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

  /// True where a frame's pose and velocity are one parameter, at pose().
  [[nodiscard]] bool pose_with_velocity() const { return pose_with_velocity_; }
  [[nodiscard]] double* pose(int frame) { return &values_[kFrameDoubles * frame]; }
  [[nodiscard]] double* velocity(int frame) { return pose(frame) + 7; }
  [[nodiscard]] double* biases(int frame) { return pose(frame) + 10; }
  [[nodiscard]] double* calibration(int entry) { return &values_[calibration_[entry]]; }
  [[nodiscard]] const std::vector<CalibrationGroup>& groups() const { return groups_; }
  [[nodiscard]] double* group(int index) { return &values_[group_numbers_[index]]; }
  [[nodiscard]] double* landmark(int index) { return &values_[landmarks_ + 3 * index]; }

  [[nodiscard]] const WindowPoint& point() const { return point_; }
  [[nodiscard]] const Lift& frame_lift(int frame) const { return frame_lifts_[frame]; }
  [[nodiscard]] const Lift& calibration_lift(int entry) const { return calibration_lifts_[entry]; }

 private:
  static constexpr int kFrameDoubles = 16;

  const CalibrationLayout* layout_;
  bool pose_with_velocity_;
  std::vector<CalibrationGroup> groups_;
  int frame_count_ = 0;
  int landmarks_ = 0;
  std::vector<int> group_numbers_;  // where they start
  std::vector<int> calibration_;    // of each entry
  std::vector<double> values_;
  WindowPoint point_;
  std::vector<Lift> frame_lifts_;
  std::vector<Lift> calibration_lifts_;  // of R_CB blocks
};

}  // namespace duet
