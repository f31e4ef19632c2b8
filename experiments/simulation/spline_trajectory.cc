#include "experiments/simulation/spline_trajectory.h"

#include <algorithm>

#include "common/dataset/ground_truth.h"
#include "common/geometry/pose_jumps.h"
#include "common/geometry/so3.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

constexpr std::size_t kFewestPoses = 6;
constexpr double kDefaultSpacing_s = 0.03;
// What the IMUs of the field read at most.
constexpr double kLargestAcceleration = 16.0 * 9.81;                      // m/s^2
constexpr double kLargestRate = 2000.0 * 3.14159265358979323846 / 180.0;  // rad/s

[[noreturn]] void FailAt(const std::string& file, Timestamp stamp, Timestamp origin,
                         const std::string& text) {
  throw InputError(file, 0, "",
                   "at " + FormatFixed(SecondsBetween(origin, stamp), 3) + " s (stamp " +
                       std::to_string(stamp) + ") " + text);
}

void CheckStamps(const std::vector<StampedPose>& poses, const std::string& file) {
  if (poses.size() < kFewestPoses) {
    throw InputError(file, 0, "",
                     std::to_string(poses.size()) + " poses; a trajectory needs at least " +
                         std::to_string(kFewestPoses));
  }
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].timestamp > poses[i - 1].timestamp) continue;
    FailAt(file, poses[i].timestamp, poses.front().timestamp,
           "a stamp does not come after the one before; expected strictly increasing stamps");
  }
}

void CheckGaps(const std::vector<StampedPose>& poses, const std::string& file, double spacing_s) {
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double gap_s = SecondsBetween(poses[i - 1].timestamp, poses[i].timestamp);
    if (gap_s <= 4.0 * spacing_s) continue;
    FailAt(file, poses[i - 1].timestamp, poses.front().timestamp,
           "poses are missing for " + FormatFixed(gap_s, 3) + " s; knots " +
               FormatFixed(spacing_s, 3) + " s apart bridge four of them at most");
  }
}

// The acceleration that takes the mean velocity of one interval to the next one's, and the rates.
void CheckMotion(const std::vector<StampedPose>& poses, const std::string& file) {
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double dt_s = SecondsBetween(poses[i - 1].timestamp, poses[i].timestamp);
    const double rate = BoxMinus(poses[i].T_GB.R, poses[i - 1].T_GB.R).norm() / dt_s;
    if (rate > kLargestRate) {
      FailAt(file, poses[i].timestamp, poses.front().timestamp,
             "the orientation jumps: " + FormatFixed(rate, 0) +
                 " rad/s between two poses, which no IMU reads; expected poses without jumps");
    }
    if (i + 1 == poses.size()) break;
    const double next_s = SecondsBetween(poses[i].timestamp, poses[i + 1].timestamp);
    const Eigen::Vector3d v = (poses[i].T_GB.p - poses[i - 1].T_GB.p) / dt_s;
    const Eigen::Vector3d next = (poses[i + 1].T_GB.p - poses[i].T_GB.p) / next_s;
    const double acceleration = (next - v).norm() / (0.5 * (dt_s + next_s));
    if (acceleration > kLargestAcceleration) {
      FailAt(file, poses[i].timestamp, poses.front().timestamp,
             "the position jumps: " + FormatFixed(acceleration, 0) +
                 " m/s^2 between neighbouring poses, which no IMU reads; expected poses without "
                 "jumps");
    }
  }
}

double MedianInterval(const std::vector<StampedPose>& poses) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    intervals.push_back(SecondsBetween(poses[i - 1].timestamp, poses[i].timestamp));
  }
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

}  // namespace

double SplineTrajectory::duration_s() const {
  return SecondsBetween(spline_.start(), spline_.end());
}

Kinematics SplineTrajectory::At(double t_s) const {
  return spline_.At(spline_.start() + ToNanoseconds(t_s));
}

std::shared_ptr<const SplineTrajectory> SplineThrough(std::vector<StampedPose> poses,
                                                      const std::string& file,
                                                      const SplineOptions& options) {
  CheckStamps(poses, file);
  const double spacing_s = options.knot_spacing_s > 0.0
                               ? options.knot_spacing_s
                               : std::max(kDefaultSpacing_s, MedianInterval(poses));
  CheckGaps(poses, file, spacing_s);
  if (options.bridge_jumps) RemovePoseJumps(FindPoseJumps(poses), &poses);
  CheckMotion(poses, file);
  return std::make_shared<SplineTrajectory>(PoseSpline::Fit(poses, spacing_s));
}

std::shared_ptr<const SplineTrajectory> SplineThroughFile(const std::string& file,
                                                          const SplineOptions& options) {
  return SplineThrough(ReadTrajectoryFile(file).poses, file, options);
}

}  // namespace duet
