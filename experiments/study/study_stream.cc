#include "experiments/study/study_stream.h"

#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/output_folder.h"
#include "common/support/random.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"
#include "experiments/interrupt.h"
#include "experiments/manifest.h"
#include "experiments/progress.h"
#include "experiments/session.h"
#include "experiments/simulation/simulator.h"
#include "experiments/simulation/write_recording.h"
#include "experiments/study/record_version.h"
#include "experiments/study/study_lock.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

// Apart from the random sequences of a simulation and of a start.
constexpr std::uint64_t kJitterStream = 31;
constexpr std::uint64_t kTrackingSeed = 1;

void Jitter(double sigma_px, int seed, std::vector<TrackFrameSet>* frames) {
  Random random(static_cast<std::uint64_t>(seed), kJitterStream);
  for (TrackFrameSet& set : *frames) {
    for (TrackFrame& frame : set.frames) {
      for (TrackObservation& observation : frame.observations) {
        observation.u += static_cast<float>(sigma_px * random.Normal());
        observation.v += static_cast<float>(sigma_px * random.Normal());
      }
    }
  }
}

/// Tracks the images of a recording; false where it was interrupted.
bool Track(const StudyPlan& plan, const StudyStream& stream, Session* session) {
  SourcesOfTracking(plan.study, stream, &session->configuration);
  session->seed = kTrackingSeed;
  std::vector<TrackFrameSet> frames;
  const std::unique_ptr<LiveTracker> tracker = StartTracking(
      *session,
      [&](const TrackFrameSet& tracks, const ImageSet& /*images*/) { frames.push_back(tracks); });
  while (!Interrupted() && tracker->Next() != nullptr) {
  }
  if (Interrupted()) return false;
  session->recording.vision = Vision::kTracks;
  session->recording.tracks.frames = std::move(frames);
  return true;
}

/// The recording of a stream that is not simulated, with tracks and without jitter.
std::optional<Recording> RecordedStream(const StudyPlan& plan, const PlannedStream& planned,
                                        const fs::path& study_folder) {
  const StudyStream& stream = plan.study.streams[static_cast<std::size_t>(planned.stream)];
  RecordingOptions options;
  options.cameras = stream.cameras;
  if (!planned.base_id.empty()) {
    PlannedStream base = planned;
    base.id = planned.base_id;
    base.base_id.clear();
    base.determined_by = planned.determined_by.substr(0, planned.determined_by.find("jitter_px="));
    base.jitter_seed = 0;
    if (!EnsureStream(plan, base, study_folder)) return std::nullopt;
    options.source = RecordingOptions::Source::kTracks;
    return LoadRecording(StreamFolder(study_folder, base.id), options);
  }
  const StudyRecording& known = plan.recordings.at(RecordingKey(stream));
  Session session;
  session.recording = LoadRecording(known.path, options);
  if (session.recording.fingerprint != known.fingerprint) {
    throw InputError(known.path.string(), 0, "",
                     "is not the recording that the study was planned with; start duet study anew");
  }
  if (session.recording.vision == Vision::kTracks) return std::move(session.recording);
  if (!Track(plan, stream, &session)) return std::nullopt;
  return std::move(session.recording);
}

std::optional<Recording> MakeRecording(const StudyPlan& plan, const PlannedStream& planned,
                                       const fs::path& study_folder, std::string* truth_yaml) {
  const StudyStream& stream = plan.study.streams[static_cast<std::size_t>(planned.stream)];
  std::optional<Recording> recording;
  if (stream.simulated()) {
    ConfigSources sources;
    const SimulatedRecording simulated =
        Simulate(SimulationOf(plan.study, stream, planned.simulation_seed, &sources));
    *truth_yaml = TruthYaml(simulated);
    recording = ToRecording(simulated);
  } else {
    recording = RecordedStream(plan, planned, study_folder);
  }
  if (recording && planned.jitter_seed > 0) {
    Jitter(stream.jitter_px, planned.jitter_seed, &recording->tracks.frames);
  }
  return recording;
}

/// Every file of a stream but those that describe it, by its path in the folder.
std::map<std::string, std::string> HashesOf(const fs::path& folder) {
  std::map<std::string, std::string> hashes;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().lexically_relative(folder).generic_string();
    if (!entry.is_regular_file() || path == "stream.json" || path == "manifest.json") continue;
    hashes[path] = Sha256Hex(ReadTextFile(entry.path()));
  }
  return hashes;
}

