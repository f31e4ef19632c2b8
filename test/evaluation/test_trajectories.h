#pragma once

#include <cmath>
#include <vector>

#include "common/geometry/se3.h"
#include "common/geometry/so3.h"
#include "common/support/random.h"
#include "common/support/timestamp.h"
#include "evaluation/alignment.h"
#include "evaluation/association.h"

namespace duet {

inline constexpr Timestamp kMs = 1'000'000;
inline constexpr Timestamp kSecond = 1'000 * kMs;
/// Today's kind of stamp: as a double in seconds it would lose its last 200 ns.
inline constexpr Timestamp kEpoch = 1'403'636'583'763'555'584;

/// A smooth walk in three dimensions that turns about every axis.
inline Pose WalkPose(double t_s) {
  Pose T_GB;
  T_GB.p = {2.0 * std::sin(0.5 * t_s), 1.5 * std::cos(0.7 * t_s), 0.6 * std::sin(1.1 * t_s)};
  T_GB.R = ExpQuaternion({0.3 * std::sin(t_s), 0.2 * std::cos(0.8 * t_s), 0.9 * t_s});
  return T_GB;
}

inline std::vector<StampedPose> Walk(double duration_s, double rate_hz, Timestamp start = kEpoch) {
  std::vector<StampedPose> poses;
  const int count = static_cast<int>(std::lround(duration_s * rate_hz)) + 1;
  for (int i = 0; i < count; ++i) {
    const double t_s = i / rate_hz;
    poses.push_back({start + ToNanoseconds(t_s), WalkPose(t_s)});
  }
  return poses;
}

inline Eigen::Quaterniond RandomRotation(Random* random) {
  Eigen::Quaterniond q(random->Normal(), random->Normal(), random->Normal(), random->Normal());
  return q.normalized();
}

/// Independent noise on each pose: positions [m], global rotations [rad], 1 sigma per axis.
inline std::vector<StampedPose> WithNoise(std::vector<StampedPose> poses, double sigma_m,
                                          double sigma_rad, Random* random) {
  for (StampedPose& pose : poses) {
    pose.T_GB.p += sigma_m * random->NormalVector<3>();
    pose.T_GB.R = BoxPlus(pose.T_GB.R, sigma_rad * random->NormalVector<3>());
  }
  return poses;
}

/// x' = scale * R x + p of every pose.
inline std::vector<StampedPose> Moved(std::vector<StampedPose> poses, const Eigen::Quaterniond& R,
                                      const Eigen::Vector3d& p, double scale = 1.0) {
  for (StampedPose& pose : poses) {
    pose.T_GB.p = scale * (R * pose.T_GB.p) + p;
    pose.T_GB.R = (R * pose.T_GB.R).normalized();
  }
  return poses;
}

/// Pairs of two trajectories with the same stamps.
inline std::vector<PosePair> PairUp(const std::vector<StampedPose>& truth,
                                    const std::vector<StampedPose>& estimate) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    pairs.push_back({estimate[i].timestamp, truth[i].T_GB, estimate[i].T_GB});
  }
  return pairs;
}

}  // namespace duet
