#include <nlohmann/json.hpp>

#include "evaluation/definitions/definitions_report.h"

namespace duet {
namespace {

using Json = nlohmann::ordered_json;

Json ToolSummaryJson(Tool tool, const ToolSummary& s) {
  Json json = {{"count", s.count},           {"rmse", NumberJson(s.rmse)},
               {"mean", NumberJson(s.mean)}, {"median", NumberJson(s.median)},
               {"std", NumberJson(s.std)},   {"min", NumberJson(s.min)},
               {"max", NumberJson(s.max)}};
  if (tool == Tool::kOvEval) json["p99_if_normal"] = NumberJson(s.p99_if_normal);
  return json;
}

Json FurtherJson(Tool tool, const std::vector<NamedToolSummary>& further) {
  Json json = Json::object();
  for (const NamedToolSummary& one : further) json[one.name] = ToolSummaryJson(tool, one.summary);
  return json;
}

Json ToolRelativeJson(Tool tool, const ToolRelativeErrors& relative) {
  return {{"delta", relative.delta},
          {"unit", relative.in_frames ? "frames" : "m"},
          {"pairs", relative.all_pairs ? "all" : "consecutive"},
          {"own_default", relative.own_default},
          {"segments", relative.segments},
          {"translation_m", ToolSummaryJson(tool, relative.translation_m)},
          {"rotation_deg", ToolSummaryJson(tool, relative.rotation_deg)},
          {"further", FurtherJson(tool, relative.further)}};
}

Json SimilarityJson(const Similarity& similarity) {
  Eigen::Quaterniond R = similarity.R_GE;
  if (R.w() < 0.0) R.coeffs() *= -1.0;
  const Eigen::Vector3d& p = similarity.p_GE;
  return {{"p_GE_m", {p.x(), p.y(), p.z()}},
          {"q_GE_xyzw", {R.x(), R.y(), R.z(), R.w()}},
          {"scale", similarity.scale}};
}

}  // namespace

Json ToolErrorsJson(const ToolErrors& errors) {
  const Tool tool = errors.definition.tool;
  const bool known = errors.refused.empty();
  Json json;
  json["refused"] = known ? Json(nullptr) : Json(errors.refused);
  json["matched_poses"] = static_cast<int>(errors.matches.size());
  json["matched_again"] = errors.poses_matched_again;
  json["largest_stamp_difference_s"] = NumberJson(errors.largest_stamp_difference_s);
  json["alignment"] = known ? SimilarityJson(errors.alignment) : Json(nullptr);
  json["position_m"] = ToolSummaryJson(tool, errors.position_m);
  json["orientation_deg"] = ToolSummaryJson(tool, errors.orientation_deg);
  json["further"] = FurtherJson(tool, errors.further);
  json["relative"] = Json::array();
  for (const ToolRelativeErrors& relative : errors.relative) {
    json["relative"].push_back(ToolRelativeJson(tool, relative));
  }
  return json;
}

void AddDefinitionsJson(const std::vector<DefinitionComparison>& comparisons, Json* json) {
  for (const DefinitionComparison& comparison : comparisons) {
    Json definitions = Json::object();
    for (std::size_t i = 0; i < comparison.tools.size(); ++i) {
      const AbsoluteErrors& alike = comparison.duet_aligned_alike[i];
      Json one = ToolErrorsJson(comparison.tools[i]);
      one["duet_aligned_alike"] = {
          {"position_m", NumberJson(alike.position_m.rmse)},
          {"orientation_deg", NumberJson(alike.orientation_by_positions_deg.rmse)}};
      definitions[comparison.tools[i].definition.Name()] = std::move(one);
    }
    (*json)[comparison.estimate]["definitions"] = std::move(definitions);
  }
}

}  // namespace duet