void RequireUnchanged(const fs::path& folder) {
  const auto changes = ChangesOfStream(folder, ReadStreamInfo(folder));
  if (changes.empty()) return;
  throw InputError((folder / changes.front().first).string(), 0, "",
                   changes.front().second + "; remove " + folder.string() +
                       " to have the stream made anew, and see duet verify for its runs");
}

/// Writes the stream; false where the program was interrupted, or another one was first.
bool MakeStream(const StudyPlan& plan, const PlannedStream& planned, const fs::path& study_folder) {
  const bool simulated = plan.study.streams[static_cast<std::size_t>(planned.stream)].simulated();
  OutputFolder output(StreamFolder(study_folder, planned.id), OutputFolder::Makers::kSeveral);
  std::string truth_yaml;
  const std::optional<Recording> recording =
      MakeRecording(plan, planned, study_folder, &truth_yaml);
  if (!recording || Interrupted()) return false;
  WriteRecording(*recording, output.path());
  if (simulated) WriteTextFile(output.path() / "mav0" / "truth.yaml", truth_yaml);
  const std::string tracks_sha256 = HashTrackStream(recording->tracks.frames);
  WriteTextFile(output.path() / "tracks.sha256", tracks_sha256 + "\n");
  const nlohmann::ordered_json json = {{"id", planned.id},
                                       {"determined_by", planned.determined_by},
                                       {"simulated", simulated},
                                       {"tracks_sha256", tracks_sha256},
                                       {"sha256", HashesOf(output.path())}};
  WriteTextFile(output.path() / "stream.json", json.dump(2) + "\n");
  WriteManifest(StartManifest(""), output.path());
  return output.CommitUnlessThere();
}

}  // namespace

fs::path StreamFolder(const fs::path& study_folder, const std::string& id) {
  return study_folder / "streams" / id;
}

bool EnsureStream(const StudyPlan& plan, const PlannedStream& stream,
                  const fs::path& study_folder) {
  const fs::path folder = StreamFolder(study_folder, stream.id);
  if (!fs::exists(folder)) {
    MakeFolder(folder.parent_path());
    const std::optional<StudyLock> turn = StudyLock::Wait(folder.string() + ".lock");
    if (!turn) return false;
    if (!fs::exists(folder) && !MakeStream(plan, stream, study_folder) && Interrupted()) {
      return false;
    }
  }
  RequireOwnVersion(folder);
  RequireUnchanged(folder);
  return true;
}

std::vector<int> CamerasOfStream(const fs::path& stream_folder) {
  std::vector<int> cameras;
  for (const int camera : {0, 1}) {
    if (fs::exists(stream_folder / "mav0" / ("tracks" + std::to_string(camera)))) {
      cameras.push_back(camera);
    }
  }
  return cameras;
}

StudyStreamInfo ReadStreamInfo(const fs::path& stream_folder) {
  const fs::path file = stream_folder / "stream.json";
  return ParseStreamInfo(ReadTextFile(file), file.string());
}

StudyStreamInfo ParseStreamInfo(std::string_view text, const std::string& file) {
  try {
    const auto json = nlohmann::ordered_json::parse(text);
    return {.id = json.at("id").get<std::string>(),
            .determined_by = json.at("determined_by").get<std::string>(),
            .simulated = json.at("simulated").get<bool>(),
            .tracks_sha256 = json.at("tracks_sha256").get<std::string>(),
            .files = json.value("sha256", std::map<std::string, std::string>())};
  } catch (const nlohmann::ordered_json::exception& error) {
    throw InputError(file, 0, "", std::string("describes no stream: ") + error.what());
  }
}

std::vector<std::pair<std::string, std::string>> ChangesOfStream(const fs::path& stream_folder,
                                                                 const StudyStreamInfo& info) {
  const std::map<std::string, std::string> found = HashesOf(stream_folder);
  std::vector<std::pair<std::string, std::string>> changes;
  for (const auto& [path, hash] : info.files) {
    const auto file = found.find(path);
    if (file == found.end()) {
      changes.emplace_back(path, "is missing");
    } else if (file->second != hash) {
      changes.emplace_back(path, "has changed since it was written");
    }
  }
  for (const auto& [path, hash] : found) {
    if (!info.files.contains(path)) changes.emplace_back(path, "is not of the stream");
  }
  return changes;
}

}  // namespace duet
