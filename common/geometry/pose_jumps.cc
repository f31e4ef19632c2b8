#include "common/geometry/pose_jumps.h"

#include <algorithm>
#include <cmath>

#include "common/support/logging.h"

namespace duet {
namespace {

// Departure of the change over one interval (from pose i to i + 1) from its prediction.
struct Departure {
  bool known = false;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  // A jump j in interval i adds j to departure i and -echo * j to departure i + 1, whose prediction
  // carries the previous interval's change on.
  double echo = 0.0;
  // What an offset of 1 in B (the IMU's bias) adds to `value`.
  double per_offset = 1.0;
};
using Departures = std::vector<Departure>;

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void RemoveConstantOffset(Departures* departures) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> offsets;
    for (const auto& entry : *departures) {
      if (entry.known) offsets.push_back(entry.value[axis] / entry.per_offset);
    }
    const double offset = Median(std::move(offsets));
    for (auto& entry : *departures) entry.value[axis] -= offset * entry.per_offset;
  }
}

double MedianLength(const Departures& departures) {
  std::vector<double> lengths;
  for (const auto& entry : departures) {
    if (entry.known) lengths.push_back(entry.value.norm());
  }
  return Median(std::move(lengths));
}

// The jump of interval i that explains most of its entry and the next one's echo, by least squares;
// *gain is the sum of squares that it explains.
Eigen::Vector3d BestJump(const Departures& departures, std::size_t i, double* gain) {
  Eigen::Vector3d product = Eigen::Vector3d::Zero();
  double square = 0.0;
  if (departures[i].known) {
    product += departures[i].value;
    square += 1.0;
  }
  if (i + 1 < departures.size() && departures[i + 1].known) {
    product -= departures[i + 1].echo * departures[i + 1].value;
    square += departures[i + 1].echo * departures[i + 1].echo;
  }
  *gain = square > 0.0 ? product.squaredNorm() / square : 0.0;
  return square > 0.0 ? Eigen::Vector3d(product / square) : product;
}

// Takes jumps out of the departures, the one that explains most first, until none is longer than
// `threshold`; then settles the sizes of those that were found. The sum of what was taken out of
// each interval.
std::vector<Eigen::Vector3d> TakeOutJumps(Departures departures, double threshold) {
  const std::size_t n = departures.size();
  std::vector<Eigen::Vector3d> total(n, Eigen::Vector3d::Zero());
  std::vector<double> gains(n);
  std::vector<bool> found(n, false);
  const auto take_out = [&](std::size_t i) {
    double gain = 0.0;
    const Eigen::Vector3d jump = BestJump(departures, i, &gain);
    total[i] += jump;
    departures[i].value -= jump;
    if (i + 1 < n) departures[i + 1].value += departures[i + 1].echo * jump;
  };
  const auto update_gain = [&](std::size_t i) {
    if (BestJump(departures, i, &gains[i]).norm() <= threshold) gains[i] = 0.0;
  };
  for (std::size_t i = 0; i < n; ++i) update_gain(i);
  // Each round takes at least threshold^2 / 2 from the sum of squares; the bound is for safety.
  for (std::size_t round = 0; round < 10 * n; ++round) {
    const auto best = std::max_element(gains.begin(), gains.end());
    if (*best <= 0.0) break;
    const auto i = static_cast<std::size_t>(best - gains.begin());
    found[i] = true;
    take_out(i);
    for (std::size_t k = i == 0 ? 0 : i - 1; k < std::min(n, i + 2); ++k) update_gain(k);
  }
  // Neighbouring jumps share a departure: Gauss-Seidel, which takes a quarter a sweep for two.
  constexpr int kSweeps = 30;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < n; ++i) {
      if (found[i]) take_out(i);
    }
  }
  return total;
}

std::vector<PoseJump> JumpsFrom(const std::vector<StampedPose>& poses, const Departures& positions,
                                const Departures& rotations, const PoseJumpOptions& options) {
  const double min_displacement =
      std::max(options.min_displacement_m, options.medians * MedianLength(positions));
  const double min_rotation =
      std::max(options.min_rotation_rad, options.medians * MedianLength(rotations));
  const std::vector<Eigen::Vector3d> displacement = TakeOutJumps(positions, min_displacement);
  const std::vector<Eigen::Vector3d> rotation = TakeOutJumps(rotations, min_rotation);
  std::vector<PoseJump> jumps;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const bool moved = displacement[i].norm() > min_displacement;
    const bool turned = rotation[i].norm() > min_rotation;
    if (!moved && !turned) continue;
    PoseJump jump;
    jump.index = i;
    jump.before = poses[i].timestamp;
    jump.after = poses[i + 1].timestamp;
    if (moved) jump.displacement = displacement[i];
    if (turned) jump.rotation = rotation[i];
    jumps.push_back(jump);
  }
  return jumps;
}

