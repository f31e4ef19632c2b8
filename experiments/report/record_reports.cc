#include "experiments/report/record_reports.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "common/support/text_file.h"
#include "evaluation/metrics.h"
#include "evaluation/text_table.h"
#include "experiments/manifest_reader.h"
#include "experiments/record_reader.h"
#include "experiments/study/study_records.h"
#include "experiments/study/study_tables.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

ManifestReader ManifestOf(const fs::path& record) {
  const fs::path file = record / "manifest.json";
  return {ReadTextFile(file), file.string()};
}

double MetricValue(const StudyRun& run, std::string_view key) {
  for (const auto& [name, value] : run.metrics) {
    if (name == key) return value;
  }
  return std::nan("");
}

std::string SentenceOf(const StudyRun& run) {
  if (run.failed) return run.estimator + " failed: " + run.reason + ".";
  std::string sentence = run.estimator;
  if (const double position_m = MetricValue(run, "ate.position_m"); std::isfinite(position_m)) {
    sentence += ": position error " + Number(position_m, 4) + " m, orientation error " +
                Number(MetricValue(run, "ate.orientation_deg"), 3) +
                " deg (root mean square after the alignment that the table names)";
  } else {
    sentence += ": no error against a truth";
  }
  if (const double share = MetricValue(run, "coverage_share"); std::isfinite(share)) {
    sentence += ", " + Number(100.0 * share, 1) + " % of the span covered";
  }
  return sentence + ".";
}

/// What is read of a run before its curves.
ReportRun DescribeRun(const fs::path& root, const fs::path& record, StudyRun run) {
  const ManifestReader manifest = ManifestOf(record);
  const RunRecord read = ReadRunManifest(manifest, 0);
  run.tracks_sha256 = read.tracks_sha256;
  run.failed = read.run.status == "failed";
  run.reason = read.run.reason;
  return {.run = std::move(run),
          .record = record == root ? record.filename() : record.lexically_relative(root),
          .program = manifest.Text("version") + " " + manifest.Text("commit"),
          .settings_sha256 = manifest.Text("settings_sha256"),
          .started_from_truth = false,
          .curves = std::nullopt};
}

double NumberAt(const nlohmann::ordered_json& json, const char* pointer) {
  const nlohmann::ordered_json::json_pointer path(pointer);
  return json.contains(path) && json.at(path).is_number() ? json.at(path).get<double>()
                                                          : std::nan("");
}

StudyRun RunOfComparison(const std::string& estimator, const std::string& stream,
                         const nlohmann::ordered_json& json) {
  StudyRun run;
  run.id = run.estimator = estimator;
  run.stream = run.stream_id = stream;
  const std::string status = json.value("status", "");
  run.failed = status == "failed";
  run.reason = json.value("reason", "");
  constexpr std::array<std::pair<const char*, const char*>, 10> kMetricPaths = {{
      {"ate.position_m", "/ate/position_m"},
      {"ate.orientation_deg", "/ate/orientation_deg"},
      {"ate.tilt_deg", "/ate/tilt_deg"},
      {"coverage_share", "/coverage_share"},
      {"nees.pose", "/nees/pose/mean"},
      {"nees.position", "/nees/position/mean"},
      {"nees.orientation", "/nees/orientation/mean"},
      {"frame_ms.median", "/estimator_ms/median"},
      {"frame_ms.p99", "/estimator_ms/p99"},
      {"peak_memory_mb", "/peak_memory_mb"},
  }};
  for (const auto& [key, path] : kMetricPaths) {
    if (const double value = NumberAt(json, path); std::isfinite(value)) {
      run.metrics.emplace_back(key, value);
    }
  }
  return run;
}

/// "a, b and 3 more"
std::string NamesOf(const StudyResult& result, const std::string StudyRun::*coordinate) {
  constexpr std::size_t kMostNames = 6;
  std::vector<std::string> names;
  for (const StudyRun& run : result.runs) {
    if (std::find(names.begin(), names.end(), run.*coordinate) == names.end()) {
      names.push_back(run.*coordinate);
    }
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNames); ++i) {
    text += (i > 0 ? ", " : "") + names[i];
  }
  if (names.size() > kMostNames) {
    text += " and " + std::to_string(names.size() - kMostNames) + " more";
  }
  return text;
}

