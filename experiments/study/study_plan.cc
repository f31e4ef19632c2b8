#include "experiments/study/study_plan.h"

#include <algorithm>
#include <set>

#include "common/dataset/recording.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"
#include "experiments/simulation/scenario.h"
#include "experiments/study/study_told.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kIdDigits = 16;
constexpr int kSeedDigits = 8;                // of the hash that a stream's own seed is made of
constexpr std::uint64_t kSeeds = 2000000000;  // simulation.seed ends there
constexpr const char* kToldErrorsSeed = "shared.calibration.told_errors_seed";

/// A name that is too long for any file, or lies in a folder that can't be read, is not there.
bool IsThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

void AddKeys(const std::vector<StudyKey>& keys, ConfigSources* sources) {
  for (const StudyKey& key : keys) sources->AddKey(key.key, key.value, key.file);
}

void AddChange(const StudyChange& change, const std::string& estimator, ConfigSources* sources) {
  AddKeys(change.set, sources);
  const auto only = change.only.find(estimator);
  if (only != change.only.end()) AddKeys(only->second, sources);
}

bool IsOfFrontend(const StudyKey& key) { return key.key.starts_with("frontend."); }

/// What `told` names a file or folder beside the study's file is found there.
std::string BesideStudy(const fs::path& study_file, const std::string& told) {
  if (told.empty() || fs::path(told).is_absolute()) return told;
  const fs::path beside = study_file.parent_path() / told;
  return IsThere(beside) ? fs::absolute(beside).lexically_normal().string() : told;
}

/// What a path in a simulation's settings stands for: not the path decides, but what is there.
std::string ContentOf(const std::string& path) {
  if (path.empty() || !IsThere(path)) return path;
  if (fs::is_regular_file(path)) return "sha256:" + Sha256Hex(ReadTextFile(path));
  RecordingOptions options;
  options.source = RecordingOptions::Source::kAny;
  return "recording:" + LoadRecording(path, options).fingerprint;
}

std::string Line(const std::string& key, const std::string& value) {
  return key + "=" + value + "\n";
}

std::string SimulationLines(const ConfigSources& sources, const SimulationOptions& options) {
  std::vector<std::string> lines;
  for (const ResolvedValue& value : sources.values()) {
    std::string text = value.value;
    if (value.key == "simulation.sensors") text = ContentOf(options.sensors);
    if (value.key == "simulation.trajectory") text = ContentOf(options.trajectory);
    if (value.key == "simulation.imu") text = ContentOf(options.imu);
    lines.push_back(Line(value.key, text));
  }
  std::sort(lines.begin(), lines.end());
  std::string all;
  for (const std::string& line : lines) all += line;
  return all;
}

std::string TrackingLines(const ConfigSources& sources) {
  std::string lines;
  for (const ResolvedValue& value : sources.values()) {
    const bool counts = value.key.starts_with("frontend.") || value.key == "shared.max_tracks";
    if (counts && value.key != "frontend.threads") lines += Line(value.key, value.value);
  }
  return lines;
}

StudyRecording LookAt(const StudyFile& study, const StudyStream& stream, const fs::path& path) {
  const std::string key = "streams." + stream.name + ".dataset";
  if (!IsThere(path)) {
    throw InputError(study.file, stream.line, key,
                     path.string() + " does not exist; expected a recording (--data names the " +
                         "folder that recordings are in)");
  }
  RecordingOptions options;
  options.cameras = stream.cameras;
  const Recording recording = LoadRecording(path, options);
  const bool from_truth = stream.init == "groundtruth" || stream.init == "drawn";
  if (from_truth && !recording.truth) {
    throw InputError(study.file, stream.line, key,
                     path.string() + " has no truth to start from; expected init: rest or auto");
  }
  return {.path = path,
          .fingerprint = recording.fingerprint,
          .has_images = recording.vision == Vision::kImages,
          .frames = static_cast<int>(recording.FrameStamps().size()),
          .rig = recording.rig};
}

/// Makes the grid, stream by stream.
class Planner {
 public:
  Planner(StudyFile study, const fs::path& data, const StudyRecordings& known)
      : data_(data), known_(known) {
    plan_.study = std::move(study);
  }

