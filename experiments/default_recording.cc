#include "experiments/default_recording.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <thread>

#include "common/support/input_error.h"
#include "experiments/build_info.h"
#include "experiments/simulated_dataset.h"
#include "experiments/simulation/render/render_presets.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPreset = "easy_room";
constexpr double kDuration_s = 20.0;

// The value of an environment variable; empty where there is none.
std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

fs::path CacheFolder() {
  if (const std::string told = Environment("DUET_CACHE"); !told.empty()) return told;
  if (const std::string xdg = Environment("XDG_CACHE_HOME"); !xdg.empty()) {
    return fs::path(xdg) / "duet";
  }
  if (const std::string home = Environment("HOME"); !home.empty()) {
    return fs::path(home) / ".cache" / "duet";
  }
  return fs::temp_directory_path() / "duet";
}

DefaultRecording FindOrMakeDefaultRecording(int cameras, std::uint64_t seed, bool quiet) {
  const RenderPreset& preset = *FindRenderPreset(kPreset);
  SimulatedDatasetOptions options;
  options.simulation = preset.simulation;
  options.render = preset.render;
  options.simulation.duration_s = kDuration_s;
  options.simulation.cameras = cameras;
  if (seed > 2'000'000'000) {
    throw InputError("", 0, "--seed", "expected at most 2000000000 for a simulation");
  }
  if (seed != 0) options.simulation.seed = static_cast<int>(seed);
  options.render.seed = options.simulation.seed;
  options.images = true;
  options.tracks = false;
  options.quiet = quiet;
  ConfigSources sources;
  ReadSimulatedDatasetOptions(&sources, &options);
  const std::string& commit = GetBuildInfo().commit;
  const std::string name =
      std::string(kPreset) + "-" + sources.SettingsSha256().substr(0, 12) + "-" + commit;
  // Any number of threads makes the same images.
  options.render.threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
  DefaultRecording recording{.folder = CacheFolder() / name};
  if (fs::exists(recording.folder)) {
    // Changed sources may render otherwise.
    if (commit != "unknown" && !commit.ends_with("-dirty")) return recording;
    fs::remove_all(recording.folder);
  }
  try {
    recording.interrupted =
        WriteSimulatedDataset(options, sources.ResolvedYaml(), recording.folder).interrupted;
  } catch (const OutputError&) {
    // Another run may have made it meanwhile.
    if (!fs::exists(recording.folder)) throw;
  }
  return recording;
}

}  // namespace duet
