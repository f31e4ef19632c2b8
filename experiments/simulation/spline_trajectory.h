#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/pose_spline.h"
#include "common/geometry/se3.h"
#include "experiments/simulation/trajectory.h"

namespace duet {

/// A spline through recorded poses, from the first to the last.
class SplineTrajectory final : public Trajectory {
 public:
  explicit SplineTrajectory(PoseSpline spline) : spline_(std::move(spline)) {}

  [[nodiscard]] double duration_s() const override;
  /// `t_s` is rounded to nanoseconds.
  [[nodiscard]] Kinematics At(double t_s) const override;

  [[nodiscard]] const PoseSpline& spline() const { return spline_; }

 private:
  PoseSpline spline_;
};

struct SplineOptions {
  /// 0: 30 ms, or the median time between poses where that is longer. Of 20 to 100 ms it is the one
  /// that gives EuRoC's truth (200 Hz, a tenth of a millimetre) accelerations nearest to its own
  /// IMU's.
  double knot_spacing_s = 0.0;
  /// Takes jumps of the poses out (FindPoseJumps, RemovePoseJumps) instead of refusing them.
  bool bridge_jumps = false;
};

/// A smooth trajectory through the poses of a truth file, moved to no other frame. Throws an
/// InputError that names `file` and the time where there are fewer than 6 poses, a stamp does not
/// come after the one before, a gap is longer than four knots, or neighbouring poses need an
/// acceleration of more than 16 g or a rate of more than 2000 deg/s: jumps that no motion has and
/// no IMU follows.
[[nodiscard]] std::shared_ptr<const SplineTrajectory> SplineThrough(
    std::vector<StampedPose> poses, const std::string& file, const SplineOptions& options = {});

/// The same through a file in EuRoC's or TUM's form (common/dataset/ground_truth.h).
[[nodiscard]] std::shared_ptr<const SplineTrajectory> SplineThroughFile(
    const std::string& file, const SplineOptions& options = {});

}  // namespace duet
