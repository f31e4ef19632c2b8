#include "experiments/figures/run_errors.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "evaluation/errors.h"
#include "experiments/record_reader.h"
#include "experiments/session.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void FailWithoutCovariance(const FigureRun& run) {
  const std::string command = JsonText(ReadJsonFile(run.folder / "manifest.json"), "command_line");
  throw InputError(run.folder.string() + " has no covariance.csv; run it again with --covariance" +
                   (command.empty() ? std::string() : ": " + command + " --covariance"));
}

bool StartsInTruthsAxes(const FigureRun& run) {
  const std::string init = JsonText(ReadJsonFile(run.folder / "manifest.json"), "init");
  return init == "groundtruth" || init == "drawn";
}

std::vector<RecordedCovariance> CovariancesOf(const FigureRun& run) {
  const fs::path file = run.folder / "covariance.csv";
  if (!fs::exists(file)) FailWithoutCovariance(run);
  return ReadCovarianceTable(ReadTextFile(file), file);
}

}  // namespace

const std::vector<double>* RecordTable::Find(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return nullptr;
  return &columns[static_cast<std::size_t>(found - names.begin())];
}

RecordTable ReadRecordTable(const fs::path& file) {
  return ParseRecordTable(ReadTextFile(file), file.string());
}

RecordTable ParseRecordTable(std::string_view csv, const std::string& file) {
  RecordTable table;
  std::vector<std::string> names = ReadColumnNames(csv, file);
  table.names.assign(names.begin() + 1, names.end());
  table.columns.resize(table.names.size());
  CsvReader reader(csv, file, {std::move(names)});
  while (reader.Next()) {
    table.stamps.push_back(reader.CheckLater(0, reader.Stamp(0)));
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      table.columns[k].push_back(ParseDouble(reader.Text(static_cast<int>(k) + 1))
                                     .value_or(std::numeric_limits<double>::quiet_NaN()));
    }
  }
  return table;
}

Recording RecordingOf(const FigureRun& run) {
  const fs::path file = run.folder / "manifest.json";
  const nlohmann::ordered_json manifest = ReadJsonFile(file);
  const auto dataset = manifest.find("dataset");
  if (dataset == manifest.end()) throw InputError(file, 0, "dataset", "is missing");
  fs::path path = JsonText(*dataset, "path");
  if (!run.study.empty() && !run.where.stream_id.empty()) {
    const fs::path own = run.study / "streams" / run.where.stream_id;
    if (fs::exists(own / "mav0")) path = own;
  }
  if (!fs::exists(path)) {
    throw InputError(file, 0, "dataset.path",
                     path.string() +
                         " is not there; expected the recording that was run on (a "
                         "relative path counts from where duet was called)");
  }
  RecordingOptions options;
  options.source = RecordingOptions::Source::kAny;
  options.check_coverage = false;
  if (const auto cameras = dataset->find("cameras"); cameras != dataset->end()) {
    options.cameras = cameras->get<std::vector<int>>();
  }
  // What was tracked from images lies in the record, or beside those of duet compare.
  const std::string first = "tracks" + std::to_string(options.cameras.front());
  for (const fs::path& tracks : {run.folder, run.folder.parent_path() / "tracks"}) {
    if (options.tracks_folder.empty() && fs::exists(tracks / first)) {
      options.source = RecordingOptions::Source::kTracks;
      options.tracks_folder = tracks;
    }
  }
  Recording recording = LoadRecording(path, options);
  // Of tracks that lay elsewhere the fingerprint counts those.
  const bool own_tracks = options.tracks_folder.empty() &&
                          JsonText(manifest, "command_line").find("--tracks") == std::string::npos;
  const std::string fingerprint = JsonText(*dataset, "fingerprint_sha256");
  if (own_tracks && !fingerprint.empty() && recording.fingerprint != fingerprint) {
    throw InputError(file, 0, "dataset.fingerprint_sha256",
                     path.string() + " has changed since the run: " + recording.fingerprint);
  }
  return recording;
}

GroundTruth TruthOf(const FigureRun& run) {
  if (const fs::path file = run.folder / "truth.csv"; fs::exists(file)) {
    return ReadTrajectoryFile(file);
  }
  Session session;
  session.recording = RecordingOf(run);
  if (!session.recording.truth) {
    throw InputError(session.recording.folder.string() +
                     " has no ground truth; expected state_groundtruth_estimate0/data.csv or " +
                     (run.folder / "truth.csv").string());
  }
  session.sources.AddFile(run.folder / "config.yaml");
  session.configuration.Read(&session.sources);
  GroundTruth truth = *session.recording.truth;
  truth.poses = session.TruthFor(session.Setup());
  return truth;
}

std::vector<StampedPose> TrajectoryOf(const FigureRun& run) {
  const fs::path file = run.folder / "states.csv";
  std::vector<StampedPose> poses;
  for (const InertialState& state : ReadStateTable(ReadTextFile(file), file)) {
    poses.push_back({state.instant, state.nav.pose()});
  }
  return poses;
}

