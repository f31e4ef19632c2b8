#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "common/geometry/se3.h"

namespace duet {

/// x_G = scale * R_GE x_E + p_GE. Orientations are turned by R_GE, whatever the scale.
struct Similarity {
  Eigen::Quaterniond R_GE = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_GE = Eigen::Vector3d::Zero();
  double scale = 1.0;

  [[nodiscard]] Pose operator*(const Pose& T_EB) const {
    return {(R_GE * T_EB.R).normalized(), scale * (R_GE * T_EB.p) + p_GE};
  }
};

/// The fits that evo, rpg_trajectory_evaluation and ov_eval share, without the refusals of Align():
/// what does not determine a rotation gives one nevertheless. `truth` and `estimate` are pairs, at
/// least one; of them the first `poses` are used (-1: all).

struct UmeyamaFit {
  Similarity similarity;
  /// Of the covariance of the positions [m^2], descending: evo refuses where fewer than two are
  /// above the double's epsilon.
  Eigen::Vector3d singular_values;
};
/// Umeyama's closed form (PAMI 1991, equations 34 to 43), all positions alike.
[[nodiscard]] UmeyamaFit FitUmeyama(const std::vector<Pose>& truth,
                                    const std::vector<Pose>& estimate, bool with_scale,
                                    int poses = -1);

/// The rotation about z and the translation that bring the positions nearest (Zhang and
/// Scaramuzza, "A tutorial on quantitative trajectory evaluation", IROS 2018, equations 17, 18).
[[nodiscard]] Similarity FitPositionYaw(const std::vector<Pose>& truth,
                                        const std::vector<Pose>& estimate, int poses = -1);

/// The rotation about z nearest to the difference of the first two orientations; first positions
/// agree.
[[nodiscard]] Similarity FitFirstPositionYaw(const std::vector<Pose>& truth,
                                             const std::vector<Pose>& estimate);

/// First poses agree.
[[nodiscard]] Similarity FitFirstPose(const std::vector<Pose>& truth,
                                      const std::vector<Pose>& estimate);

}  // namespace duet
