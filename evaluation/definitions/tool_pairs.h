#pragma once

#include <vector>

#include "evaluation/definitions/tool_errors.h"

namespace duet {

/// What the three programs' definitions are made of.

/// The matched poses, one entry a match.
struct ToolPairs {
  std::vector<Pose> truth;
  std::vector<Pose> estimate;
  std::vector<Pose> aligned;  ///< the estimate, moved by the alignment

  /// Fills `aligned`.
  void Move(const Similarity& alignment);
};

/// Takes the matches into `errors` and counts what is told of them.
[[nodiscard]] ToolPairs TakeMatches(const std::vector<StampedPose>& truth,
                                    const std::vector<StampedPose>& estimate,
                                    std::vector<StampMatch> matches, ToolErrors* errors);

/// Standard deviation over n - `ddof`.
[[nodiscard]] ToolSummary SummarizeForTool(std::vector<double> values, int ddof);

/// The way [m] from the first of `poses` to each, in straight lines.
[[nodiscard]] std::vector<double> WayAlong(const std::vector<Pose>& poses);

/// A segment's end: the pose from `start` on whose way is nearest to `length_m` from it, the first
/// of equals, if less than `reach_m` off; -1 otherwise. rpg's and ov_eval's
/// compute_comparison_indices_length.
[[nodiscard]] int SegmentEnd(const std::vector<double>& way_m, int start, double length_m,
                             double reach_m);

/// (T_i^-1 T_j)_true^-1 (T_i^-1 T_j)_est, the estimate's translation times `scale`.
[[nodiscard]] Pose RelativePoseError(const ToolPairs& pairs, const std::vector<Pose>& estimate,
                                     int i, int j, double scale);

/// The three programs take arc cosines, which agree with this to 1e-6 deg near zero and better
/// elsewhere.
[[nodiscard]] double AngleDeg(const Eigen::Quaterniond& R);

/// Position and orientation errors of the aligned poses, as all three define them.
void SummarizeAbsoluteErrors(const ToolPairs& pairs, int ddof, ToolErrors* errors);

}  // namespace duet
