#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "evaluation/definitions/nearest_index.h"
#include "evaluation/definitions/tool_errors.h"
#include "evaluation/definitions/tool_pairs.h"

namespace duet {
namespace {

constexpr double kEvoLengthTolerance = 0.1;  // --delta_tol

struct IndexPair {
  int start;
  int end;
};

/// |R - I| and |T - I|, Frobenius.
struct EvoMatrixErrors {
  std::vector<double> rotation_part, full_transformation;

  void Add(const Pose& E) {
    const double rotation =
        (E.R.normalized().toRotationMatrix() - Eigen::Matrix3d::Identity()).norm();
    rotation_part.push_back(rotation);
    full_transformation.push_back(std::hypot(rotation, E.p.norm()));
  }
  [[nodiscard]] std::vector<NamedToolSummary> Summaries() {
    return {{"rotation_part", SummarizeForTool(std::move(rotation_part), 0)},
            {"full_transformation", SummarizeForTool(std::move(full_transformation), 0)}};
  }
};

std::vector<IndexPair> EvoConsecutiveFrames(int count) {
  std::vector<IndexPair> pairs;
  for (int i = 1; i < count; ++i) pairs.push_back({i - 1, i});
  return pairs;
}

std::vector<IndexPair> EvoAllPairs(const std::vector<double>& way_m, double length_m) {
  std::vector<IndexPair> pairs;
  for (int i = 0; i + 1 < static_cast<int>(way_m.size()); ++i) {
    const auto off = [&](double way) { return std::abs(way - way_m[i] - length_m); };
    const int end = NearestIndex(way_m, i + 1, way_m[i] + length_m, off);
    if (off(way_m[end]) <= kEvoLengthTolerance * length_m) pairs.push_back({i, end});
  }
  return pairs;
}

std::vector<IndexPair> EvoConsecutivePairs(const std::vector<Pose>& poses, double length_m) {
  std::vector<IndexPair> pairs;
  int last = -1;
  double gone_m = 0.0;
  for (int i = 1; i < static_cast<int>(poses.size()); ++i) {
    gone_m += (poses[i].p - poses[i - 1].p).norm();
    if (gone_m < length_m) continue;
    if (last >= 0) pairs.push_back({last, i});
    last = i;
    gone_m = 0.0;
  }
  return pairs;
}

ToolRelativeErrors EvoRelativeErrors(const ToolPairs& pairs,
                                     const std::vector<IndexPair>& segments) {
  std::vector<double> translation_m, rotation_deg;
  EvoMatrixErrors matrix_errors;
  for (const IndexPair& segment : segments) {
    const Pose E = RelativePoseError(pairs, pairs.aligned, segment.start, segment.end, 1.0);
    translation_m.push_back(E.p.norm());
    rotation_deg.push_back(AngleDeg(E.R));
    matrix_errors.Add(E);
  }
  ToolRelativeErrors errors;
  errors.segments = static_cast<int>(segments.size());
  errors.translation_m = SummarizeForTool(std::move(translation_m), 0);
  errors.rotation_deg = SummarizeForTool(std::move(rotation_deg), 0);
  errors.further = matrix_errors.Summaries();
  return errors;
}

/// False where evo stops.
bool AlignLikeEvo(const ToolPairs& pairs, const ToolDefinition& definition, Similarity* alignment) {
  if (definition.alignment == ToolAlignment::kNone) return true;
  if (definition.alignment == ToolAlignment::kFirstPose) {
    *alignment = FitFirstPose(pairs.truth, pairs.estimate);
    return true;
  }
  const UmeyamaFit fit = FitUmeyama(pairs.truth, pairs.estimate,
                                    definition.alignment != ToolAlignment::kSe3, definition.poses);
  if (!(fit.singular_values.y() > std::numeric_limits<double>::epsilon())) return false;
  if (definition.alignment == ToolAlignment::kScale) {
    alignment->scale = fit.similarity.scale;
  } else {
    *alignment = fit.similarity;
  }
  return true;
}

}  // namespace

ToolErrors EvaluateLikeEvo(const std::vector<StampedPose>& truth,
                           const std::vector<StampedPose>& estimate,
                           const ToolDefinition& definition, std::span<const double> lengths_m) {
  ToolErrors errors;
  errors.definition = definition;
  ToolPairs pairs = TakeMatches(truth, estimate, MatchLikeEvo(truth, estimate), &errors);
  if (pairs.truth.empty()) {
    errors.refused = "evo stops: no stamps within 0.01 s";
    return errors;
  }
  if (!AlignLikeEvo(pairs, definition, &errors.alignment)) {
    errors.refused = "evo stops: the positions lie on a line";
    return errors;
  }
  pairs.Move(errors.alignment);
  SummarizeAbsoluteErrors(pairs, 0, &errors);
  EvoMatrixErrors matrix_errors;
  for (std::size_t i = 0; i < pairs.truth.size(); ++i) {
    matrix_errors.Add(pairs.aligned[i].Inverse() * pairs.truth[i]);
  }
  errors.further = matrix_errors.Summaries();

  const auto add = [&](double delta, bool in_frames, bool all_pairs,
                       const std::vector<IndexPair>& segments) {
    ToolRelativeErrors relative = EvoRelativeErrors(pairs, segments);
    relative.delta = delta;
    relative.in_frames = in_frames;
    relative.all_pairs = all_pairs;
    relative.own_default = in_frames;
    errors.relative.push_back(std::move(relative));
  };
  add(1.0, true, false, EvoConsecutiveFrames(static_cast<int>(pairs.truth.size())));
  const std::vector<double> way_m = WayAlong(pairs.aligned);
  for (const double length_m : lengths_m) {
    add(length_m, false, true, EvoAllPairs(way_m, length_m));
    add(length_m, false, false, EvoConsecutivePairs(pairs.aligned, length_m));
  }
  return errors;
}

}  // namespace duet
