#include "common/geometry/interpolation.h"

#include <algorithm>

namespace duet {

std::optional<Pose> InterpolatePose(const std::vector<StampedPose>& poses, Timestamp t,
                                    double max_gap_s) {
  const auto after = std::lower_bound(
      poses.begin(), poses.end(), t,
      [](const StampedPose& pose, Timestamp time) { return pose.timestamp < time; });
  if (after == poses.end()) return std::nullopt;
  if (after->timestamp == t) return after->T_GB;
  if (after == poses.begin()) return std::nullopt;
  const auto before = after - 1;
  const double gap_s = SecondsBetween(before->timestamp, after->timestamp);
  if (gap_s > max_gap_s) return std::nullopt;
  const double fraction = SecondsBetween(before->timestamp, t) / gap_s;
  // The shortest way between the two, whatever the signs of their quaternions.
  const Eigen::Vector3d theta = BoxMinus(after->T_GB.R, before->T_GB.R);
  return Pose{BoxPlus(before->T_GB.R, fraction * theta),
              before->T_GB.p + fraction * (after->T_GB.p - before->T_GB.p)};
}

void MakeQuaternionSignsContinuous(std::vector<StampedPose>* poses) {
  for (std::size_t i = 1; i < poses->size(); ++i) {
    Eigen::Quaterniond& q = (*poses)[i].T_GB.R;
    if (q.dot((*poses)[i - 1].T_GB.R) < 0.0) q.coeffs() *= -1.0;
  }
}

}  // namespace duet
