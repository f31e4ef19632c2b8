#include "evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "common/geometry/interpolation.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "evaluation/definitions/stamp_matching.h"
#include "evaluation/statistics.h"

namespace duet {
namespace {

constexpr double kGapPerMedianStep = 2.5;

using Index = std::ptrdiff_t;

Index FirstNotBefore(const std::vector<StampedPose>& poses, Timestamp t) {
  return std::lower_bound(
             poses.begin(), poses.end(), t,
             [](const StampedPose& pose, Timestamp at) { return pose.timestamp < at; }) -
         poses.begin();
}

bool JumpsBetween(const std::vector<Timestamp>& jumps, Timestamp start, Timestamp end) {
  const auto jump = std::lower_bound(jumps.begin(), jumps.end(), start);
  return jump != jumps.end() && *jump < end;
}

enum class TruthIs { kKnown, kOutside, kInGap, kAtJump };

TruthIs TruthAt(const std::vector<StampedPose>& truth, Timestamp t,
                const AssociationOptions& options, Pose* T_GB) {
  const Index after = FirstNotBefore(truth, t);
  if (after == static_cast<Index>(truth.size())) return TruthIs::kOutside;
  if (truth[after].timestamp == t) {
    *T_GB = truth[after].T_GB;
    return TruthIs::kKnown;
  }
  if (after == 0) return TruthIs::kOutside;
  const Timestamp start = truth[after - 1].timestamp;
  const Timestamp end = truth[after].timestamp;
  if (JumpsBetween(options.truth_jumps, start, end)) return TruthIs::kAtJump;
  // On the integers: 60 ms in nanoseconds times 1e-9 is more than the double 0.06.
  if (end - start > ToNanoseconds(options.max_truth_gap_s)) return TruthIs::kInGap;
  const auto interpolated = InterpolatePose(truth, t, std::numeric_limits<double>::infinity());
  CHECK(interpolated.has_value());
  *T_GB = *interpolated;
  return TruthIs::kKnown;
}

/// Returns the stamps of the poses that lie in gaps of the truth.
std::vector<Timestamp> AssociateInterpolated(const std::vector<StampedPose>& truth,
                                             const std::vector<StampedPose>& estimate,
                                             const AssociationOptions& options,
                                             Association* result) {
  std::vector<Timestamp> in_gap;
  for (const StampedPose& pose : estimate) {
    Pose T_GB_true;
    switch (TruthAt(truth, pose.timestamp, options, &T_GB_true)) {
      case TruthIs::kKnown:
        result->pairs.push_back({pose.timestamp, T_GB_true, pose.T_GB});
        break;
      case TruthIs::kOutside:
        break;
      case TruthIs::kInGap:
        in_gap.push_back(pose.timestamp);
        break;
      case TruthIs::kAtJump:
        ++result->at_truth_jump;
        break;
    }
  }
  result->in_truth_gap = static_cast<int>(in_gap.size());
  return in_gap;
}

void TakePairs(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate,
               const std::vector<StampMatch>& matches, Association* result) {
  for (const StampMatch& match : matches) {
    const StampedPose& pose = estimate[match.estimate];
    result->pairs.push_back({pose.timestamp, truth[match.truth].T_GB, pose.T_GB});
  }
}

template <class Stamped>
double MedianStep(const std::vector<Stamped>& poses) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    steps.push_back(SecondsBetween(poses[i - 1].timestamp, poses[i].timestamp));
  }
  if (steps.empty()) return 0.0;
  std::sort(steps.begin(), steps.end());
  return SortedQuantile(steps, 0.5);
}

/// Coverage and gaps. A step between pairs is covered where none of the estimate's poses inside it
/// lies in a gap of the truth (`in_gap`) and it is not longer than the estimate's usual steps.
void MeasureCoverage(const std::vector<StampedPose>& estimate, const std::vector<Timestamp>& in_gap,
                     const AssociationOptions& options, Association* result) {
  // The nearest modes leave poses out by design: there the pairs' own step is the usual one.
  const double usual_step_s = options.mode == AssociationMode::kInterpolated
                                  ? MedianStep(estimate)
                                  : MedianStep(result->pairs);
  const double longest_s = options.max_estimate_gap_s > 0.0 ? options.max_estimate_gap_s
                                                            : kGapPerMedianStep * usual_step_s;
  for (std::size_t i = 1; i < result->pairs.size(); ++i) {
    const Timestamp start = result->pairs[i - 1].timestamp;
    const Timestamp end = result->pairs[i].timestamp;
    const auto next_in_gap = std::lower_bound(in_gap.begin(), in_gap.end(), start);
    if (next_in_gap != in_gap.end() && *next_in_gap < end) {
      result->gaps.push_back({start, end, TimeGap::Cause::kTruth});
    } else if (SecondsBetween(start, end) > longest_s) {
      result->gaps.push_back({start, end, TimeGap::Cause::kEstimate});
    } else {
      result->coverage_s += SecondsBetween(start, end);
    }
  }
}

}  // namespace

const char* AssociationModeName(AssociationMode mode) {
  switch (mode) {
    case AssociationMode::kInterpolated:
      return "interpolated";
    case AssociationMode::kEvoNearest:
      return "evo";
    case AssociationMode::kRpgNearest:
      return "rpg";
    case AssociationMode::kOvEvalNearest:
      return "ov_eval";
  }
  return "";
}

double Association::MatchedShare() const {
  return estimate_count > 0 ? static_cast<double>(pairs.size()) / estimate_count : 0.0;
}

void CheckTrajectory(const std::string& name, const std::vector<StampedPose>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const StampedPose& pose = poses[i];
    const std::string at =
        "pose " + std::to_string(i + 1) + " (stamp " + std::to_string(pose.timestamp) + " ns)";
    if (i > 0 && pose.timestamp <= poses[i - 1].timestamp) {
      throw InputError(name, 0, "",
                       at + ": stamps must increase, the one before is " +
                           std::to_string(poses[i - 1].timestamp));
    }
    if (!pose.T_GB.p.allFinite() || !pose.T_GB.R.coeffs().allFinite()) {
      throw InputError(name, 0, "", at + ": expected finite numbers");
    }
    if (std::abs(pose.T_GB.R.norm() - 1.0) > 1e-3) {
      throw InputError(name, 0, "", at + ": expected a quaternion of length 1");
    }
  }
}

Association Associate(const std::vector<StampedPose>& truth,
                      const std::vector<StampedPose>& estimate, const AssociationOptions& options) {
  Association result;
  std::vector<Timestamp> in_gap;
  result.estimate_count = static_cast<int>(estimate.size());
  switch (options.mode) {
    case AssociationMode::kInterpolated:
      in_gap = AssociateInterpolated(truth, estimate, options, &result);
      break;
    case AssociationMode::kEvoNearest:
      TakePairs(truth, estimate, MatchLikeEvo(truth, estimate), &result);
      break;
    case AssociationMode::kRpgNearest:
      TakePairs(truth, estimate, MatchLikeRpg(truth, estimate), &result);
      break;
    case AssociationMode::kOvEvalNearest:
      TakePairs(truth, estimate, MatchLikeOvEval(truth, estimate), &result);
      break;
  }
  for (const StampedPose& pose : estimate) {
    const bool outside = truth.empty() || pose.timestamp < truth.front().timestamp ||
                         pose.timestamp > truth.back().timestamp;
    result.outside_truth += outside ? 1 : 0;
  }
  MeasureCoverage(estimate, in_gap, options, &result);
  return result;
}

}  // namespace duet