/// What was run.
std::string GridSentence(const StudyResult& result) {
  std::set<int> seeds;
  for (const StudyRun& run : result.runs) seeds.insert(run.seed);
  return std::to_string(result.runs.size()) +
         " runs. Streams: " + NamesOf(result, &StudyRun::stream) +
         "; estimators: " + NamesOf(result, &StudyRun::estimator) +
         "; settings: " + NamesOf(result, &StudyRun::setting) +
         "; perturbations: " + NamesOf(result, &StudyRun::perturbation) +
         "; seeds: " + std::to_string(seeds.size()) + ".";
}

}  // namespace

bool IsRunRecord(const fs::path& folder) {
  return fs::exists(folder / "manifest.json") && fs::exists(folder / "states.csv");
}

Report DescribeStudy(const fs::path& folder) {
  const StudyFolder study = ReadStudyFolder(folder);
  Report report;
  report.kind = "study";
  report.title = study.result.name;
  report.question = study.result.question;
  report.foot = study.result.foot;
  report.tables = MakeStudyTables(study.result, TableOptionsOf(study));
  report.overview = StudySummaryTable(study.result, study.study.metrics, {});
  report.overview.foot.resize(1);  // the rest stands at the page's foot
  report.summary.push_back(GridSentence(study.result));
  for (const StudyTable& table : report.tables) {
    for (const std::string& sentence : SentencesOfVerdict(table.verdict)) {
      const auto said = std::find(report.summary.begin(), report.summary.end(), sentence);
      if (said == report.summary.end()) report.summary.push_back(sentence);
    }
  }
  for (std::size_t i = 0; i < study.result.runs.size(); ++i) {
    const StudyRun& run = study.result.runs[i];
    const fs::path& record = study.record_of_run[i];
    if (record.empty()) {
      report.runs.emplace_back().run = run;
    } else {
      report.runs.push_back(DescribeRun(folder, record, run));
      // evaluation.json's word counts: it knows of failures that the manifest does not.
      report.runs.back().run.failed = run.failed;
      report.runs.back().run.reason = run.reason;
    }
  }
  return report;
}

Report DescribeComparison(const fs::path& folder) {
  const fs::path file = folder / "comparison.json";
  const ManifestReader reader(ReadTextFile(file), file.string());
  Report report;
  report.kind = "comparison";
  report.title = reader.Text("dataset");
  report.texts.push_back({"Comparison", ReadTextFile(folder / "comparison.txt")});
  const auto json = nlohmann::ordered_json::parse(ReadTextFile(file));
  for (const auto& [name, value] : json.items()) {
    if (!value.is_object() || !value.contains("status")) continue;
    StudyRun run = RunOfComparison(name, report.title, value);
    if (IsRunRecord(folder / name)) {
      report.runs.push_back(DescribeRun(folder, folder / name, std::move(run)));
    } else {
      ReportRun& absent = report.runs.emplace_back();
      absent.run = std::move(run);
      absent.record = name;
    }
    report.summary.push_back(SentenceOf(report.runs.back().run));
  }
  report.summary.push_back(
      "One run of each is one sample: it does not say which estimator is better.");
  return report;
}

Report DescribeRunRecord(const fs::path& folder) {
  const ManifestReader manifest = ManifestOf(folder);
  StudyRun run;
  run.id = folder.filename().string();
  run.stream = run.stream_id = manifest.Text("dataset.path");
  run.estimator = manifest.Text("backend");
  Report report;
  report.kind = "run";
  report.title = run.estimator + " on " + run.stream;
  report.runs.push_back(DescribeRun(folder, folder, std::move(run)));
  const RunRecord read = ReadRunManifest(manifest, 0);
  report.summary.push_back(std::to_string(read.run.frames) + " frames, " +
                           std::to_string(read.run.waiting_frames) + " of them before the start, " +
                           std::to_string(read.run.dead_reckoned_frames) + " dead reckoned, " +
                           std::to_string(read.run.skipped_frames) + " skipped.");
  report.summary.push_back(report.runs.front().run.failed
                               ? "It failed: " + report.runs.front().run.reason + "."
                               : "It ran to its end.");
  return report;
}

}  // namespace duet
