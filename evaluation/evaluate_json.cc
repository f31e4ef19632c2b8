#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "common/support/input_error.h"
#include "evaluation/evaluate.h"

namespace duet {
namespace {

using Json = nlohmann::ordered_json;

Json DriftJson(const std::optional<Drift>& drift) {
  if (!drift) return nullptr;
  return {{"position_max_m", NumberJson(drift->position_max_m)},
          {"position_end_m", NumberJson(drift->position_end_m)},
          {"orientation_max_deg", NumberJson(drift->orientation_max_deg)},
          {"orientation_end_deg", NumberJson(drift->orientation_end_deg)}};
}

Json AlignmentJson(const AlignmentResult& result, AlignmentMode mode) {
  Json json;
  json["mode"] = AlignmentModeName(mode);
  json["refused"] = result.alignment ? Json(nullptr) : Json(AlignmentRefusalText(result.refusal));
  if (result.alignment) {
    const Alignment& a = *result.alignment;
    json["p_GE_m"] = {a.p_GE.x(), a.p_GE.y(), a.p_GE.z()};
    json["q_GE_xyzw"] = {a.R_GE.x(), a.R_GE.y(), a.R_GE.z(), a.R_GE.w()};
    json["scale"] = a.scale;
  } else {
    for (const char* key : {"p_GE_m", "q_GE_xyzw", "scale"}) json[key] = nullptr;
  }
  return json;
}

Json AteJson(const AbsoluteErrors& errors) {
  return {{"position_m", NumberJson(errors.position_m.rmse)},
          {"orientation_deg", NumberJson(errors.orientation_deg.rmse)},
          {"tilt_deg", NumberJson(errors.tilt_deg.rmse)},
          {"yaw_deg", NumberJson(errors.yaw_deg.rmse)},
          {"orientation_by_positions_deg", NumberJson(errors.orientation_by_positions_deg.rmse)},
          {"position_xyz_m",
           {NumberJson(errors.position_rmse_xyz_m.x()), NumberJson(errors.position_rmse_xyz_m.y()),
            NumberJson(errors.position_rmse_xyz_m.z())}},
          {"position", SummaryJson(errors.position_m)},
          {"orientation", SummaryJson(errors.orientation_deg)},
          {"tilt", SummaryJson(errors.tilt_deg)}};
}

Json RelativeJson(const std::vector<RelativeErrors>& relative) {
  Json list = Json::array();
  for (const RelativeErrors& errors : relative) {
    list.push_back({{"length_m", errors.length_m},
                    {"segments", errors.segments},
                    {"translation_m", SummaryJson(errors.translation_m)},
                    {"translation_percent", SummaryJson(errors.translation_percent)},
                    {"rotation_deg", SummaryJson(errors.rotation_deg)},
                    {"yaw_deg", SummaryJson(errors.yaw_deg)},
                    {"tilt_deg", SummaryJson(errors.tilt_deg)}});
  }
  return list;
}

Json GapsJson(const Evaluation& evaluation, const std::vector<TimeGap>& gaps) {
  Json list = Json::array();
  for (const TimeGap& gap : gaps) {
    list.push_back({{"start_s", SecondsBetween(evaluation.start, gap.start)},
                    {"end_s", SecondsBetween(evaluation.start, gap.end)},
                    {"in", gap.cause == TimeGap::Cause::kTruth ? "truth" : "estimate"}});
  }
  return list;
}

}  // namespace

Json NumberJson(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json SummaryJson(const ErrorSummary& s) {
  return {{"count", s.count},
          {"rmse", NumberJson(s.rmse)},
          {"mean", NumberJson(s.mean)},
          {"min", NumberJson(s.min)},
          {"p5", NumberJson(s.p5)},
          {"p25", NumberJson(s.p25)},
          {"median", NumberJson(s.median)},
          {"p75", NumberJson(s.p75)},
          {"p95", NumberJson(s.p95)},
          {"p99", NumberJson(s.p99)},
          {"max", NumberJson(s.max)}};
}

Json TrajectoryJson(const Evaluation& evaluation, const TrajectoryEvaluation& estimate) {
  Json json;
  json["ate"] = AteJson(estimate.absolute);
  json["coverage_s"] = estimate.association.coverage_s;
  json["coverage_share"] = estimate.coverage_share;
  json["matched_share"] = estimate.association.MatchedShare();
  json["poses"] = estimate.association.estimate_count;
  json["matched_poses"] = static_cast<int>(estimate.association.pairs.size());
  json["poses_outside_truth"] = estimate.association.outside_truth;
  json["poses_in_truth_gap"] = estimate.association.in_truth_gap;
  json["poses_at_truth_jump"] = estimate.association.at_truth_jump;
  json["gaps"] = GapsJson(evaluation, estimate.association.gaps);
  json["alignment"] = AlignmentJson(estimate.absolute.alignment, evaluation.options.alignment);
  json["relative"] = RelativeJson(estimate.relative);
  json["drift"] = DriftJson(estimate.drift);
  json["drift_of_truth"] = DriftJson(estimate.drift_true);
  return json;
}

Json SettingsJson(const Evaluation& evaluation) {
  const AssociationOptions& association = evaluation.options.association;
  return {{"truth", evaluation.truth_name},
          {"start_ns", evaluation.start},
          {"end_ns", evaluation.end},
          {"span_s", evaluation.span_s()},
          {"truth_way_m", NumberJson(evaluation.truth_way_m)},
          {"alignment", AlignmentModeName(evaluation.options.alignment)},
          {"association", AssociationModeName(association.mode)},
          {"max_truth_gap_s", association.max_truth_gap_s},
          {"truth_jumps", evaluation.truth_jumps},
          {"relative_start_ns", evaluation.relative.start},
          {"relative_end_ns", evaluation.relative.end},
          {"relative_segments_dropped", evaluation.relative.dropped}};
}

Json EvaluationJson(const Evaluation& evaluation) {
  Json json;
  json["format"] = "duet evaluation 1";
  json["evaluation"] = SettingsJson(evaluation);
  for (const TrajectoryEvaluation& estimate : evaluation.estimates) {
    if (json.contains(estimate.name)) {
      throw InputError(estimate.name, 0, "", "an estimate cannot have this name");
    }
    json[estimate.name] = TrajectoryJson(evaluation, estimate);
  }
  return json;
}

}  // namespace duet