  StudyPlan Make() {
    for (StudyStream& stream : plan_.study.streams) {
      MakePathsAbsolute(study().file, data_, &stream);
    }
    if (study().skip_missing) SkipMissing();
    for (std::size_t i = 0; i < study().streams.size(); ++i) AddStream(static_cast<int>(i));
    if (plan_.runs.empty()) throw InputError(study().file, 0, "", "has no run: the grid is empty");
    return std::move(plan_);
  }

 private:
  [[nodiscard]] const StudyFile& study() const { return plan_.study; }

  void AddStream(int index) {
    const StudyStream& stream = study().streams[static_cast<std::size_t>(index)];
    if (stream.simulated()) {
      LookAtSimulation(stream);
    } else {
      LookAtRecording(stream);
    }
    stream_lines_ = stream.simulated() ? SimulatedLines(stream, 0) : RecordedLines(stream);
    for (std::size_t p = 0; p < study().perturbations.size(); ++p) {
      for (std::size_t s = 0; s < study().settings.size(); ++s) {
        AddCells(index, static_cast<int>(s), static_cast<int>(p));
      }
    }
  }

  void LookAtSimulation(const StudyStream& stream) {
    const std::vector<std::string>& presets = SimulationPresetNames();
    if (std::find(presets.begin(), presets.end(), stream.simulate) == presets.end()) {
      throw InputError(study().file, stream.line, "streams." + stream.name + ".simulate",
                       "unknown preset '" + stream.simulate + "'" +
                           DidYouMean(stream.simulate, presets) + "; see duet simulate --list");
    }
    ConfigSources sources;
    const SimulationOptions options = SimulationOf(study(), stream, 1, &sources);
    if (options.duration_s <= 0.0) {  // not every motion has an end of its own
      try {
        (void)MakeScenario(options, /*textures=*/false);
      } catch (const InputError& error) {
        throw InputError(study().file, stream.line, "streams." + stream.name, error.what());
      }
    }
    const double rate_hz = options.camera_rate_hz;
    frames_ = static_cast<int>(options.duration_s * rate_hz) + 1;
    rig_ = TrueRigOf(options);
  }

  void SkipMissing() {
    std::vector<StudyStream>& streams = plan_.study.streams;
    std::vector<std::string> left_out;
    std::erase_if(streams, [&](const StudyStream& stream) {
      const bool missing =
          !stream.simulated() && !known_.contains(RecordingKey(stream)) && !IsThere(stream.dataset);
      if (missing) left_out.push_back(stream.dataset);
      return missing;
    });
    if (streams.empty()) {
      throw InputError(study().file, 0, "streams",
                       "none of the recordings is there; --data names the folder that they are in");
    }
    for (const std::string& path : left_out) LOG(WARNING) << path << " is not there and left out";
  }

  void LookAtRecording(const StudyStream& stream) {
    const fs::path path = stream.dataset;
    const std::string key = RecordingKey(stream);
    const auto found = known_.find(key);
    plan_.recordings[key] = found != known_.end() && found->second.path == path
                                ? found->second
                                : LookAt(study(), stream, path);
    frames_ = plan_.recordings[key].frames;
    rig_ = plan_.recordings[key].rig;
  }

  static bool Draws(const StudyStream& stream, const CalibrationPriors& priors) {
    const ToldErrors& told = priors.told_errors;
    const bool draws_told = told.T_g != 0.0 || told.T_s != 0.0 || told.T_a != 0.0 ||
                            told.p_CB_m != 0.0 || told.R_CB_rad != 0.0 ||
                            told.intrinsics_px != 0.0 || told.distortion != 0.0 ||
                            told.distortion_share != 0.0 || told.t_d_s != 0.0 || told.t_r_s != 0.0;
    return stream.simulated() || stream.jitter_px > 0.0 || stream.init == "drawn" || draws_told;
  }

  void AddCells(int index, int setting, int perturbation) {
    const StudyStream& stream = study().streams[static_cast<std::size_t>(index)];
    PlannedRun cell;
    cell.stream = index;
    cell.setting = setting;
    cell.perturbation = perturbation;
    cell.draw_seed = 1;
    for (const std::string& estimator : study().estimators) {
      cell.estimator = estimator;
      RequireToldIsPossible(plan_, cell, rig_);
      ConfigSources sources = SourcesOfRun(plan_, cell);
      Configuration configuration;
      configuration.Read(&sources);
      const bool draws = Draws(stream, configuration.shared.calibration);
      int seeds = study().seeds.last - study().seeds.first + 1;
      // Seeds of a recording without a start of their own would repeat what is there.
      if (!draws) seeds = std::min(seeds, static_cast<int>(stream.starts_s.size()));
      const std::string settings = RunSettingsSha256(sources.values(), estimator);
      for (int k = 0; k < seeds; ++k) {
        cell.seed = study().seeds.first + k;
        AddCell(cell, k, draws, settings);
      }
    }
  }

