#include "experiments/figures/figure_runs.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

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

constexpr std::size_t kMostExamples = 6;

std::string JsonText(const nlohmann::ordered_json& json, const std::string& key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string RecordingName(const fs::path& dataset) {
  const fs::path folder = dataset.lexically_normal();
  const fs::path name = folder.filename().empty() ? folder.parent_path() : folder;
  return (name.filename() == "mav0" ? name.parent_path() : name).filename().string();
}

bool IsRun(const fs::path& folder) {
  return fs::exists(folder / "manifest.json") && fs::exists(folder / "states.csv");
}

// A plain record: its stream is the recording it ran on.
FigureRun PlainRun(const fs::path& folder, const nlohmann::ordered_json& manifest) {
  FigureRun run{.folder = folder, .study = {}, .where = {}, .label = {}};
  run.where.estimator = JsonText(manifest, "backend");
  if (const auto dataset = manifest.find("dataset"); dataset != manifest.end()) {
    run.where.stream = RecordingName(JsonText(*dataset, "path"));
  }
  return run;
}

// A record of a study: where it stands in the grid is said by its study.json.
FigureRun StudyRecord(const fs::path& folder) {
  const fs::path file = folder / "study.json";
  const nlohmann::ordered_json json = ReadJsonFile(file);
  FigureRun run{
      .folder = folder, .study = folder.parent_path().parent_path(), .where = {}, .label = {}};
  StudyRun& where = run.where;
  for (const auto& [key, value] :
       {std::pair{"stream", &where.stream}, std::pair{"estimator", &where.estimator},
        std::pair{"setting", &where.setting}, std::pair{"perturbation", &where.perturbation}}) {
    *value = JsonText(json, key);
    if (value->empty()) throw InputError(file, 0, key, "is missing; expected a text");
  }
  const auto seed = json.find("seed");
  if (seed == json.end() || !seed->is_number_integer()) {
    throw InputError(file, 0, "seed", "is missing; expected an integer");
  }
  where.seed = seed->get<int>();
  where.stream_id = JsonText(json, "stream_id");
  return run;
}

FigureRun ReadRun(const fs::path& folder) {
  const nlohmann::ordered_json manifest = ReadJsonFile(folder / "manifest.json");
  FigureRun run =
      fs::exists(folder / "study.json") ? StudyRecord(folder) : PlainRun(folder, manifest);
  run.where.id = folder.filename();
  run.where.tracks_sha256 = JsonText(manifest, "tracks_sha256");
  if (const auto outcome = manifest.find("outcome"); outcome != manifest.end()) {
    run.where.failed = JsonText(*outcome, "status") != "done";
    run.where.reason = JsonText(*outcome, "reason");
  }
  return run;
}

std::vector<fs::path> FoldersIn(const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && IsRun(entry.path())) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

// The grid's own order is not in the folder's names.
bool BeforeInGrid(const FigureRun& a, const FigureRun& b) {
  const auto key = [](const FigureRun& run) {
    const StudyRun& where = run.where;
    return std::tie(where.stream, where.setting, where.perturbation, where.seed, where.estimator);
  };
  return key(a) < key(b);
}

void LabelRuns(std::vector<FigureRun>* runs) {
  std::set<std::string> streams, settings, perturbations;
  std::set<int> seeds;
  for (const FigureRun& run : *runs) {
    streams.insert(run.where.stream);
    settings.insert(run.where.setting);
    perturbations.insert(run.where.perturbation);
    seeds.insert(run.where.seed);
  }
  for (FigureRun& run : *runs) {
    run.label = run.where.estimator;
    if (settings.size() > 1) run.label += ", " + run.where.setting;
    if (perturbations.size() > 1) run.label += ", " + run.where.perturbation;
    if (streams.size() > 1) run.label += ", " + run.where.stream;
    if (seeds.size() > 1) run.label += ", seed " + std::to_string(run.where.seed);
  }
}

// Of plain records the same estimator on the same recording: apart by their folders' names.
void TellPlainRunsApart(std::vector<FigureRun>* runs) {
  const auto alike = [](const FigureRun& a, const FigureRun& b) {
    return a.where.stream == b.where.stream && a.where.estimator == b.where.estimator;
  };
  for (const FigureRun& a : *runs) {
    const bool twice = std::any_of(runs->begin(), runs->end(), [&](const FigureRun& b) {
      return &a != &b && a.study.empty() && b.study.empty() && alike(a, b);
    });
    if (!twice) continue;
    for (FigureRun& run : *runs) {
      if (!run.study.empty()) continue;
      const bool of_compare = run.folder.filename() == run.where.estimator;
      run.where.setting = (of_compare ? run.folder.parent_path() : run.folder).filename().string();
    }
    return;
  }
}

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

nlohmann::ordered_json ReadJsonFile(const fs::path& file) {
  try {
    return nlohmann::ordered_json::parse(ReadTextFile(file));
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(file, 0, "", std::string("expected JSON: ") + error.what());
  }
}

std::vector<FigureRun> FindRuns(const std::vector<fs::path>& folders) {
  std::vector<FigureRun> runs;
  for (const fs::path& folder : folders) {
    if (!fs::exists(folder)) throw InputError(folder, 0, "", "does not exist; expected a folder");
    if (IsRun(folder)) {
      runs.push_back(ReadRun(fs::absolute(folder).lexically_normal()));
      runs.back().folder = folder;
      continue;
    }
    const bool study = fs::is_directory(folder / "runs");
    std::vector<FigureRun> found;
    for (const fs::path& record : FoldersIn(study ? folder / "runs" : folder)) {
      found.push_back(ReadRun(record));
    }
    if (found.empty()) {
      throw InputError(folder, 0, "",
                       "has no run record; expected the folder of a study (runs/<id>), of duet "
                       "compare or of duet run");
    }
    if (study) std::stable_sort(found.begin(), found.end(), BeforeInGrid);
    runs.insert(runs.end(), found.begin(), found.end());
  }
  if (runs.empty()) {
    throw InputError("", 0, "--runs",
                     "expected the folder of a study, of duet compare or of duet run");
  }
  TellPlainRunsApart(&runs);
  LabelRuns(&runs);
  return runs;
}

std::vector<FigureRun> ExampleRuns(const std::vector<FigureRun>& runs) {
  std::vector<FigureRun> examples;
  const FigureRun& first = runs.front();
  for (const FigureRun& run : runs) {
    const bool same = run.study.empty() ? run.where.stream == first.where.stream
                                        : run.where.stream == first.where.stream &&
                                              run.where.setting == first.where.setting &&
                                              run.where.perturbation == first.where.perturbation &&
                                              run.where.seed == first.where.seed;
    if (same && run.study.empty() == first.study.empty() && examples.size() < kMostExamples) {
      examples.push_back(run);
    }
  }
  LabelRuns(&examples);
  return examples;
}

std::vector<FigureRun> RunsOfFirstGroup(const std::vector<FigureRun>& runs) {
  std::vector<FigureRun> group;
  const StudyRun& first = runs.front().where;
  const bool plain = runs.front().study.empty();
  for (const FigureRun& run : runs) {
    if (plain || (run.where.stream == first.stream && run.where.setting == first.setting &&
                  run.where.perturbation == first.perturbation)) {
      group.push_back(run);
    }
  }
  return group;
}

std::vector<std::string> EstimatorsOf(const std::vector<FigureRun>& runs) {
  std::vector<std::string> names;
  for (const FigureRun& run : runs) {
    if (std::find(names.begin(), names.end(), run.where.estimator) == names.end()) {
      names.push_back(run.where.estimator);
    }
  }
  return names;
}

const std::vector<double>* RecordTable::Find(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return nullptr;
  return &columns[static_cast<std::size_t>(found - names.begin())];
}

RecordTable ReadRecordTable(const fs::path& file) {
  const std::string csv = ReadTextFile(file);
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

std::string DescribeSource(const FigureRun& run) {
  const nlohmann::ordered_json manifest = ReadJsonFile(run.folder / "manifest.json");
  std::string text =
      run.study.empty() ? run.folder.lexically_normal().string() : "runs/" + run.where.id;
  text += " (" + run.label + "): duet " + JsonText(manifest, "version") + " " +
          JsonText(manifest, "commit");
  if (!run.where.tracks_sha256.empty()) {
    text += ", tracks " + run.where.tracks_sha256.substr(0, 16);
  }
  return text;
}

std::vector<std::string> DescribeSources(const std::vector<FigureRun>& runs) {
  std::vector<std::string> sources;
  for (const FigureRun& run : runs) sources.push_back(DescribeSource(run));
  return sources;
}

}  // namespace duet
