#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/angle.h"
#include "evaluation/definitions/tool_errors.h"
#include "evaluation/definitions/tool_pairs.h"

namespace duet {
namespace {

constexpr double kRpgLengthTolerance = 0.2;

/// Yaw and the rest of the Euler angles z y x.
struct RpgEulerErrors {
  double yaw_deg;
  double gravity_deg;
};
RpgEulerErrors EulerErrorsLikeRpg(const Eigen::Matrix3d& R) {
  const double flat = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), flat);
  // At a pitch of a quarter turn the program calls the whole rest roll.
  const bool upright = flat > 4.0 * std::numeric_limits<double>::epsilon();
  const double yaw = upright ? std::atan2(R(1, 0), R(0, 0)) : 0.0;
  const double roll = upright ? std::atan2(R(2, 1), R(2, 2)) : std::atan2(-R(1, 2), R(1, 1));
  return {std::abs(yaw) * kDegreesPerRadian, std::hypot(pitch, roll) * kDegreesPerRadian};
}

Similarity AlignLikeRpg(const ToolPairs& pairs, const ToolDefinition& definition) {
  const bool single = definition.poses == 1;
  switch (definition.alignment) {
    case ToolAlignment::kPositionYaw:
      return single ? FitFirstPositionYaw(pairs.truth, pairs.estimate)
                    : FitPositionYaw(pairs.truth, pairs.estimate, definition.poses);
    case ToolAlignment::kSe3:
      return single ? FitFirstPose(pairs.truth, pairs.estimate)
                    : FitUmeyama(pairs.truth, pairs.estimate, false, definition.poses).similarity;
    case ToolAlignment::kSim3:
      return FitUmeyama(pairs.truth, pairs.estimate, true, definition.poses).similarity;
    default:
      return {};
  }
}

ToolRelativeErrors RpgRelativeErrors(const ToolPairs& pairs, const std::vector<double>& way_m,
                                     double scale, double length_m) {
  std::vector<int> ends;
  for (int i = 0; i < static_cast<int>(way_m.size()); ++i) {
    const int end = SegmentEnd(way_m, i, length_m, kRpgLengthTolerance * length_m);
    if (end >= 0) ends.push_back(end);
  }
  if (ends.size() < 2) ends.clear();
  std::vector<double> translation_m, rotation_deg, percent, deg_per_m, yaw_deg, gravity_deg;
  // As the program: the place in the list of ends is taken for the start.
  for (int start = 0; start < static_cast<int>(ends.size()); ++start) {
    const int end = ends[start];
    const Pose E = RelativePoseError(pairs, pairs.estimate, start, end, scale);
    const Eigen::Quaterniond& R_EB = pairs.estimate[end].R;
    const RpgEulerErrors euler =
        EulerErrorsLikeRpg((R_EB * E.R * R_EB.conjugate()).normalized().toRotationMatrix());
    translation_m.push_back(E.p.norm());
    rotation_deg.push_back(AngleDeg(E.R));
    percent.push_back(100.0 * translation_m.back() / length_m);
    deg_per_m.push_back(rotation_deg.back() / length_m);
    yaw_deg.push_back(euler.yaw_deg);
    gravity_deg.push_back(euler.gravity_deg);
  }
  ToolRelativeErrors errors;
  errors.delta = length_m;
  errors.segments = static_cast<int>(ends.size());
  errors.translation_m = SummarizeForTool(std::move(translation_m), 0);
  errors.rotation_deg = SummarizeForTool(std::move(rotation_deg), 0);
  errors.further = {{"translation_percent", SummarizeForTool(std::move(percent), 0)},
                    {"rotation_deg_per_m", SummarizeForTool(std::move(deg_per_m), 0)},
                    {"yaw_deg", SummarizeForTool(std::move(yaw_deg), 0)},
                    {"gravity_deg", SummarizeForTool(std::move(gravity_deg), 0)}};
  return errors;
}

}  // namespace

ToolErrors EvaluateLikeRpg(const std::vector<StampedPose>& truth,
                           const std::vector<StampedPose>& estimate,
                           const ToolDefinition& definition, std::span<const double> lengths_m) {
  ToolErrors errors;
  errors.definition = definition;
  ToolPairs pairs = TakeMatches(truth, estimate, MatchLikeRpg(truth, estimate), &errors);
  if (pairs.truth.empty()) {
    errors.refused = "rpg stops: no stamps within 0.02 s";
    return errors;
  }
  if (definition.poses > static_cast<int>(pairs.truth.size())) {
    errors.refused = "rpg stops: fewer pairs than the alignment is to use";
    return errors;
  }
  errors.alignment = AlignLikeRpg(pairs, definition);
  pairs.Move(errors.alignment);
  SummarizeAbsoluteErrors(pairs, 0, &errors);
  std::vector<double> scale_percent;
  for (std::size_t i = 0; i < pairs.truth.size(); ++i) {
    const double ratio = pairs.aligned[i].p.norm() / pairs.truth[i].p.norm();
    scale_percent.push_back(100.0 * std::abs(ratio - 1.0));
  }
  errors.further = {{"scale_percent", SummarizeForTool(std::move(scale_percent), 0)}};

  std::vector<Pose> whole_truth;
  for (const StampedPose& pose : truth) whole_truth.push_back(pose.T_GB);
  const double whole_way_m = WayAlong(whole_truth).back();
  const std::vector<double> way_m = WayAlong(pairs.truth);
  for (const double share : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    const double length_m = std::trunc(share * whole_way_m * 100.0) / 100.0;
    if (!(length_m > 0.0)) continue;
    errors.relative.push_back(RpgRelativeErrors(pairs, way_m, errors.alignment.scale, length_m));
    errors.relative.back().own_default = true;
  }
  for (const double length_m : lengths_m) {
    errors.relative.push_back(RpgRelativeErrors(pairs, way_m, errors.alignment.scale, length_m));
  }
  return errors;
}

}  // namespace duet
