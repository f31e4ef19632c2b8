#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "common/config/config_sources.h"
#include "common/config/yaml_node.h"
#include "common/support/input_error.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/record_folder.h"
#include "experiments/seed_range.h"
#include "experiments/simulated_dataset.h"
#include "experiments/simulation/euroc_sequences.h"
#include "experiments/simulation/render/render_presets.h"
#include "experiments/simulation/scenario.h"
#include "experiments/simulation/trajectory_library.h"
#include "experiments/simulation/world/world_library.h"

DEFINE_string(preset, "room_easy",
              "Settings to begin with (--list names them); the other flags and --set change single "
              "ones.");
DEFINE_string(world, "", "Where: room, bare_room, hall, street, or box (points without surfaces).");
DEFINE_string(trajectory, "",
              "Along what: a name (--list) or a truth file in EuRoC's or TUM's form.");
DEFINE_string(sensors, "",
              "The rig: a file like configs/sensors/euroc_like.yaml, or a recording's folder.");
DEFINE_string(imu, "",
              "A recording whose IMU is taken as it is; vision is simulated along its truth.");
DEFINE_bool(images, false, "Render images, in place of simulated tracks.");
DEFINE_bool(point_tracks, false, "Write simulated tracks beside the images too.");
DEFINE_double(picture, 0.0,
              "One image only, of the first camera this long after the first frame, as the file "
              "--out (.png, .jpg) [s].");
DEFINE_string(seeds, "", "A..B: a data set for each seed, in folders seed-<k> of --out.");
DEFINE_bool(list, false, "Print presets, trajectories and worlds, and end.");

