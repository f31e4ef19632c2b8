#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se3.h"
#include "common/support/timestamp.h"

namespace duet {

class ControlPointFit;

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
///
/// Between knots i and i + 1, with u in [0, 1] between them and the cumulative basis
/// lambda_0 = 1, lambda_1(u) ... lambda_5(u):
///
///   p(u) = p_i + sum_j lambda_j(u) (p_{i+j} - p_{i+j-1})
///   R(u) = R_i prod_j Exp(lambda_j(u) d_{i+j}),   d_c = Log(R_{c-1}' R_c)
///
/// How well it follows a smooth motion, with knots every h: positions to h^6, velocity to h^5,
/// acceleration to h^4. Rotations do not commute, so that the product's smoothness buys less: to
/// about 1e-4 |omega x omega'| h^3 in rotation and h^2 in the rate (at 3 rad/s and h = 0.1 s,
/// 6e-7 rad and 4e-5 rad/s).
class PoseSpline {
 public:
  /// Default of Fit's `smoothing`.
  static constexpr double kSmoothing = 1e-6;

  /// Fits the control points to `poses` (strictly increasing stamps, at least 6 poses; signs of
  /// quaternions do not matter) with knots every `knot_spacing_s`: least squares of the poses'
  /// residuals plus `smoothing` times those of the control points' third differences, per knot.
  /// The second term decides only where the poses do not (fewer poses than knots, gaps, ends): at
  /// the default, motion of 0.1 of the knots' rate is followed to 1e-7 of its amplitude.
  /// Throws InputError where the poses are too few, out of order or have a gap of more than four
  /// knots. CHECKs that spacing and smoothing are positive.
  [[nodiscard]] static PoseSpline Fit(const std::vector<StampedPose>& poses, double knot_spacing_s,
                                      double smoothing = kSmoothing);

  [[nodiscard]] Timestamp start() const { return start_; }
  [[nodiscard]] Timestamp end() const { return end_; }

  /// CHECKs that start() <= t <= end().
  [[nodiscard]] Kinematics At(Timestamp t) const;

  /// What the pose differs by from the curve: (theta, p) with R = Exp(theta) R_spline, theta in G
  /// [rad], p = p_spline + p [m].
  [[nodiscard]] Vector6d Residual(const StampedPose& pose) const;

 private:
  struct Place {
    std::size_t control;  ///< the first of six control points
    double u;
  };
  [[nodiscard]] Place PlaceOf(Timestamp t) const;
  void UpdateIncrements();
  void FitPositions(const std::vector<StampedPose>& poses, const ControlPointFit& fit);
  void FitRotations(const std::vector<StampedPose>& poses, const ControlPointFit& fit);

  Timestamp start_ = 0;
  Timestamp end_ = 0;
  Timestamp knot_spacing_ = 0;
  std::vector<Eigen::Quaterniond> rotations_;
  std::vector<Eigen::Vector3d> increments_;  ///< d_c; the first is not used
  std::vector<Eigen::Vector3d> positions_;
};

}  // namespace duet
