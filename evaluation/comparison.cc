#include "evaluation/comparison.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/logging.h"

namespace duet {
namespace {

using Json = nlohmann::ordered_json;
using CellText = std::function<std::string(const EstimatorRun&)>;

void AddRow(const Comparison& comparison, std::string title, const CellText& cell,
            TextTable* table) {
  std::vector<std::string> row = {std::move(title)};
  for (const EstimatorRun& run : comparison.runs) row.push_back(cell(run));
  table->AddRow(std::move(row));
}

void AddOutcomeRows(const Comparison& comparison, TextTable* table) {
  const auto count = [&](const char* title, int EstimatorRun::*field) {
    AddRow(
        comparison, title, [&](const EstimatorRun& run) { return std::to_string(run.*field); },
        table);
  };
  count("  frames", &EstimatorRun::frames);
  count("  frames before the start, no estimate", &EstimatorRun::waiting_frames);
  AddRow(
      comparison, "  waited for the start [s]",
      [](const EstimatorRun& run) { return Number(run.waited_s, 2); }, table);
  count("  frames without IMU, skipped", &EstimatorRun::skipped_frames);
  count("  frames dead reckoned", &EstimatorRun::dead_reckoned_frames);
  count("  restarts", &EstimatorRun::restarts);
}

void AddCostRows(const Comparison& comparison, TextTable* table) {
  table->AddSection("cost (thread CPU time a frame; front end apart)");
  const auto time = [&](const char* title, double ErrorSummary::*field) {
    AddRow(
        comparison, title,
        [&](const EstimatorRun& run) { return Number(run.estimator_ms.*field, 2); }, table);
  };
  time("  estimator, median [ms]", &ErrorSummary::median);
  time("  estimator, p99 [ms]", &ErrorSummary::p99);
  AddRow(
      comparison, "  peak memory of the process [MB]",
      [](const EstimatorRun& run) { return Number(run.peak_memory_mb, 1); }, table);
}

void AddNeesRows(const Comparison& comparison, TextTable* table) {
  bool any = false;
  for (const EstimatorRun& run : comparison.runs) any = any || !run.nees.empty();
  if (!any) return;
  table->AddSection("NEES, mean over time after 2 s (one run: no verdict)");
  for (const NeesBlock block : kNeesBlocks) {
    const auto cell = [&](const EstimatorRun& run) -> std::string {
      for (const NeesOfRun& nees : run.nees) {
        if (nees.block == block) return Number(nees.mean, 2);
      }
      return "-";
    };
    const bool known = std::any_of(comparison.runs.begin(), comparison.runs.end(),
                                   [&](const EstimatorRun& run) { return cell(run) != "-"; });
    if (!known) continue;
    AddRow(comparison,
           std::string("  ") + NeesBlockName(block) + ", expected " +
               std::to_string(NeesBlockSize(block)),
           cell, table);
  }
}

void AddSettingsRows(const Comparison& comparison, TextTable* table) {
  std::vector<std::string> names;  // of all runs, in the order of first use
  for (const EstimatorRun& run : comparison.runs) {
    for (const auto& [name, value] : run.settings) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  if (names.empty()) return;
  table->AddSection("switched on");
  for (const std::string& name : names) {
    AddRow(
        comparison, "  " + name,
        [&](const EstimatorRun& run) -> std::string {
          for (const auto& [key, value] : run.settings) {
            if (key == name) return value;
          }
          return "";
        },
        table);
  }
}

std::string FrontendText(const Comparison& comparison) {
  std::string text;
  if (comparison.frontend && comparison.frontend->replayed) {
    text += "front end: tracks replayed, no times\n";
  } else if (comparison.frontend) {
    const FrontendRun& frontend = *comparison.frontend;
    text += "front end: tracking " + Number(frontend.tracking_ms.median, 2) + " ms median, " +
            Number(frontend.tracking_ms.p99, 2) + " ms p99 over " +
            std::to_string(frontend.frames) + " frames; decoding apart, " +
            Number(frontend.decoding_ms.median, 2) + " ms; " + Number(frontend.mean_tracks, 0) +
            " tracks a frame\n";
  }
  text += "tracks SHA-256: " + comparison.tracks_sha256 + "\n";
  return text;
}

std::string FailuresText(const Comparison& comparison) {
  std::string text;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const EstimatorRun& run = comparison.runs[i];
    if (run.reason.empty()) continue;
    text += comparison.evaluation.estimates[i].name + ": " + run.status;
    if (std::isfinite(run.failed_at_s)) text += " at " + Number(run.failed_at_s, 2) + " s";
    text += ", " + run.reason + "\n";
  }
  for (const std::string& warning : comparison.warnings) text += "WARNING: " + warning + "\n";
  return text;
}

Json FrontendJson(const std::optional<FrontendRun>& run) {
  const FrontendRun frontend = run.value_or(FrontendRun{});
  return {{"replayed", frontend.replayed},
          {"frames", frontend.frames},
          {"tracking_ms", SummaryJson(frontend.tracking_ms)},
          {"decoding_ms", SummaryJson(frontend.decoding_ms)},
          {"mean_tracks", NumberJson(frontend.mean_tracks)}};
}

Json RunJson(const EstimatorRun& run) {
  Json json;
  json["status"] = run.status;
  json["reason"] = run.reason;
  json["failed_at_s"] = NumberJson(run.failed_at_s);
  json["frames"] = run.frames;
  json["waiting_frames"] = run.waiting_frames;
  json["waited_s"] = NumberJson(run.waited_s);
  json["waited_for"] = run.waited_for;
  json["skipped_frames"] = run.skipped_frames;
  json["dead_reckoned_frames"] = run.dead_reckoned_frames;
  json["restarts"] = run.restarts;
  json["estimator_ms"] = SummaryJson(run.estimator_ms);
  json["stages_ms"] = Json::object();
  for (const auto& [stage, median] : run.stage_median_ms) {
    json["stages_ms"][stage] = NumberJson(median);
  }
  json["peak_memory_mb"] = NumberJson(run.peak_memory_mb);
  json["nees"] = Json::object();
  for (const NeesBlock block : kNeesBlocks) {
    Json of_block = {{"dof", NeesBlockSize(block)}, {"mean", nullptr}, {"median", nullptr}};
    for (const NeesOfRun& nees : run.nees) {
      if (nees.block != block) continue;
      of_block["mean"] = NumberJson(nees.mean);
      of_block["median"] = NumberJson(nees.median);
    }
    json["nees"][NeesBlockName(block)] = std::move(of_block);
  }
  json["settings"] = Json::object();
  for (const auto& [name, value] : run.settings) json["settings"][name] = value;
  return json;
}

}  // namespace

std::string ComparisonText(const Comparison& comparison) {
  CHECK_EQ(comparison.runs.size(), comparison.evaluation.estimates.size());
  std::vector<std::string> header = {comparison.dataset};
  for (const TrajectoryEvaluation& e : comparison.evaluation.estimates) header.push_back(e.name);
  TextTable table(std::move(header));
  AddRow(
      comparison, "outcome", [](const EstimatorRun& run) { return run.status; }, &table);
  AddAccuracyRows(comparison.evaluation, &table);
  AddCoverageRows(comparison.evaluation, &table);
  AddOutcomeRows(comparison, &table);
  AddCostRows(comparison, &table);
  AddNeesRows(comparison, &table);
  AddSettingsRows(comparison, &table);
  return table.Text() + "\ncameras " + comparison.cameras + "; started from " + comparison.start +
         "\n" + FrontendText(comparison) + FailuresText(comparison) + "\n" +
         EvaluationNotes(comparison.evaluation);
}

Json ComparisonJson(const Comparison& comparison) {
  CHECK_EQ(comparison.runs.size(), comparison.evaluation.estimates.size());
  Json json;
  json["format"] = "duet comparison 1";
  json["dataset"] = comparison.dataset;
  json["cameras"] = comparison.cameras;
  json["start"] = comparison.start;
  json["tracks_sha256"] = comparison.tracks_sha256;
  json["frontend"] = FrontendJson(comparison.frontend);
  json["evaluation"] = SettingsJson(comparison.evaluation);
  json["warnings"] = comparison.warnings;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const TrajectoryEvaluation& estimate = comparison.evaluation.estimates[i];
    if (json.contains(estimate.name)) {
      throw InputError(estimate.name, 0, "", "an estimator cannot have this name");
    }
    Json of_estimator = RunJson(comparison.runs[i]);
    of_estimator.update(TrajectoryJson(comparison.evaluation, estimate));
    json[estimate.name] = std::move(of_estimator);
  }
  return json;
}

Json ComparisonTemplate(const std::vector<std::string>& names) {
  Comparison comparison;
  for (const std::string& name : names) {
    TrajectoryEvaluation estimate;
    estimate.name = name;
    estimate.absolute.position_rmse_xyz_m.setConstant(std::numeric_limits<double>::quiet_NaN());
    estimate.drift.emplace();
    estimate.drift_true.emplace();
    estimate.relative.emplace_back();
    comparison.evaluation.estimates.push_back(std::move(estimate));
    comparison.runs.emplace_back();
  }
  return ComparisonJson(comparison);
}

}  // namespace duet
