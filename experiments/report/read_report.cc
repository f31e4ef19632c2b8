#include <algorithm>

#include "common/dataset/recording.h"
#include "common/measurement/gauge.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/configuration.h"
#include "experiments/manifest_reader.h"
#include "experiments/report/record_reports.h"
#include "experiments/report/report.h"
#include "experiments/study/study_records.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

// Instants of a run that are shown, at most and at least.
constexpr std::size_t kMostInstants = 2000;
constexpr std::size_t kFewestInstants = 60;
/// What a run with curves has in the page besides them: its alignment.
constexpr std::size_t kBytesBesideCurves = 400;

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

// The first line of a figure's data says what it shows; without it the file's name has to do.
std::string TitleOfFigure(const fs::path& drawing) {
  fs::path data = drawing;
  data.replace_extension(".csv");
  if (fs::exists(data)) {
    const std::string text = ReadTextFile(data);
    const std::string line = text.substr(0, text.find('\n'));
    if (line.starts_with("# ") && line.size() > 2) return line.substr(2);
  }
  return drawing.stem().string();
}

std::vector<ReportFigure> ReadFigures(const fs::path& folder) {
  std::vector<ReportFigure> figures;
  if (!fs::is_directory(folder)) return figures;
  for (const fs::path& file : EntriesOf(folder)) {
    if (file.extension() == ".svg") {
      figures.push_back(
          {file.stem().string(), TitleOfFigure(file), "image/svg+xml", ReadTextFile(file)});
    }
  }
  return figures;
}

/// The truth in the axes that the estimator ties the body to: a study's record has it, otherwise
/// its manifest leads to it. Nothing where the recording is not there any more or has none.
struct RecordedTruth {
  std::optional<GroundTruth> truth;
  bool simulated_tracks = false;
};
RecordedTruth ReadTruthOf(const fs::path& record, const ManifestReader& manifest) {
  if (fs::exists(record / "truth.csv")) return {ReadTrajectoryFile(record / "truth.csv")};
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

bool HasMetric(const StudyRun& run, std::string_view key) {
  return std::any_of(run.metrics.begin(), run.metrics.end(),
                     [key](const auto& metric) { return metric.first == key; });
}

void AddCurves(const fs::path& folder, Report* report) {
  const std::size_t most = InstantsThatFit(*report);
  std::size_t without_truth = 0;
  for (ReportRun& run : report->runs) {
    const fs::path record = report->kind == "run" ? folder : folder / run.record;
    if (run.record.empty() || !IsRunRecord(record)) continue;
    const ManifestReader manifest = ReadManifest(record);
    const RecordedTruth truth = ReadTruthOf(record, manifest);
    const std::string init = manifest.Text("init");
    run.started_from_truth = init == "groundtruth" || init == "drawn";
    // Where the record does not say whether a NEES is claimed: as duet compare does it.
    const bool with_nees =
        HasMetric(run.run, "nees.pose") ||
        (report->kind == "run" && run.started_from_truth && truth.simulated_tracks);
    const std::optional<RunCurves> curves =
        ReadRunCurves(record, truth.truth ? &*truth.truth : nullptr, with_nees);
    if (curves) run.curves = Thinned(*curves, most);
    without_truth += truth.truth ? 0 : 1;
  }
  if (without_truth > 0) {
    report->foot.push_back(
        "Without a truth that could be found, and so without errors over time: " +
        std::to_string(without_truth) + " of " + std::to_string(report->runs.size()) + " runs.");
  }
}

}  // namespace

std::size_t InstantsThatFit(const Report& report) {
  const std::size_t runs = std::max<std::size_t>(1, report.runs.size());
  const std::size_t used = ReportPage(report).size() + runs * kBytesBesideCurves;
  const std::size_t left = used < kMostReportBytes ? kMostReportBytes - used : 0;
  return std::clamp(left / runs / EncodedSize(1), kFewestInstants, kMostInstants);
}

Report ReadReport(const fs::path& given) {
  const fs::path folder = fs::weakly_canonical(given);
  Report report;
  if (IsStudyFolder(folder)) {
    report = DescribeStudy(folder);
  } else if (fs::exists(folder / "comparison.json")) {
    report = DescribeComparison(folder);
  } else if (IsRunRecord(folder)) {
    report = DescribeRunRecord(folder);
  } else {
    throw InputError(given.string(), 0, "",
                     "expected a study's folder, one of duet compare, or a run record");
  }
  report.figures = ReadFigures(folder / "figures");
  AddCurves(folder, &report);
  return report;
}

std::size_t WriteReport(const fs::path& folder, const fs::path& file) {
  const std::string page = ReportPage(ReadReport(folder));
  ReplaceTextFile(file, page);
  return page.size();
}

}  // namespace duet