Alignment AlignOrFirst(const std::vector<PosePair>& pairs, AlignmentMode mode, bool* by_first) {
  const AlignmentResult fit = Align(pairs, mode);
  *by_first = !fit.alignment.has_value();
  if (fit.alignment) return *fit.alignment;
  Alignment alignment{.mode = mode};
  alignment.R_GE = FitYawToOrientations(pairs).value_or(Eigen::Quaterniond::Identity());
  alignment.p_GE = pairs.front().T_GB_true.p - alignment.R_GE * pairs.front().T_EB.p;
  return alignment;
}

ErrorsOverTime ErrorsOf(const FigureRun& run) {
  const std::vector<RecordedCovariance> covariances = CovariancesOf(run);
  const Association association = Associate(TruthOf(run).poses, TrajectoryOf(run), {});
  ErrorsOverTime errors;
  Alignment laid;
  Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
  errors.aligned = !StartsInTruthsAxes(run);
  if (errors.aligned && !association.pairs.empty()) {
    laid = AlignOrFirst(association.pairs, AlignmentMode::kPositionYaw, &errors.by_first);
    turned = FitYawToOrientations(association.pairs).value_or(turned);
  }
  const nlohmann::ordered_json manifest = ReadJsonFile(run.folder / "manifest.json");
  Timestamp start = association.pairs.empty() ? 0 : association.pairs.front().timestamp;
  if (const auto dataset = manifest.find("dataset");
      dataset != manifest.end() && dataset->contains("first_frame_ns")) {
    start = dataset->at("first_frame_ns").get<Timestamp>();
  }
  constexpr double kDegrees = 180.0 / 3.14159265358979323846;
  auto covariance = covariances.begin();
  for (const PosePair& pair : association.pairs) {
    while (covariance != covariances.end() && covariance->instant < pair.timestamp) ++covariance;
    if (covariance == covariances.end()) break;
    if (covariance->instant != pair.timestamp) continue;
    errors.t_s.push_back(SecondsBetween(start, pair.timestamp));
    const Eigen::Vector3d p = pair.T_GB_true.p - laid.Apply(pair.T_EB.p);
    const Eigen::Vector3d theta = Log(pair.T_GB_true.R * (turned * pair.T_EB.R).conjugate());
    const Eigen::Matrix3d to_p = laid.R_GE.toRotationMatrix();
    const Eigen::Matrix3d to_theta = turned.toRotationMatrix();
    const Eigen::Vector3d p_var =
        (to_p * covariance->covariance.block<3, 3>(3, 3) * to_p.transpose()).diagonal();
    const Eigen::Vector3d theta_var =
        (to_theta * covariance->covariance.block<3, 3>(0, 0) * to_theta.transpose()).diagonal();
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      errors.p_m[k].push_back(p[i]);
      errors.theta_deg[k].push_back(theta[i] * kDegrees);
      errors.sigma_p_m[k].push_back(std::sqrt(std::max(0.0, p_var[i])));
      errors.sigma_theta_deg[k].push_back(std::sqrt(std::max(0.0, theta_var[i])) * kDegrees);
    }
  }
  return errors;
}

NeesRun NeesOf(const FigureRun& run) {
  if (!fs::exists(run.folder / "covariance.csv")) FailWithoutCovariance(run);
  if (!StartsInTruthsAxes(run)) {
    throw InputError(
        run.folder.string() +
        " did not start in the truth's axes, so that its errors have no NEES; expected "
        "a run with --init groundtruth (or drawn)");
  }
  NeesRun nees = ComputeRecordNees(run.folder, TruthOf(run));
  nees.failed = run.where.failed;
  const fs::path file = run.folder / "states.csv";
  const std::string csv = ReadTextFile(file);
  CsvReader reader(csv, file, {ReadColumnNames(csv, file)});
  auto sample = nees.samples.begin();
  bool first = true;
  while (reader.Next()) {
    const Timestamp instant = reader.Stamp(0);
    const Timestamp frame = reader.Stamp(1);
    if (first) nees.start = frame;
    first = false;
    while (sample != nees.samples.end() && sample->timestamp < instant) ++sample;
    if (sample == nees.samples.end()) break;
    if (sample->timestamp == instant) {
      sample->timestamp = frame;
      ++sample;
    }
  }
  return nees;
}

RunRmse RmseOf(const FigureRun& run) {
  RunRmse rmse;
  const fs::path file = run.folder / "evaluation.json";
  if (std::filesystem::exists(file)) {
    const nlohmann::ordered_json json = ReadJsonFile(file);
    if (!json.contains("metrics")) throw InputError(file, 0, "metrics", "is missing");
    const auto get = [&](const char* key, double* value) {
      const auto found = json.at("metrics").find(key);
      if (found != json.at("metrics").end() && found->is_number()) *value = found->get<double>();
    };
    get("ate.position_m", &rmse.position_m);
    get("ate.orientation_deg", &rmse.orientation_deg);
    return rmse;
  }
  const std::vector<StampedPose> estimate = TrajectoryOf(run);
  if (estimate.empty()) return rmse;
  const AbsoluteErrors errors = ComputeAbsoluteErrors(
      Associate(TruthOf(run).poses, estimate, {}).pairs, AlignmentMode::kPositionYaw);
  rmse.position_m = errors.position_m.rmse;
  rmse.orientation_deg = errors.orientation_deg.rmse;
  return rmse;
}

}  // namespace duet
