#include "experiments/record_reader.h"

#include <algorithm>
#include <string_view>

#include "common/dataset/csv_reader.h"
#include "common/geometry/interpolation.h"
#include "common/support/text_file.h"
#include "experiments/timing_log.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kEstimatorPrefix = "estimator.";

std::string DescribeEnd(const ChildResult& child) {
  if (child.signal != 0) return "its process was ended by signal " + std::to_string(child.signal);
  return "its process ended with status " + std::to_string(child.exit_status);
}

void AddRunTimes(const std::vector<std::pair<std::string, std::vector<double>>>& columns,
                 EstimatorRun* run) {
  for (const auto& [column, values] : columns) {
    if (column == "estimator") {
      run->estimator_ms = Summarize(values);
    } else if (column.rfind(kEstimatorPrefix, 0) == 0) {
      run->stage_median_ms.emplace_back(column.substr(kEstimatorPrefix.size()),
                                        Summarize(values).median);
    }
  }
}

}  // namespace

std::optional<InertialState> TruthStateAt(const GroundTruth& truth, Timestamp t) {
  const std::optional<Pose> pose =
      InterpolatePose(truth.poses, t, AssociationOptions{}.max_truth_gap_s);
  if (!pose) return std::nullopt;
  const auto next =
      std::lower_bound(truth.poses.begin(), truth.poses.end(), t,
                       [](const StampedPose& p, Timestamp stamp) { return p.timestamp < stamp; });
  const auto right = static_cast<std::size_t>(next - truth.poses.begin());
  const std::size_t left = next->timestamp == t ? right : right - 1;
  const double share = left == right
                           ? 0.0
                           : SecondsBetween(truth.poses[left].timestamp, t) /
                                 SecondsBetween(truth.poses[left].timestamp, next->timestamp);
  const auto mix = [share](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return Eigen::Vector3d((1.0 - share) * a + share * b);
  };
  InertialState state;
  state.instant = t;
  state.nav.R_GB = pose->R;
  state.nav.p_GB = pose->p;
  if (truth.has_velocities()) {
    state.nav.v_GB = mix(truth.velocities[left], truth.velocities[right]);
  }
  if (truth.has_biases()) {
    state.biases.b_g = mix(truth.biases[left].b_g, truth.biases[right].b_g);
    state.biases.b_a = mix(truth.biases[left].b_a, truth.biases[right].b_a);
  }
  return state;
}

RunRecord ReadRunRecord(const fs::path& folder, const ChildResult& child, Timestamp span_start) {
  RunRecord record;
  const fs::path manifest = folder / "manifest.json";
  if (!fs::exists(manifest)) {
    record.run.status = "failed";
    record.run.reason = DescribeEnd(child);
    return record;
  }
  const ManifestReader reader(ReadTextFile(manifest), manifest.string());
  record = ReadRunManifest(reader, span_start);
  const fs::path timing = folder / "timing.csv";
  AddRunTimes(ReadTimingTable(ReadTextFile(timing), timing.string()), &record.run);
  if (reader.Has("outcome.first_state_ns")) {
    record.trajectory = ReadTrajectoryFile(folder / "trajectory.tum").poses;
  }
  return record;
}

RunRecord ReadRunManifest(const ManifestReader& manifest, Timestamp span_start) {
  RunRecord record;
  EstimatorRun& run = record.run;
  const std::string status = manifest.Text("outcome.status");
  run.status = status == "done" ? manifest.Text("outcome.last_status") : status;
  run.reason = manifest.Text("outcome.reason");
  run.frames = manifest.Count("outcome.frames");
  run.waiting_frames = manifest.Count("outcome.waiting");
  run.waited_s = manifest.Number("outcome.waited_s");
  run.waited_for = manifest.Text("outcome.waited_for");
  run.skipped_frames = manifest.Count("outcome.skipped");
  run.dead_reckoned_frames = manifest.Count("outcome.dead_reckoned");
  if (manifest.Has("outcome.failed_at_ns")) {
    run.failed_at_s =
        SecondsBetween(span_start, manifest.Integer("outcome.failed_at_ns", 0, kLatestStamp));
  }
  run.peak_memory_mb = manifest.Number("peak_memory_mb");
  record.tracks_sha256 = manifest.Text("tracks_sha256");
  return record;
}

FrontendRun ReadTrackManifest(const ManifestReader& manifest) {
  FrontendRun run;
  run.frames = manifest.Count("frontend.frames");
  run.mean_tracks = manifest.Number("frontend.mean_tracks");
  return run;
}

FrontendRun ReadTrackRecord(const fs::path& folder) {
  const fs::path manifest = folder / "manifest.json";
  const fs::path timing = folder / "timing.csv";
  FrontendRun run = ReadTrackManifest(ManifestReader(ReadTextFile(manifest), manifest.string()));
  for (const auto& [column, values] : ReadTimingTable(ReadTextFile(timing), timing.string())) {
    if (column == "tracking") run.tracking_ms = Summarize(values);
    if (column == "decode") run.decoding_ms = Summarize(values);
  }
  return run;
}

NeesRun ComputeRecordNees(const fs::path& folder, const GroundTruth& truth) {
  const fs::path states_file = folder / "states.csv";
  const fs::path covariance_file = folder / "covariance.csv";
  return ComputeNeesOfTables(
      ReadStateTable(ReadTextFile(states_file), states_file.string()),
      ReadCovarianceTable(ReadTextFile(covariance_file), covariance_file.string()), truth);
}

NeesRun ComputeNeesOfTables(const std::vector<InertialState>& states,
                            const std::vector<RecordedCovariance>& covariances,
                            const GroundTruth& truth) {
  NeesRun run;
  if (!states.empty()) run.start = states.front().instant;
  auto covariance = covariances.begin();
  for (const InertialState& state : states) {
    while (covariance != covariances.end() && covariance->instant < state.instant) ++covariance;
    if (covariance == covariances.end()) break;
    if (covariance->instant != state.instant) continue;
    const std::optional<InertialState> truth_state = TruthStateAt(truth, state.instant);
    if (!truth_state) continue;
    run.samples.push_back(ComputeNees(state.instant, *truth_state, state, covariance->covariance,
                                      truth.has_velocities(), truth.has_biases()));
  }
  return run;
}

}  // namespace duet
