#include "experiments/study/study_run.h"

#include <chrono>
#include <nlohmann/json.hpp>

#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"
#include "experiments/estimator_run.h"
#include "experiments/study/record_version.h"
#include "experiments/study/run_evaluation.h"
#include "experiments/study/study_stream.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Session OpenStudySession(const StudyPlan& plan, const PlannedRun& run, const fs::path& folder) {
  const StudyStream& stream = plan.StreamOf(run);
  Session session;
  session.sources = SourcesOfRun(plan, run);
  session.configuration.Read(&session.sources);
  session.init = stream.init;
  session.seed = static_cast<std::uint64_t>(run.draw_seed);
  RecordingOptions options;
  options.source = RecordingOptions::Source::kTracks;
  options.cameras = CamerasOfStream(folder);
  options.start_s = run.start_s;
  options.duration_s = stream.duration_s;
  session.recording = LoadRecording(folder, options);
  // A rare draw is no bad input.
  SharedOptions& shared = session.configuration.shared;
  const SharedOptions told = shared;
  IncludeTold(ToldRig(session.recording.rig, shared.calibration), &shared);
  if (shared.max_abs_t_d_s != told.max_abs_t_d_s || shared.max_abs_t_r_s != told.max_abs_t_r_s) {
    LOG(WARNING) << "the bounds of t_d and t_r are widened to hold what was drawn as told";
  }
  return session;
}

/// study.json with its own hash: that of the same text without it.
std::string Sealed(Json json) {
  json["own_sha256"] = "";
  json["own_sha256"] = Sha256Hex(json.dump());
  return json.dump(2) + "\n";
}

bool IsSealed(Json json) {
  const std::string hash = json.value("own_sha256", "");
  json["own_sha256"] = "";
  return hash == Sha256Hex(json.dump());
}

std::string StudyJson(const StudyPlan& plan, const PlannedRun& run, const fs::path& stream_folder,
                      const fs::path& record) {
  const StudyFile& study = plan.study;
  Json json = {
      {"id", run.id},
      {"study", study.name},
      {"stream", plan.StreamOf(run).name},
      {"estimator", run.estimator},
      {"setting", study.settings[static_cast<std::size_t>(run.setting)].name},
      {"perturbation", study.perturbations[static_cast<std::size_t>(run.perturbation)].name},
      {"seed", run.seed},
      {"stream_id", plan.InputOf(run).id},
      {"stream_sha256", Sha256Hex(ReadTextFile(stream_folder / "stream.json"))},
      {"determined_by", run.determined_by},
      {"sha256", Json::object()},
      {"bytes", Json::object()}};
  for (const std::string& name : CanonicalFiles()) {
    if (!fs::exists(record / name)) continue;
    const std::string text = ReadTextFile(record / name);
    json["sha256"][name] = Sha256Hex(text);
    json["bytes"][name] = text.size();
  }
  return Sealed(std::move(json));
}

}  // namespace

const std::vector<std::string>& CanonicalFiles() {
  static const std::vector<std::string> names = {
      "trajectory.tum", "states.csv",      "calibration.csv", "covariance.csv",
      "features.csv",   "evaluation.json", "truth.csv",       "calibration_truth.csv"};
  return names;
}

fs::path RecordFolderOf(const fs::path& study_folder, const std::string& id) {
  return study_folder / "runs" / id;
}

ExitStatus RunStudyRun(const StudyPlan& plan, const PlannedRun& run, const fs::path& study_folder,
                       const std::string& command_line) {
  const fs::path target = RecordFolderOf(study_folder, run.id);
  if (fs::exists(target)) {
    if (DamageOfRecord(target).empty()) return kDone;
    std::error_code error;
    fs::remove_all(target, error);
    if (error) throw OutputError(target.string(), "cannot be removed: " + error.message());
  }
  if (!EnsureStream(plan, plan.InputOf(run), study_folder)) return kInterrupted;
  const auto start = std::chrono::steady_clock::now();
  const fs::path stream_folder = StreamFolder(study_folder, plan.InputOf(run).id);
  LogCapture log(/*quiet=*/true);  // what is logged stands in the record
  Session session = OpenStudySession(plan, run, stream_folder);
  MakeFolder(target.parent_path());
  RecordFolder record(target.string(), command_line, log, OutputFolder::Makers::kSeveral);
  const EstimatorRunResult result = RunEstimator(
      {.backend = run.estimator, .covariance = true, .quiet = true}, &session, &record);
  if (result.outcome == LoopOutcome::kInterrupted) return kInterrupted;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  record.manifest()["elapsed_s"] = elapsed.count();
  record.WriteRest(session.sources);
  WriteRunEvaluation(
      EvaluateRecord(record.path(), session.recording, plan.StreamOf(run).simulated()),
      record.path());
  WriteTextFile(record.path() / "study.json", StudyJson(plan, run, stream_folder, record.path()));
  (void)record.folder().CommitUnlessThere();  // another's record is the same
  return kDone;
}

StudyRecordInfo ReadRecordInfo(const fs::path& record) {
  const fs::path file = record / "study.json";
  return ParseRecordInfo(ReadTextFile(file), file.string());
}

StudyRecordInfo ParseRecordInfo(std::string_view text, const std::string& file) {
  StudyRecordInfo info;
  try {
    const Json json = Json::parse(text);
    info.id = json.at("id").get<std::string>();
    info.determined_by = json.at("determined_by").get<std::string>();
    info.stream_id = json.at("stream_id").get<std::string>();
    info.stream_sha256 = json.value("stream_sha256", "");
    const Json bytes = json.value("bytes", Json::object());
    for (const auto& [name, size] : bytes.items()) {
      if (!size.is_number_unsigned()) throw InputError(file, 0, "bytes." + name, "expected a size");
      info.bytes[name] = size.get<std::uintmax_t>();
    }
    info.unchanged = IsSealed(json);
    for (const auto& [name, hash] : json.at("sha256").items()) {
      info.files.emplace_back(name, hash.get<std::string>());
    }
  } catch (const Json::exception& error) {
    throw InputError(file, 0, "", std::string("describes no run: ") + error.what());
  }
  return info;
}

std::string DamageOfRecord(const fs::path& record) {
  for (const char* name : {"manifest.json", "study.json"}) {
    if (!fs::exists(record / name)) return std::string(name) + " is missing";
    if (!Json::accept(ReadTextFile(record / name))) return std::string(name) + " is torn";
  }
  RequireOwnVersion(record);
  StudyRecordInfo info;
  try {
    info = ReadRecordInfo(record);
  } catch (const InputError&) {
    return "study.json lacks keys";
  }
  if (info.bytes.empty()) return "study.json lists no files";
  for (const char* name : {"config.yaml", "timing.csv"}) {
    if (!fs::exists(record / name)) return std::string(name) + " is missing";
  }
  for (const auto& [name, size] : info.bytes) {
    std::error_code error;
    if (!fs::exists(record / name, error)) return name + " is missing";
    const std::uintmax_t found = fs::file_size(record / name, error);
    if (error || found != size) {
      return name + " has " + std::to_string(found) + " bytes, not " + std::to_string(size);
    }
  }
  return "";
}

}  // namespace duet
