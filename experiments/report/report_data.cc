#include "experiments/report/report_data.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "evaluation/chi_squared.h"
#include "evaluation/consistency.h"
#include "evaluation/evaluate.h"
#include "evaluation/metrics.h"

namespace duet {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kConfidence = 0.95;

Json NeesJson() {
  Json json;
  json["confidence"] = kConfidence;
  for (const NeesBlock block : {NeesBlock::kPose, NeesBlock::kPosition, NeesBlock::kOrientation}) {
    const Band band = MeanChiSquaredBand(NeesBlockSize(block), 1, kConfidence);
    json[NeesBlockName(block)] = {{"dof", NeesBlockSize(block)}, {"band", {band.low, band.high}}};
  }
  return json;
}

Json QuaternionJson(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

Json AlignmentJson(const std::optional<RunCurves::Alignment>& alignment) {
  if (!alignment) return nullptr;
  const Eigen::Vector3d& p = alignment->p_GE;
  return {{"R", QuaternionJson(alignment->R_GE)},
          {"p", {p.x(), p.y(), p.z()}},
          {"orientation_R", QuaternionJson(alignment->orientation_R_GE)}};
}

Json RunJson(const ReportRun& report_run, Timestamp origin) {
  const StudyRun& run = report_run.run;
  Json json = {{"id", run.id},
               {"stream", run.stream},
               {"estimator", run.estimator},
               {"setting", run.setting},
               {"perturbation", run.perturbation},
               {"seed", run.seed},
               {"stream_id", run.stream_id},
               {"failed", run.failed},
               {"reason", run.reason}};
  Json metrics = Json::array();
  for (const auto& [key, value] : run.metrics) metrics.push_back({key, NumberJson(value)});
  json["metrics"] = std::move(metrics);
  if (report_run.curves) {
    json["from_truth"] = report_run.started_from_truth;
    json["instants"] = report_run.curves->all_instants;
    json["alignment"] = AlignmentJson(report_run.curves->alignment);
    json["curves"] = EncodeCurves(*report_run.curves, origin);
  }
  return json;
}

// What the keys of any run mean; a key that is unknown stands for itself.
Json MetricsJson(const Report& report) {
  Json json = Json::object();
  for (const ReportRun& run : report.runs) {
    for (const auto& [key, value] : run.run.metrics) {
      if (json.contains(key)) continue;
      const std::optional<Metric> metric = FindMetric(key);
      json[key] = {{"label", metric ? metric->Title() : key}};
    }
  }
  return json;
}

// The first instant of all runs on a stream: they are shown over one time.
std::map<std::string, Timestamp> OriginsOf(const std::vector<ReportRun>& runs) {
  std::map<std::string, Timestamp> origins;
  for (const ReportRun& run : runs) {
    if (!run.curves) continue;
    const Timestamp first = run.curves->instants.front();
    const auto [origin, is_new] = origins.emplace(run.run.stream, first);
    if (!is_new) origin->second = std::min(origin->second, first);
  }
  return origins;
}

}  // namespace

std::string ReportDataJson(const Report& report) {
  Json estimators = Json::array();
  for (const ReportRun& run : report.runs) {
    if (std::find(estimators.begin(), estimators.end(), Json(run.run.estimator)) ==
        estimators.end()) {
      estimators.push_back(run.run.estimator);
    }
  }
  Json json = {{"format", "duet report 1"},
               {"columns", kCurveColumns},
               {"estimators", std::move(estimators)},
               {"metrics", MetricsJson(report)},
               {"nees", NeesJson()}};
  std::map<std::string, Timestamp> origins = OriginsOf(report.runs);
  Json runs = Json::array();
  for (const ReportRun& run : report.runs) runs.push_back(RunJson(run, origins[run.run.stream]));
  json["runs"] = std::move(runs);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace duet
