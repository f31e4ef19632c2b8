#include "evaluation/evaluate.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/geometry/pose_jumps.h"
#include "common/support/input_error.h"

namespace duet {
namespace {

void CheckOptions(const NamedTrajectory& truth, const std::vector<NamedTrajectory>& estimates,
                  const EvaluationOptions& options) {
  CheckTrajectory(truth.name, truth.poses);
  std::set<std::string> names;
  for (const NamedTrajectory& estimate : estimates) {
    CheckTrajectory(estimate.name, estimate.poses);
    if (!names.insert(estimate.name).second) {
      throw InputError(estimate.name, 0, "", "two estimates have this name");
    }
  }
  if (options.start && options.end && *options.start >= *options.end) {
    throw InputError("the evaluated span ends before it starts");
  }
  for (const double length_m : options.relative.lengths_m) {
    if (!(length_m > 0.0)) throw InputError("a segment's length must be greater than 0 m");
  }
}

std::vector<StampedPose> Crop(const std::vector<StampedPose>& poses, Timestamp start,
                              Timestamp end) {
  std::vector<StampedPose> kept;
  for (const StampedPose& pose : poses) {
    if (start <= pose.timestamp && pose.timestamp <= end) kept.push_back(pose);
  }
  return kept;
}

TrajectoryEvaluation EvaluateOne(const NamedTrajectory& truth, const NamedTrajectory& estimate,
                                 const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  TrajectoryEvaluation result;
  result.name = estimate.name;
  const std::vector<StampedPose> poses = Crop(estimate.poses, evaluation.start, evaluation.end);
  result.association = Associate(truth.poses, poses, options.association);
  if (evaluation.span_s() > 0.0) {
    result.coverage_share = result.association.coverage_s / evaluation.span_s();
  }
  const std::vector<PosePair>& pairs = result.association.pairs;
  result.absolute = ComputeAbsoluteErrors(pairs, options.alignment, options.alignment_options);
  std::vector<Pose> own;
  for (const StampedPose& pose : poses) own.push_back(pose.T_GB);
  result.drift = DriftFromFirstPose(own);
  std::vector<Pose> of_truth;
  for (const PosePair& pair : pairs) of_truth.push_back(pair.T_GB_true);
  result.drift_true = DriftFromFirstPose(of_truth);
  return result;
}

void MarkTruthJumps(const std::vector<StampedPose>& truth, Evaluation* evaluation) {
  std::vector<Timestamp>& jumps = evaluation->options.association.truth_jumps;
  if (jumps.empty() && evaluation->options.find_truth_jumps) {
    for (const PoseJump& jump : FindPoseJumps(truth)) jumps.push_back(jump.before);
  }
  for (const Timestamp jump : jumps) {
    const bool in_span = evaluation->start <= jump && jump < evaluation->end;
    evaluation->truth_jumps += in_span ? 1 : 0;
  }
}

}  // namespace

Evaluation Evaluate(const NamedTrajectory& truth, const std::vector<NamedTrajectory>& estimates,
                    const EvaluationOptions& options) {
  CheckOptions(truth, estimates, options);
  Evaluation evaluation;
  evaluation.options = options;
  evaluation.truth_name = truth.name;
  if (!truth.poses.empty()) {
    evaluation.start = truth.poses.front().timestamp;
    evaluation.end = truth.poses.back().timestamp;
  }
  evaluation.start = options.start.value_or(evaluation.start);
  evaluation.end = std::max(options.end.value_or(evaluation.end), evaluation.start);
  MarkTruthJumps(truth.poses, &evaluation);
  const TravelledDistance way(truth.poses, options.relative.start_step_s);
  evaluation.truth_way_m = way.At(evaluation.end) - way.At(evaluation.start);

  std::vector<std::vector<PosePair>> pairs;
  for (const NamedTrajectory& estimate : estimates) {
    evaluation.estimates.push_back(EvaluateOne(truth, estimate, evaluation));
    pairs.push_back(evaluation.estimates.back().association.pairs);
  }
  evaluation.relative = ComputeRelativeErrors(truth.poses, pairs, options.relative);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    evaluation.estimates[i].relative = std::move(evaluation.relative.of_estimator[i]);
  }
  evaluation.relative.of_estimator.clear();
  return evaluation;
}

void RequireOverlap(const Evaluation& evaluation) {
  for (const TrajectoryEvaluation& estimate : evaluation.estimates) {
    const Association& association = estimate.association;
    if (!association.pairs.empty()) continue;
    const std::string of_poses = "none of its " + std::to_string(association.estimate_count) +
                                 " poses in the evaluated span has a truth in " +
                                 evaluation.truth_name + ": ";
    throw InputError(
        estimate.name, 0, "",
        of_poses + (association.in_truth_gap > 0
                        ? "the truth's steps are longer than evaluation.max_truth_gap_s"
                        : "expected stamps of the same clock and recording"));
  }
}

}  // namespace duet
