#include "experiments/study/run_time.h"

#include <algorithm>
#include <map>

#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "evaluation/statistics.h"
#include "experiments/manifest_reader.h"
#include "experiments/study/study_run.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

// Of a frame of a run with default settings on a processor of 2022, with simulating its share of a
// stream and evaluating: docs/results.md has what was measured.
constexpr double kRoughFilterFrame_s = 0.004;
constexpr double kRoughOtherFrame_s = 0.008;
constexpr int kUnknownFrames = 1000;

std::string CellName(const PlannedRun& run) {
  return run.estimator + "\n" + std::to_string(run.setting);
}

/// Medians of the time a frame, by cell and by estimator.
std::map<std::string, double> FrameTimes(const StudyPlan& plan, const fs::path& folder) {
  std::map<std::string, std::vector<double>> times;
  for (const int index : plan.Distinct()) {
    const PlannedRun& run = plan.runs[static_cast<std::size_t>(index)];
    const fs::path file = RecordFolderOf(folder, run.id) / "manifest.json";
    if (!fs::exists(file)) continue;
    const ManifestReader manifest(ReadTextFile(file), file.string());
    const int frames = manifest.Count("outcome.frames");
    if (!manifest.Has("elapsed_s") || frames == 0) continue;
    const double frame_s = manifest.Number("elapsed_s") / frames;
    times[CellName(run)].push_back(frame_s);
    times[run.estimator].push_back(frame_s);
  }
  std::map<std::string, double> medians;
  for (const auto& [name, values] : times) medians[name] = Summarize(values).median;
  return medians;
}

}  // namespace

TimeEstimate EstimateTime(const StudyPlan& plan, const std::vector<int>& runs,
                          const fs::path& folder) {
  const std::map<std::string, double> known = FrameTimes(plan, folder);
  TimeEstimate estimate;
  std::size_t from_records = 0;
  for (const int index : runs) {
    const PlannedRun& run = plan.runs[static_cast<std::size_t>(index)];
    const int frames = std::max(plan.InputOf(run).frames, 0);
    auto found = known.find(CellName(run));
    if (found == known.end()) found = known.find(run.estimator);
    const double rough_s = run.estimator == "msckf" ? kRoughFilterFrame_s : kRoughOtherFrame_s;
    estimate.total_s +=
        (frames > 0 ? frames : kUnknownFrames) * (found != known.end() ? found->second : rough_s);
    from_records += found != known.end() ? 1 : 0;
  }
  const std::string rough = "by a rough rate of " + FormatNumber(1e3 * kRoughFilterFrame_s) +
                            " ms a frame of the filter and " +
                            FormatNumber(1e3 * kRoughOtherFrame_s) + " ms of others";
  if (runs.empty()) {
    estimate.from = "nothing is left";
  } else if (from_records == runs.size()) {
    estimate.from = "by the records that are there";
  } else if (from_records == 0) {
    estimate.from = rough;
  } else {
    estimate.from = "by the records that are there, else " + rough;
  }
  return estimate;
}

std::string DurationText(double seconds) {
  if (seconds < 90.0) return FormatFixed(seconds, 0) + " s";
  if (seconds < 5400.0) return FormatFixed(seconds / 60.0, 0) + " min";
  return FormatFixed(seconds / 3600.0, 1) + " h";
}

}  // namespace duet
