#include "experiments/record_reader.h"

#include <algorithm>
#include <limits>
#include <string_view>

#include "common/geometry/interpolation.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "experiments/timing_log.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kEstimatorPrefix = "estimator.";
constexpr int kStateSize = 15;

std::string DescribeEnd(const ChildResult& child) {
  if (child.signal != 0) return "its process was ended by signal " + std::to_string(child.signal);
  return "its process ended with status " + std::to_string(child.exit_status);
}

/// The fields of a table as numbers; a field that is none is NaN.
std::vector<std::vector<double>> ReadRows(const fs::path& path) {
  const std::string text = ReadTextFile(path);
  std::vector<std::vector<double>> rows;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    if (line.empty() || line[0] == '#') continue;
    std::vector<double>& row = rows.emplace_back();
    for (std::size_t field = 0; field <= line.size();) {
      const std::size_t comma = std::min(line.find(',', field), line.size());
      row.push_back(ParseDouble(line.substr(field, comma - field)).value_or(kNotANumber));
      field = comma + 1;
    }
  }
  return rows;
}

/// The stamps, exactly: a double does not hold them.
std::vector<Timestamp> ReadStamps(const fs::path& path) {
  const std::string text = ReadTextFile(path);
  std::vector<Timestamp> stamps;
  int line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++line_number;
    if (line.empty() || line[0] == '#') continue;
    const std::optional<std::int64_t> stamp = ParseInt64(line.substr(0, line.find(',')));
    if (!stamp) throw InputError(path.string(), line_number, "", "expected a stamp");
    stamps.push_back(*stamp);
  }
  return stamps;
}

InertialState StateOf(Timestamp instant, const std::vector<double>& row) {
  constexpr int kQuaternion = 3;  // after instant, frame and status
  const Eigen::Map<const Eigen::VectorXd> values(row.data(), static_cast<Eigen::Index>(row.size()));
  InertialState state;
  state.instant = instant;
  state.nav.R_GB = Eigen::Quaterniond(Eigen::Vector4d(values.segment<4>(kQuaternion)));
  state.nav.p_GB = values.segment<3>(kQuaternion + 4);
  state.nav.v_GB = values.segment<3>(kQuaternion + 7);
  state.biases.b_g = values.segment<3>(kQuaternion + 10);
  state.biases.b_a = values.segment<3>(kQuaternion + 13);
  return state;
}

Matrix15d CovarianceOf(const std::vector<double>& row) {
  Matrix15d covariance;
  std::size_t next = 2;  // after instant and size
  for (int i = 0; i < kStateSize; ++i) {
    for (int j = 0; j <= i; ++j) covariance(i, j) = covariance(j, i) = row[next++];
  }
  return covariance;
}

/// The truth's pose interpolated; velocity and biases linear between its rows.
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

}  // namespace

RunRecord ReadRunRecord(const fs::path& folder, const ChildResult& child, Timestamp span_start) {
  RunRecord record;
  EstimatorRun& run = record.run;
  if (!fs::exists(folder / "manifest.json")) {
    run.status = "failed";
    run.reason = DescribeEnd(child);
    return record;
  }
  const Manifest manifest = ReadManifest(folder);
  const Manifest& outcome = manifest.at("outcome");
  run.status = outcome.at("status") == "done" ? outcome.at("last_status") : outcome.at("status");
  run.reason = outcome.at("reason");
  run.frames = outcome.at("frames");
  run.skipped_frames = outcome.at("skipped");
  run.dead_reckoned_frames = outcome.at("dead_reckoned");
  if (outcome.contains("failed_at_ns")) {
    run.failed_at_s = SecondsBetween(span_start, outcome.at("failed_at_ns").get<Timestamp>());
  }
  run.peak_memory_mb = manifest.at("peak_memory_mb");
  record.tracks_sha256 = manifest.at("tracks_sha256");
  for (const auto& [column, values] : ReadTiming(folder / "timing.csv")) {
    if (column == "estimator") {
      run.estimator_ms = Summarize(values);
    } else if (column.rfind(kEstimatorPrefix, 0) == 0) {
      run.stage_median_ms.emplace_back(column.substr(kEstimatorPrefix.size()),
                                       Summarize(values).median);
    }
  }
  if (outcome.contains("first_state_ns")) {
    record.trajectory = ReadTrajectoryFile(folder / "trajectory.tum").poses;
  }
  return record;
}

FrontendRun ReadTrackRecord(const fs::path& folder) {
  const Manifest manifest = ReadManifest(folder);
  FrontendRun run;
  run.frames = manifest.at("frontend").at("frames");
  run.mean_tracks = manifest.at("frontend").at("mean_tracks");
  for (const auto& [column, values] : ReadTiming(folder / "timing.csv")) {
    if (column == "tracking") run.tracking_ms = Summarize(values);
    if (column == "decode") run.decoding_ms = Summarize(values);
  }
  return run;
}

NeesRun ComputeRecordNees(const fs::path& folder, const GroundTruth& truth) {
  const std::vector<Timestamp> stamps = ReadStamps(folder / "states.csv");
  const std::vector<std::vector<double>> states = ReadRows(folder / "states.csv");
  const std::vector<std::vector<double>> covariances = ReadRows(folder / "covariance.csv");
  NeesRun run;
  if (!stamps.empty()) run.start = stamps.front();
  const std::size_t count = std::min(states.size(), covariances.size());
  constexpr std::size_t kTriangle = 2 + kStateSize * (kStateSize + 1) / 2;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<InertialState> truth_state = TruthStateAt(truth, stamps[i]);
    if (!truth_state || covariances[i].size() < kTriangle) continue;
    run.samples.push_back(ComputeNees(stamps[i], *truth_state, StateOf(stamps[i], states[i]),
                                      CovarianceOf(covariances[i]), truth.has_velocities(),
                                      truth.has_biases()));
  }
  return run;
}

}  // namespace duet
