#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se3.h"
#include "common/support/timestamp.h"

namespace duet {

/// What a trajectory is at one instant. Rates are those an ideal IMU measures:
/// omega_B [rad/s], a_G [m/s^2] is the acceleration of B's origin in G (gravity not in it).
struct Kinematics {
  Pose T_GB;
  Eigen::Vector3d v_GB = Eigen::Vector3d::Zero();
  Eigen::Vector3d a_G = Eigen::Vector3d::Zero();
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();
};

/// A smooth curve through poses: cumulative B-spline on SO(3) x R^3 of degree 5 (order 6), so
/// that angular velocity and acceleration are continuous and exact derivatives of the pose
/// (Sommer et al., "Efficient derivative computation for cumulative B-splines on Lie groups",
/// CVPR 2020).
class PoseSpline {
 public:
  /// Fits the control points to `poses` (strictly increasing stamps, at least 6 poses; signs of
  /// quaternions do not matter) by least squares with knots every `knot_spacing_s`.
  /// Throws InputError where the poses are too few, out of order or have a gap of more than four
  /// knots.
  static PoseSpline Fit(const std::vector<StampedPose>& poses, double knot_spacing_s);

  [[nodiscard]] Timestamp start() const { return start_; }
  [[nodiscard]] Timestamp end() const { return end_; }

  /// CHECKs that start() <= t <= end().
  [[nodiscard]] Kinematics At(Timestamp t) const;

 private:
  Timestamp start_ = 0;
  Timestamp end_ = 0;
  Timestamp knot_spacing_ = 0;
  std::vector<Eigen::Quaterniond> rotations_;
  std::vector<Eigen::Vector3d> positions_;
};

}  // namespace duet