  /// `draws`: something is drawn with the seed, for the input or for the estimator.
  void AddCell(PlannedRun cell, int index_of_seed, bool draws, const std::string& settings) {
    const StudyStream& stream = plan_.StreamOf(cell);
    // Where the seed moves the pixels, it moves nothing else; of a recording it may decide nothing.
    cell.draw_seed = stream.jitter_px > 0.0 ? stream.simulation_seed.value_or(1)
                     : draws                ? OwnSeed(cell.seed)
                                            : 1;
    cell.planned_stream = InputFor(cell);
    const PlannedStream& input = plan_.InputOf(cell);
    cell.determined_by = Line("duet run", "1") + Line("stream", input.id) +
                         Line("estimator", cell.estimator) + Line("settings_sha256", settings) +
                         Line("init", stream.init) + Line("seed", std::to_string(cell.draw_seed));
    if (!stream.simulated()) {
      const std::size_t starts = stream.starts_s.size();
      cell.start_s = stream.starts_s[static_cast<std::size_t>(index_of_seed) % starts];
      cell.determined_by += Line("start_s", FormatNumber(cell.start_s)) +
                            Line("duration_s", FormatNumber(stream.duration_s));
    }
    cell.id = StudyId(cell.determined_by);
    plan_.runs.push_back(std::move(cell));
  }

  /// A seed of the grid as the stream has it: each stream draws its own noise and errors, for pairs
  /// of several streams to be independent. By what the stream is, so that its name and place and
  /// the other streams change nothing.
  [[nodiscard]] int OwnSeed(int seed) const {
    const std::string hash = Sha256Hex(stream_lines_ + Line("seed", std::to_string(seed)));
    return static_cast<int>(std::stoull(hash.substr(0, kSeedDigits), nullptr, 16) % kSeeds);
  }

  int InputFor(const PlannedRun& cell) {
    const StudyStream& stream = plan_.StreamOf(cell);
    PlannedStream input;
    input.stream = cell.stream;
    input.frames = frames_;
    if (stream.simulated()) {
      input.simulation_seed = stream.simulation_seed.value_or(OwnSeed(cell.seed));
    }
    if (stream.jitter_px > 0.0) input.jitter_seed = cell.seed;
    const auto key = std::make_tuple(cell.stream, input.simulation_seed, input.jitter_seed);
    const auto found = inputs_.find(key);
    if (found != inputs_.end()) return found->second;

    input.determined_by =
        stream.simulated() ? SimulatedLines(stream, input.simulation_seed) : RecordedLines(stream);
    if (stream.jitter_px > 0.0) {
      if (!stream.simulated()) input.base_id = StudyId(input.determined_by);
      input.determined_by += Line("jitter_px", FormatNumber(stream.jitter_px)) +
                             Line("jitter_seed", std::to_string(input.jitter_seed));
    }
    input.id = StudyId(input.determined_by);
    plan_.streams.push_back(std::move(input));
    const int number = static_cast<int>(plan_.streams.size()) - 1;
    inputs_[key] = number;
    return number;
  }

  std::string SimulatedLines(const StudyStream& stream, int seed) const {
    ConfigSources sources;
    const SimulationOptions options = SimulationOf(study(), stream, seed, &sources);
    return Line("duet stream", "1") + SimulationLines(sources, options);
  }

  std::string RecordedLines(const StudyStream& stream) const {
    const StudyRecording& recording = plan_.recordings.at(RecordingKey(stream));
    std::string lines = Line("duet stream", "1") + Line("recording", recording.fingerprint);
    for (const int camera : stream.cameras) lines += Line("camera", std::to_string(camera));
    if (recording.has_images) {
      Configuration configuration;
      lines += TrackingLines(SourcesOfTracking(study(), stream, &configuration));
    }
    return lines;
  }

  StudyPlan plan_;
  const fs::path data_;
  const StudyRecordings& known_;
  // Of the stream that is being added:
  int frames_ = 0;
  std::string stream_lines_;           // what it is, without a seed
  std::optional<RigCalibration> rig_;  // where it is known
  std::map<std::tuple<int, int, int>, int> inputs_;
};

}  // namespace

