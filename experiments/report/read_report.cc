#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/dataset/recording.h"
#include "common/measurement/gauge.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "evaluation/text_table.h"
#include "experiments/configuration.h"
#include "experiments/manifest_reader.h"
#include "experiments/record_reader.h"
#include "experiments/report/report.h"
#include "experiments/report/web_bundle.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

// Instants of a run that are shown, at most and at least.
constexpr std::size_t kMostInstants = 2000;
constexpr std::size_t kFewestInstants = 60;
/// Page and tables beside bundle, figures and curves: of a run, and in all.
constexpr std::size_t kBytesOfRun = 900;
constexpr std::size_t kBytesOfPage = 60'000;

ManifestReader ReadManifest(const fs::path& record) {
  const fs::path file = record / "manifest.json";
  return {ReadTextFile(file), file.string()};
}

// Sorted by name, so that the page does not depend on the file system.
std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    entries.push_back(entry.path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

bool IsRunRecord(const fs::path& folder) {
  return fs::exists(folder / "manifest.json") && fs::exists(folder / "states.csv");
}

std::vector<ReportFigure> ReadFigures(const fs::path& folder) {
  std::vector<ReportFigure> figures;
  if (!fs::is_directory(folder)) return figures;
  for (const fs::path& file : EntriesOf(folder)) {
    if (file.extension() == ".svg") {
      figures.push_back({file.stem().string(), "image/svg+xml", ReadTextFile(file)});
    }
  }
  return figures;
}

/// The truth that a record's manifest leads to, in the axes that its settings tie the body to.
/// Nothing where the recording is not there any more or has none.
struct RecordedTruth {
  std::optional<GroundTruth> truth;
  bool simulated_tracks = false;
};
RecordedTruth ReadTruthOf(const fs::path& record, const ManifestReader& manifest) {
  const fs::path dataset = manifest.Text("dataset.path");
  if (!fs::exists(dataset / "imu0") && !fs::exists(dataset / "mav0")) return {};
  RecordingOptions options;
  options.source = RecordingOptions::Source::kAny;
  options.check_coverage = false;
  Recording recording = LoadRecording(dataset, options);
  if (!recording.truth) return {};
  ConfigSources sources;
  sources.AddFile(record / "config.yaml");
  Configuration configuration;
  configuration.Read(&sources);
  const CalibrationPriors& priors = configuration.shared.calibration;
  const Eigen::Quaterniond gauge =
      GaugeRotation(recording.rig, ToldRig(recording.rig, priors), priors);
  for (StampedPose& pose : recording.truth->poses) {
    pose.T_GB.R = (pose.T_GB.R * gauge.conjugate()).normalized();
  }
  return {std::move(recording.truth), !fs::exists(recording.folder / "cam0")};
}

std::string SentenceOf(const ReportRun& run) {
  const StudyRun& r = run.run;
  if (r.failed) return r.estimator + " failed: " + r.reason + ".";
  std::string sentence = r.estimator;
  const auto value = [&r](std::string_view key) {
    for (const auto& [name, number] : r.metrics) {
      if (name == key) return number;
    }
    return std::nan("");
  };
  if (std::isfinite(value("ate.position_m"))) {
    sentence += ": position error " + Number(value("ate.position_m"), 4) +
                " m, orientation error " + Number(value("ate.orientation_deg"), 3) +
                " deg (RMSE after the alignment of the table)";
  } else {
    sentence += ": no error against a truth";
  }
  if (std::isfinite(value("coverage_share"))) {
    sentence += ", " + Number(100.0 * value("coverage_share"), 1) + " % of the span covered";
  }
  return sentence + ".";
}

/// What is read of a run before its curves.
ReportRun DescribeRun(const fs::path& root, const fs::path& record, StudyRun run) {
  const ManifestReader manifest = ReadManifest(record);
  const RunRecord read = ReadRunManifest(manifest, 0);
  run.tracks_sha256 = read.tracks_sha256;
  run.failed = read.run.status == "failed";
  run.reason = read.run.reason;
  return {.run = std::move(run),
          .record = record == root ? record.filename() : record.lexically_relative(root),
          .program = manifest.Text("version") + " " + manifest.Text("commit"),
          .settings_sha256 = manifest.Text("settings_sha256"),
          .curves = std::nullopt};
}

/// How many instants of each run leave the page below kMostReportBytes.
std::size_t InstantsOfEach(const Report& report) {
  const WebBundle bundle = GetWebBundle();
  std::size_t used = kBytesOfPage + bundle.script.size() + bundle.style.size();
  for (const ReportFigure& figure : report.figures) used += (figure.bytes.size() + 2) / 3 * 4 + 200;
  for (const ReportText& text : report.texts) used += text.text.size();
  const std::size_t runs = std::max<std::size_t>(1, report.runs.size());
  used += runs * kBytesOfRun;
  const std::size_t left = used < kMostReportBytes ? kMostReportBytes - used : 0;
  return std::clamp(left / runs / EncodedSize(1), kFewestInstants, kMostInstants);
}

/// The curves of records that say themselves where their truth is.
void AddCurves(const fs::path& folder, Report* report) {
  const std::size_t most = InstantsOfEach(*report);
  for (ReportRun& run : report->runs) {
    const fs::path record = report->kind == "run" ? folder : folder / run.record;
    if (!IsRunRecord(record)) continue;
    const ManifestReader manifest = ReadManifest(record);
    const RecordedTruth truth = ReadTruthOf(record, manifest);
    const bool from_truth = manifest.Text("init") == "groundtruth";
    report->started_from_truth = report->started_from_truth && from_truth;
    const std::optional<RunCurves> curves = ReadRunCurves(
        record, truth.truth ? &*truth.truth : nullptr, from_truth && truth.simulated_tracks);
    if (curves) run.curves = Thinned(*curves, most);
    if (!truth.truth) {
      report->foot.push_back("The truth of " + run.record.generic_string() + " was not found (" +
                             manifest.Text("dataset.path") + "): no errors are shown.");
    }
  }
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

Report ReadComparison(const fs::path& folder) {
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
    report.summary.push_back(SentenceOf(report.runs.back()));
  }
  report.summary.push_back(
      "One run of each is one sample: it does not say which estimator is better.");
  return report;
}

Report ReadRun(const fs::path& folder) {
  const ManifestReader manifest = ReadManifest(folder);
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

}  // namespace

Report ReadReport(const fs::path& given) {
  const fs::path folder = fs::weakly_canonical(given);
  Report report;
  if (fs::exists(folder / "comparison.json")) {
    report = ReadComparison(folder);
  } else if (IsRunRecord(folder)) {
    report = ReadRun(folder);
  } else {
    throw InputError(given.string(), 0, "",
                     "expected a study's folder, one of duet compare, or a run record");
  }
  report.figures = ReadFigures(folder / "figures");
  AddCurves(folder, &report);
  return report;
}

}  // namespace duet