namespace duet {
namespace {

std::vector<std::string> PresetNames() {
  std::vector<std::string> names = SimulationPresetNames();
  for (const RenderPreset& preset : RenderPresets()) names.push_back(preset.name);
  return names;
}

void PrintList() {
  std::string text = "Presets (--preset)\n";
  for (const std::string& name : SimulationPresetNames()) text += "  " + name + "\n";
  for (const RenderPreset& preset : RenderPresets()) {
    text += "  " + preset.name + ": " + preset.summary + "\n";
  }
  text += "\nWorlds (--world)\n  box: points without surfaces, for tracks alone\n";
  for (const std::string& name : WorldNames()) text += "  " + name + "\n";
  text += "\nTrajectories (--trajectory)\n" + NamedMotionsText();
  text += "\nFlights like EuRoC's sequences, and the thesis's table 7.1\n" + EurocSequencesText();
  std::fputs(text.c_str(), stdout);
}

// Keys given on the command line that the scenario takes from elsewhere.
void RefuseIneffective(const ConfigSources& sources, const SimulationOptions& options) {
  std::vector<std::string> from_sensors = {"t_d_s",
                                           "t_r_s",
                                           "gyroscope_density",
                                           "accelerometer_density",
                                           "gyroscope_random_walk",
                                           "accelerometer_random_walk",
                                           "gravity_m_per_s2"};
  const std::vector<std::string> from_imu = {"trajectory",
                                             "rest_s",
                                             "b_g_rad_per_s",
                                             "b_a_m_per_s2",
                                             "imu_rate_hz",
                                             "gyroscope_density",
                                             "accelerometer_density",
                                             "gyroscope_random_walk",
                                             "accelerometer_random_walk",
                                             "gravity_m_per_s2",
                                             "imu_jitter_s",
                                             "imu_jitter_is_stamped",
                                             "imu_drop_share",
                                             "gyroscope_range_rad_per_s",
                                             "accelerometer_range_m_per_s2"};
  const auto refuse = [&](const std::vector<std::string>& keys, const std::string& why) {
    for (const ResolvedValue& value : sources.values()) {
      if (value.origin != "command line") continue;
      for (const std::string& key : keys) {
        if (value.key != "simulation." + key) continue;
        throw InputError("", 0, value.key, "has no effect " + why);
      }
    }
  };
  if (!options.sensors.empty()) refuse(from_sensors, "beside sensors, which tell it");
  if (!options.imu.empty()) refuse(from_imu, "beside imu: the recorded IMU is taken as it is");
  if (options.imu.empty()) refuse({"imu_apply_time_shift", "imu_apply_rotation"}, "without imu");
  if (IsTrajectoryFile(options.trajectory)) refuse({"rest_s"}, "on a truth's trajectory");
  if (options.world == kBoxWorld) refuse({"world_scale", "moving_bodies"}, "in world box");
}

SimulatedDatasetOptions ReadOptions(const CommandLine& line, ConfigSources* sources) {
  SimulatedDatasetOptions options;
  if (const RenderPreset* preset = FindRenderPreset(FLAGS_preset)) {
    options.simulation = preset->simulation;
    options.render = preset->render;
  } else {
    options.simulation = SimulationPreset(FLAGS_preset);
  }
  // A truth decides about its length itself.
  if (!FLAGS_imu.empty() || IsTrajectoryFile(FLAGS_trajectory)) {
    options.simulation.duration_s = 0.0;
  }
  for (const std::string& file : line.All("config")) sources->AddFile(file);
  for (const std::string& assignment : line.All("set")) {
    const bool has_section = assignment.starts_with("render.") ||
                             assignment.starts_with("simulation.") ||
                             assignment.starts_with("told_errors.");
    sources->AddOverride(has_section ? assignment : "simulation." + assignment);
  }
  const auto set_text = [&](const char* flag, const std::string& value) {
    if (!line.Given(flag)) return;
    sources->AddOverride("simulation." + std::string(flag) + "=" + QuotedYaml(value));
  };
  // Paths absolute, so that simulation.yaml can be used from anywhere.
  const auto absolute = [](const std::string& path) {
    return path.empty() ? path : std::filesystem::absolute(path).lexically_normal().string();
  };
  set_text("world", FLAGS_world);
  set_text("trajectory",
           IsTrajectoryFile(FLAGS_trajectory) ? absolute(FLAGS_trajectory) : FLAGS_trajectory);
  set_text("sensors", absolute(FLAGS_sensors));
  set_text("imu", absolute(FLAGS_imu));
  if (line.Given("seed")) {
    sources->AddOverride("simulation.seed=" + std::to_string(FLAGS_seed));
    sources->AddOverride("render.seed=" + std::to_string(FLAGS_seed));
  }
  options.render.threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
  if (line.Given("threads")) {
    sources->AddOverride("render.threads=" + std::to_string(FLAGS_threads));
  }
  ReadSimulatedDatasetOptions(sources, &options);
  sources->CheckAllKeysUsed();
  RefuseIneffective(*sources, options.simulation);
  options.images = FLAGS_images;
  options.tracks = !FLAGS_images || FLAGS_point_tracks;
  return options;
}

int RunSimulate(const CommandLine& line) {
  if (FLAGS_list) {
    PrintList();
    return kDone;
  }
  if (FLAGS_out.empty()) throw InputError("", 0, "--out", "expected the folder to write");
  RequireAbsent(FLAGS_out);
  ConfigSources sources;
  SimulatedDatasetOptions options = ReadOptions(line, &sources);
  options.quiet = FLAGS_quiet;
  if (line.Given("picture")) {
    if (line.Given("seeds")) {
      throw InputError("", 0, "--seeds", "has no effect beside --picture; expected --seed");
    }
    WritePicture(options, FLAGS_picture, FLAGS_out);
    return kDone;
  }
  const auto write = [](const SimulatedDatasetOptions& of, const ConfigSources& settings,
                        const std::filesystem::path& folder) {
    const WrittenDataset written = WriteSimulatedDataset(of, settings.ResolvedYaml(), folder);
    std::fputs(written.summary.c_str(), stdout);
    return written.interrupted ? kInterrupted : kDone;
  };
  if (FLAGS_seeds.empty()) return write(options, sources, FLAGS_out);
  const SeedRange seeds = ParseSeeds(FLAGS_seeds);
  for (int seed = seeds.first; seed <= seeds.last; ++seed) {
    ConfigSources of_seed;
    of_seed.AddText(sources.ResolvedYaml(), "simulation.yaml");
    of_seed.AddOverride("simulation.seed=" + std::to_string(seed));
    of_seed.AddOverride("render.seed=" + std::to_string(seed));
    ReadSimulatedDatasetOptions(&of_seed, &options);
    const auto folder = std::filesystem::path(FLAGS_out) / ("seed-" + std::to_string(seed));
    if (const int status = write(options, of_seed, folder); status != kDone) return status;
  }
  return kDone;
}

}  // namespace

Command SimulateCommand() {
  return {
      .name = "simulate",
      .summary = "Simulates a recording: IMU, point tracks or rendered images, and their truth.",
      .description =
          "Writes an ASL folder with what a rig that moves through a world would have measured: "
          "imu0, tracks<k> or (--images) rendered images cam<k>, state_groundtruth_estimate0, and "
          "truth.yaml with the true calibration (the sensor files hold what an estimator is told). "
          "With --imu the IMU is a recording's own and vision is simulated along its truth. "
          "Everything random comes from --seed; the same settings give the same bytes. "
          "simulation.yaml beside mav0 holds every setting with its origin and can be given as "
          "--config. Keys for --set: simulation.KEY (or KEY), render.KEY, told_errors.KEY.",
      .example =
          "duet simulate --preset easy_room --images --seed 7 --set duration_s=30 --out sim7",
      .flags = {{.name = "out", .value = "DIR"},
                {.name = "preset", .value = "NAME", .choices = PresetNames()},
                {.name = "world", .value = "NAME"},
                {.name = "trajectory", .value = "NAME|FILE"},
                {.name = "sensors", .value = "FILE"},
                {.name = "imu", .value = "DIR"},
                {.name = "images"},
                {.name = "point-tracks"},
                {.name = "picture", .value = "S", .without = "the whole data set"},
                {.name = "config", .value = "FILE", .repeatable = true},
                {.name = "set", .value = "KEY=VALUE", .repeatable = true},
                {.name = "seed", .value = "N", .without = "1"},
                {.name = "seeds", .value = "A..B"},
                {.name = "threads", .value = "N", .without = "all cores"},
                {.name = "list"},
                {.name = "quiet"}},
      .run = RunSimulate};
}

}  // namespace duet
