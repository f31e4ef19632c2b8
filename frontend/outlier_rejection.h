#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/support/random.h"

namespace duet {

/// A track in two frames of one camera: directions (x, y, 1).
struct RayPair {
  Eigen::Vector3d from;  ///< in C0
  Eigen::Vector3d to;    ///< in C1
};

struct EpipolarOptions {
  int iterations = 48;
  double focal_px = 1.0;  ///< makes pixels of distances in the plane z = 1
  double threshold_px = 1.0;
};

/// The motion between two frames as the tracks say: x_C1 ~ Exp(delta) R_C1C0 x_C0 + t.
struct EpipolarMotion {
  bool valid = false;                               ///< enough tracks agree
  Eigen::Vector3d delta = Eigen::Vector3d::Zero();  ///< rad, correction of the told rotation
  Eigen::Vector3d t = Eigen::Vector3d::UnitZ();  ///< direction of the translation (or its opposite)
  int inliers = 0;
};

/// Finds the tracks that fit one rigid motion. The rotation is told (by the gyroscope) up to a
/// small error, so two tracks give a hypothesis of the translation's direction: R f_0, f_1 and t
/// lie in a plane, t ~ (R f_0 x f_1)_a x (R f_0 x f_1)_b. The best of a fixed number (truncated
/// squares at three times the threshold) is refined together with the rotation, five numbers, by
/// robust Gauss-Newton; then `inlier` says which tracks lie within the threshold of their epipolar
/// line (Sampson's distance). At rest every direction fits, and so does every track that stays in
/// place. Without agreement (fewer than eight tracks or fewer than half) nothing is refused: valid
/// is false, every track an inlier.
EpipolarMotion FindEpipolarMotion(std::span<const RayPair> pairs, const Eigen::Matrix3d& R_C1C0,
                                  const EpipolarOptions& options, Random* random,
                                  std::vector<bool>* inlier);

}  // namespace duet
