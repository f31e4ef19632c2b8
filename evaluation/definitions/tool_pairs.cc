#include "evaluation/definitions/tool_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angle.h"
#include "common/geometry/so3.h"
#include "evaluation/definitions/nearest_index.h"
#include "evaluation/statistics.h"

namespace duet {

void ToolPairs::Move(const Similarity& alignment) {
  aligned.clear();
  for (const Pose& pose : estimate) aligned.push_back(alignment * pose);
}

ToolPairs TakeMatches(const std::vector<StampedPose>& truth,
                      const std::vector<StampedPose>& estimate, std::vector<StampMatch> matches,
                      ToolErrors* errors) {
  ToolPairs pairs;
  const StampMatch* last = nullptr;
  for (const StampMatch& match : matches) {
    const StampedPose& of_truth = truth[match.truth];
    const StampedPose& of_estimate = estimate[match.estimate];
    pairs.truth.push_back(of_truth.T_GB);
    pairs.estimate.push_back(of_estimate.T_GB);
    errors->largest_stamp_difference_s =
        std::max(errors->largest_stamp_difference_s,
                 std::abs(SecondsBetween(of_truth.timestamp, of_estimate.timestamp)));
    // Matches ascend in both: one that is used again is the last one's.
    const bool again =
        last != nullptr && (last->truth == match.truth || last->estimate == match.estimate);
    errors->poses_matched_again += again ? 1 : 0;
    last = &match;
  }
  errors->matches = std::move(matches);
  return pairs;
}

ToolSummary SummarizeForTool(std::vector<double> values, int ddof) {
  ToolSummary summary;
  summary.count = static_cast<int>(values.size());
  // One that is no number (rpg's scale, of two poses at the origin) makes all numbers none.
  const bool any_nan = std::any_of(values.begin(), values.end(), [](double v) { return v != v; });
  if (values.empty() || any_nan) return summary;
  const ErrorSummary common = Summarize(values);
  summary.rmse = common.rmse;
  summary.mean = common.mean;
  summary.median = common.median;
  summary.min = common.min;
  summary.max = common.max;
  if (common.count <= ddof) return summary;
  double squares = 0.0;
  for (const double value : values) squares += (value - common.mean) * (value - common.mean);
  summary.std = std::sqrt(squares / (common.count - ddof));
  return summary;
}

std::vector<double> WayAlong(const std::vector<Pose>& poses) {
  std::vector<double> way_m;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    way_m.push_back(i == 0 ? 0.0 : way_m.back() + (poses[i].p - poses[i - 1].p).norm());
  }
  return way_m;
}

int SegmentEnd(const std::vector<double>& way_m, int start, double length_m, double reach_m) {
  const double target = way_m[start] + length_m;
  const auto off = [&](double way) { return std::abs(way - target); };
  const int end = NearestIndex(way_m, start, target, off);
  return end >= 0 && off(way_m[end]) < reach_m ? end : -1;
}

Pose RelativePoseError(const ToolPairs& pairs, const std::vector<Pose>& estimate, int i, int j,
                       double scale) {
  Pose moved = estimate[i].Inverse() * estimate[j];
  moved.p *= scale;
  return (pairs.truth[i].Inverse() * pairs.truth[j]).Inverse() * moved;
}

double AngleDeg(const Eigen::Quaterniond& R) { return Log(R).norm() * kDegreesPerRadian; }

void SummarizeAbsoluteErrors(const ToolPairs& pairs, int ddof, ToolErrors* errors) {
  std::vector<double> position_m, orientation_deg;
  for (std::size_t i = 0; i < pairs.truth.size(); ++i) {
    position_m.push_back((pairs.truth[i].p - pairs.aligned[i].p).norm());
    orientation_deg.push_back(AngleDeg(pairs.aligned[i].R * pairs.truth[i].R.conjugate()));
  }
  errors->position_m = SummarizeForTool(std::move(position_m), ddof);
  errors->orientation_deg = SummarizeForTool(std::move(orientation_deg), ddof);
}

}  // namespace duet
