#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/se3.h"
#include "common/support/timestamp.h"

namespace duet {

/// What an IMU says of the motion over an interval, in the body frame of its start and free of
/// gravity (an ImuDelta's R, s, y): R_1 = R_0 R, v_1 = v_0 + g dt + R_0 s,
/// p_1 = p_0 + v_0 dt + g dt^2 / 2 + R_0 y.
struct RelativeMotion {
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d s = Eigen::Vector3d::Zero();  ///< m/s
  Eigen::Vector3d y = Eigen::Vector3d::Zero();  ///< m
};

/// A step in a trajectory that is no motion: pose `index` + 1 and all after it are off by it,
/// against what pose `index` and the motion predict. In G; the true pose's terms:
/// p = p_predicted + displacement, R = Exp(rotation) R_predicted.
struct PoseJump {
  std::size_t index = 0;
  Timestamp before = 0;                                    ///< stamp of pose `index`
  Timestamp after = 0;                                     ///< stamp of pose `index` + 1
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();      ///< rad
};

struct PoseJumpOptions {
  /// No smaller steps are jumps [m, rad]. Between jumps, EuRoC's truth (200 Hz) departs from its
  /// own IMU by at most 0.5 mm and 0.05 deg an interval.
  double min_displacement_m = 1e-3;
  double min_rotation_rad = 2e-3;
  /// A jump is larger than this many medians of the departures' lengths. Their tails are long (the
  /// 99.9th percentile is up to 20 medians); a jump of a coarse trajectory stands out by as much.
  double medians = 20.0;
};

/// The jumps of a trajectory (strictly increasing stamps), in order of time.
///
/// A pose is predicted from its two predecessors, the velocity being theirs, with the motion that
/// the IMU measured between (`motion[i]` from pose i to i + 1; nothing where it is not known, and
/// nothing is judged there). A constant offset in B (the IMU's biases) is taken out as the median
/// over the trajectory. A jump departs once forwards and, through the velocity, once back; of all
/// intervals the one whose jump explains most is taken out first, until none exceeds the bounds. A
/// single bad pose comes out as a jump there and one back.
///
/// g_G: gravity in G [m/s^2].
[[nodiscard]] std::vector<PoseJump> FindPoseJumps(
    const std::vector<StampedPose>& poses, const std::vector<std::optional<RelativeMotion>>& motion,
    const Eigen::Vector3d& g_G, const PoseJumpOptions& options = {});

/// The same without an IMU: constant velocity and rate stand in for the motion. At 200 Hz that is
/// as good in EuRoC's flights (1 m/s^2 is 0.025 mm); at 20 Hz only large jumps stand out.
[[nodiscard]] std::vector<PoseJump> FindPoseJumps(const std::vector<StampedPose>& poses,
                                                  const PoseJumpOptions& options = {});

/// Takes the jumps out: every pose is moved and turned back by the sum of the jumps before it, so
/// that the trajectory is continuous (and drifts from the original by that sum). For simulation
/// along recorded truth.
void RemovePoseJumps(const std::vector<PoseJump>& jumps, std::vector<StampedPose>* poses);

}  // namespace duet
