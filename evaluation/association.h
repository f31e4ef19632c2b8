#pragma once

#include <string>
#include <vector>

#include "common/geometry/se3.h"
#include "common/support/timestamp.h"

namespace duet {

/// One instant at which truth and estimate are both known.
struct PosePair {
  Timestamp timestamp = 0;  ///< the estimate's stamp
  Pose T_GB_true;
  Pose T_EB;  ///< the estimate, in its own global frame E
};

/// How the truth at an estimate's stamp is found. Only kInterpolated is a measurement; the nearest
/// neighbours leave up to half a sample of motion in the error and are there to reproduce the
/// numbers of other programs, faults included.
enum class AssociationMode {
  kInterpolated,
  kEvoNearest,     ///< MatchLikeEvo (definitions/stamp_matching.h)
  kRpgNearest,     ///< MatchLikeRpg
  kOvEvalNearest,  ///< MatchLikeOvEval
};
[[nodiscard]] const char* AssociationModeName(AssociationMode mode);

struct AssociationOptions {
  AssociationMode mode = AssociationMode::kInterpolated;
  /// Truth is not interpolated over more than this. 60 ms passes a truth at 20 Hz and refuses one
  /// that lost a sample.
  double max_truth_gap_s = 0.06;
  /// A longer step between estimated poses is a gap, not covered; 0: 2.5 times the estimate's own
  /// median step.
  double max_estimate_gap_s = 0.0;
  /// Where the truth is known to jump: the stamps of the last poses before (ascending). What would
  /// be interpolated across a jump is left out and counted.
  std::vector<Timestamp> truth_jumps = {};
};

struct TimeGap {
  enum class Cause { kEstimate, kTruth };
  Timestamp start = 0;  ///< the last matched stamp before it
  Timestamp end = 0;    ///< the first matched stamp after it
  Cause cause = Cause::kEstimate;
};

struct Association {
  std::vector<PosePair> pairs;  ///< ascending stamps
  int estimate_count = 0;       ///< poses that the estimate has
  int outside_truth = 0;        ///< of them before the first or after the last of the truth
  int in_truth_gap = 0;         ///< of them where the truth has a gap
  int at_truth_jump = 0;        ///< of them between the two poses of a jump
  double coverage_s = 0.0;      ///< time between neighbouring pairs, gaps left out
  std::vector<TimeGap> gaps;

  /// Pairs over poses of the estimate; 0 where it has none.
  [[nodiscard]] double MatchedShare() const;
};

/// Throws InputError ("NAME: ...") where stamps do not increase strictly, a number is not finite or
/// a quaternion is not of length 1 (to 1e-3: files are rounded).
void CheckTrajectory(const std::string& name, const std::vector<StampedPose>& poses);

/// Pairs each pose of `estimate` with the truth; both with strictly increasing stamps. The sign of
/// a quaternion never matters.
[[nodiscard]] Association Associate(const std::vector<StampedPose>& truth,
                                    const std::vector<StampedPose>& estimate,
                                    const AssociationOptions& options);

}  // namespace duet
