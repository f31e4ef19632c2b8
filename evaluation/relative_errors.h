#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.h"
#include "common/support/timestamp.h"
#include "evaluation/association.h"
#include "evaluation/statistics.h"

namespace duet {

/// The way travelled along a truth, for choosing segments. Summed over samples at least `step_s`
/// apart: over 200 Hz samples with a millimetre of noise, standing still would add metres.
class TravelledDistance {
 public:
  TravelledDistance(const std::vector<StampedPose>& truth, double step_s);

  [[nodiscard]] double total_m() const { return nodes_.empty() ? 0.0 : nodes_.back().distance_m; }
  /// Way from the first sample to `t`, linear between samples, held constant outside them.
  [[nodiscard]] double At(Timestamp t) const;
  /// The first instant at which At() is `distance_m`; nothing before the first sample or past
  /// the total.
  [[nodiscard]] std::optional<Timestamp> WhenReached(double distance_m) const;

  struct Node {
    Timestamp timestamp;
    double distance_m;
  };
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  std::vector<Node> nodes_;
};

struct RelativeErrorOptions {
  /// Empty: of 0.5, 1, 2, 5, 10, ... m the up to four longest that are at most half of the way.
  std::vector<double> lengths_m;
  /// A segment starts at every sample of the truth that is this far from the one before.
  double start_step_s = 0.05;
  /// A segment's ends are moved to the nearest pose of the estimator, at most this far; the truth
  /// is interpolated there. (An estimate is never interpolated: a straight line over 50 ms misses
  /// a path under 5 m/s^2 by 1.6 mm.)
  double max_snap_s = 0.06;
};

/// Errors over segments of one length. Of a segment from s to e, with E = R_GB_true R_EB^T at
/// either end: translation |(p_e - p_s)_true - E_s (p_e - p_s)_est|, rotation the angle of
/// E_e E_s^T, and the parts of that which turn about and tip the vertical. These are the norms of
/// the two parts of (T_s^-1 T_e)_true^-1 (T_s^-1 T_e)_est: the estimate is taken to agree with the
/// truth in the whole pose at s, so that no alignment is needed or matters.
struct RelativeErrors {
  double length_m = 0.0;  ///< travelled by the truth
  int segments = 0;
  ErrorSummary translation_m;
  ErrorSummary translation_percent;  ///< of the way between the ends as they were moved
  ErrorSummary rotation_deg;
  ErrorSummary yaw_deg;
  ErrorSummary tilt_deg;
};

struct RelativeErrorReport {
  Timestamp start = 0;  ///< the spans' intersection; equal to `end` where there is none
  Timestamp end = 0;
  double way_m = 0.0;  ///< travelled by the truth in it
  /// Segments that were left out for all because one estimator has no pose near an end.
  int dropped = 0;
  /// One row an estimator, in the order given; one entry a length, the same for all.
  std::vector<std::vector<RelativeErrors>> of_estimator;
};

/// Segments are chosen on the truth, on the intersection of the spans of all estimators that have
/// any pair, and are the same for all of them.
[[nodiscard]] RelativeErrorReport ComputeRelativeErrors(
    const std::vector<StampedPose>& truth, std::span<const std::vector<PosePair>> estimators,
    const RelativeErrorOptions& options);

}  // namespace duet
