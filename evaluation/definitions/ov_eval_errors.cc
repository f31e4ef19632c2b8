#include <utility>

#include "evaluation/definitions/tool_errors.h"
#include "evaluation/definitions/tool_pairs.h"

namespace duet {
namespace {

constexpr double kOvEvalReachM = 0.5;
constexpr double kOvEvalLengthsM[] = {8.0, 16.0, 24.0, 32.0, 40.0};

void AddOvEvalPercentile(ToolSummary* summary) {
  summary->p99_if_normal = summary->mean + 2.326 * summary->std;
}

ToolSummary SummarizeLikeOvEval(std::vector<double> values) {
  ToolSummary summary = SummarizeForTool(std::move(values), 1);
  AddOvEvalPercentile(&summary);
  return summary;
}

Similarity AlignLikeOvEval(const ToolPairs& pairs, ToolAlignment alignment) {
  switch (alignment) {
    case ToolAlignment::kPositionYaw:
      return FitPositionYaw(pairs.truth, pairs.estimate);
    case ToolAlignment::kFirstPositionYaw:
      return FitFirstPositionYaw(pairs.truth, pairs.estimate);
    case ToolAlignment::kFirstPose:
      return FitFirstPose(pairs.truth, pairs.estimate);
    case ToolAlignment::kSe3:
      return FitUmeyama(pairs.truth, pairs.estimate, false).similarity;
    case ToolAlignment::kSim3:
      return FitUmeyama(pairs.truth, pairs.estimate, true).similarity;
    default:
      return {};
  }
}

ToolRelativeErrors OvEvalRelativeErrors(const ToolPairs& pairs, const std::vector<double>& way_m,
                                        double length_m) {
  std::vector<double> translation_m, rotation_deg;
  for (int start = 0; start < static_cast<int>(way_m.size()); ++start) {
    const int end = SegmentEnd(way_m, start, length_m, kOvEvalReachM);
    if (end < 0) continue;
    const Pose E = RelativePoseError(pairs, pairs.aligned, start, end, 1.0);
    translation_m.push_back(E.p.norm());
    rotation_deg.push_back(AngleDeg(E.R));
  }
  ToolRelativeErrors errors;
  errors.delta = length_m;
  errors.segments = static_cast<int>(translation_m.size());
  errors.translation_m = SummarizeLikeOvEval(std::move(translation_m));
  errors.rotation_deg = SummarizeLikeOvEval(std::move(rotation_deg));
  return errors;
}

}  // namespace

ToolErrors EvaluateLikeOvEval(const std::vector<StampedPose>& truth,
                              const std::vector<StampedPose>& estimate,
                              const ToolDefinition& definition, std::span<const double> lengths_m) {
  ToolErrors errors;
  errors.definition = definition;
  ToolPairs pairs = TakeMatches(truth, estimate, MatchLikeOvEval(truth, estimate), &errors);
  if (pairs.truth.size() < 3) {
    errors.refused = "ov_eval stops: fewer than three stamps within 0.02 s";
    return errors;
  }
  errors.alignment = AlignLikeOvEval(pairs, definition.alignment);
  pairs.Move(errors.alignment);
  SummarizeAbsoluteErrors(pairs, 1, &errors);
  AddOvEvalPercentile(&errors.position_m);
  AddOvEvalPercentile(&errors.orientation_deg);
  const std::vector<double> way_m = WayAlong(pairs.truth);
  for (const double length_m : kOvEvalLengthsM) {
    errors.relative.push_back(OvEvalRelativeErrors(pairs, way_m, length_m));
    errors.relative.back().own_default = true;
  }
  for (const double length_m : lengths_m) {
    errors.relative.push_back(OvEvalRelativeErrors(pairs, way_m, length_m));
  }
  return errors;
}

}  // namespace duet