// From B of each interval's first pose to G.
void TurnToGlobal(const std::vector<StampedPose>& poses, Departures* departures) {
  for (std::size_t i = 0; i < departures->size(); ++i) {
    Departure& departure = (*departures)[i];
    departure.value = poses[i].T_GB.R * departure.value;
  }
}

// In B of pose i: the second interval's displacement against the one that follows from the first's
// and the motion in both.
Departure PositionDeparture(const StampedPose* pose, const RelativeMotion& first,
                            const RelativeMotion& second, const Eigen::Vector3d& g_G) {
  const double dt0 = SecondsBetween(pose[0].timestamp, pose[1].timestamp);
  const double dt1 = SecondsBetween(pose[1].timestamp, pose[2].timestamp);
  const Eigen::Quaterniond& R_0 = pose[0].T_GB.R;
  const Eigen::Quaterniond& R_1 = pose[1].T_GB.R;
  const Eigen::Vector3d v_0 =
      (pose[1].T_GB.p - pose[0].T_GB.p - R_0 * first.y) / dt0 - 0.5 * dt0 * g_G;
  const Eigen::Vector3d v_1 = v_0 + dt0 * g_G + R_0 * first.s;
  const Eigen::Vector3d predicted =
      pose[1].T_GB.p + dt1 * v_1 + 0.5 * dt1 * dt1 * g_G + R_1 * second.y;
  Departure departure;
  departure.known = true;
  departure.value = R_1.conjugate() * (pose[2].T_GB.p - predicted);
  departure.echo = dt1 / dt0;
  departure.per_offset = 0.5 * dt1 * (dt0 + dt1);
  return departure;
}

}  // namespace

std::vector<PoseJump> FindPoseJumps(const std::vector<StampedPose>& poses,
                                    const std::vector<std::optional<RelativeMotion>>& motion,
                                    const Eigen::Vector3d& g_G, const PoseJumpOptions& options) {
  if (poses.size() < 2) return {};
  CHECK_EQ(motion.size(), poses.size() - 1) << "one motion for each interval between poses";
  Departures positions(motion.size());
  Departures rotations(motion.size());
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (!motion[i]) continue;
    const Eigen::Quaterniond change = poses[i].T_GB.R.conjugate() * poses[i + 1].T_GB.R;
    rotations[i].known = true;
    rotations[i].value = BoxMinus(change, motion[i]->R);
    rotations[i].per_offset = SecondsBetween(poses[i].timestamp, poses[i + 1].timestamp);
    if (i > 0 && motion[i - 1]) {
      positions[i] = PositionDeparture(&poses[i - 1], *motion[i - 1], *motion[i], g_G);
    }
  }
  RemoveConstantOffset(&positions);
  RemoveConstantOffset(&rotations);
  TurnToGlobal(poses, &positions);
  TurnToGlobal(poses, &rotations);
  return JumpsFrom(poses, positions, rotations, options);
}

std::vector<PoseJump> FindPoseJumps(const std::vector<StampedPose>& poses,
                                    const PoseJumpOptions& options) {
  if (poses.size() < 2) return {};
  Departures positions(poses.size() - 1);
  Departures rotations(poses.size() - 1);
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    // Constant velocity: no specific force and no gravity.
    positions[i] = PositionDeparture(&poses[i - 1], {}, {}, Eigen::Vector3d::Zero());
    const double ratio = positions[i].echo;
    const Eigen::Vector3d last = BoxMinus(poses[i].T_GB.R, poses[i - 1].T_GB.R);
    const Eigen::Vector3d next = BoxMinus(poses[i + 1].T_GB.R, poses[i].T_GB.R);
    rotations[i].known = true;
    rotations[i].value = poses[i].T_GB.R.conjugate() * (next - ratio * last);
    rotations[i].echo = ratio;
  }
  TurnToGlobal(poses, &positions);
  TurnToGlobal(poses, &rotations);
  return JumpsFrom(poses, positions, rotations, options);
}

void RemovePoseJumps(const std::vector<PoseJump>& jumps, std::vector<StampedPose>* poses) {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  auto jump = jumps.begin();
  for (std::size_t i = 0; i < poses->size(); ++i) {
    for (; jump != jumps.end() && jump->index < i; ++jump) {
      displacement += jump->displacement;
      // The jump is in terms of the recorded pose before it, which `rotation` has turned.
      rotation = (rotation * ExpQuaternion(-jump->rotation)).normalized();
    }
    Pose& T_GB = (*poses)[i].T_GB;
    T_GB.p -= displacement;
    T_GB.R = (rotation * T_GB.R).normalized();
  }
}

}  // namespace duet