void MakePathsAbsolute(const fs::path& study_file, const fs::path& data, StudyStream* stream) {
  if (!stream->simulated()) {
    fs::path path = stream->dataset;
    if (path.is_relative()) path = (data.empty() ? study_file.parent_path() : data) / path;
    stream->dataset = fs::absolute(path).lexically_normal().string();
  }
  const std::set<std::string> paths = {"simulation.sensors", "simulation.imu",
                                       "simulation.trajectory"};
  for (StudyKey& key : stream->set) {
    if (paths.contains(key.key)) key.value.scalar = BesideStudy(study_file, key.value.scalar);
  }
}

std::string RecordingKey(const StudyStream& stream) {
  std::string key = stream.dataset + " [";
  for (const int camera : stream.cameras) {
    key += (key.back() == '[' ? "" : ", ") + std::to_string(camera);
  }
  return key + "]";
}

std::vector<int> StudyPlan::Distinct() const {
  std::set<std::string> seen;
  std::set<int> inputs;
  std::vector<int> first;
  std::vector<int> rest;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!seen.insert(runs[i].id).second) continue;
    const bool opens = inputs.insert(runs[i].planned_stream).second;
    (opens ? first : rest).push_back(static_cast<int>(i));
  }
  first.insert(first.end(), rest.begin(), rest.end());
  return first;
}

StudyPlan MakeStudyPlan(StudyFile study, const fs::path& data, const StudyRecordings& known) {
  return Planner(std::move(study), data, known).Make();
}

SimulationOptions SimulationOf(const StudyFile& study, const StudyStream& stream, int seed,
                               ConfigSources* sources) {
  SimulationOptions options = SimulationPreset(stream.simulate);
  AddKeys(stream.set, sources);
  sources->AddText("simulation:\n  seed: " + std::to_string(seed) + "\n", "stream " + stream.name);
  sources->Read("simulation", &options);
  sources->CheckAllKeysUsed();
  options.sensors = BesideStudy(study.file, options.sensors);
  options.imu = BesideStudy(study.file, options.imu);
  options.trajectory = BesideStudy(study.file, options.trajectory);
  return options;
}

ConfigSources SourcesOfTracking(const StudyFile& study, const StudyStream& stream,
                                Configuration* configuration) {
  ConfigSources sources;
  AddKeys(study.set, &sources);
  AddKeys(stream.set, &sources);
  configuration->Read(&sources);
  return sources;
}

ConfigSources SourcesOfRun(const StudyPlan& plan, const PlannedRun& run) {
  const StudyFile& study = plan.study;
  const StudyStream& stream = plan.StreamOf(run);
  ConfigSources sources;
  if (stream.simulated()) {
    // What a simulation's pixels are like is told as truly as its IMU's noise.
    ConfigSources of_simulation;
    const SimulationOptions options = SimulationOf(study, stream, 1, &of_simulation);
    sources.AddText("shared:\n  pixel_noise_px: " +
                        FormatNumber(options.noise_scale * options.pixel_noise_px) + "\n",
                    "stream " + stream.name);
  }
  for (const StudyKey& key : study.set) {
    if (!IsOfFrontend(key)) sources.AddKey(key.key, key.value, key.file);
  }
  AddChange(study.settings[static_cast<std::size_t>(run.setting)], run.estimator, &sources);
  AddChange(study.perturbations[static_cast<std::size_t>(run.perturbation)], run.estimator,
            &sources);
  sources.AddText(
      "shared:\n  calibration:\n    told_errors_seed: " + std::to_string(run.draw_seed) + "\n",
      "seed of the run");
  return sources;
}

std::string RunSettingsSha256(const std::vector<ResolvedValue>& values,
                              const std::string& estimator) {
  std::vector<std::string> lines;
  for (const ResolvedValue& value : values) {
    const std::string section = value.key.substr(0, value.key.find('.'));
    const bool counts = section == "shared" || section == "initialization" ||
                        section == "evaluation" || section == estimator;
    if (counts && value.key != kToldErrorsSeed) lines.push_back(Line(value.key, value.value));
  }
  std::sort(lines.begin(), lines.end());
  Sha256 sha256;
  for (const std::string& line : lines) sha256.Update(line);
  return sha256.Finish();
}

std::string StudyId(const std::string& determined_by) {
  return Sha256Hex(determined_by).substr(0, kIdDigits);
}

}  // namespace duet
