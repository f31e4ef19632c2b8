#include <gflags/gflags.h>

#include <cstdio>

#include "common/config/config_sources.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/record_folder.h"
#include "experiments/simulation/write_recording.h"

DEFINE_string(preset, "room_easy", "Settings to begin with; --set changes single ones.");

namespace duet {
namespace {

SimulationOptions ReadOptions(const CommandLine& line, ConfigSources* sources) {
  SimulationOptions options = SimulationPreset(FLAGS_preset);
  for (const std::string& file : line.All("config")) sources->AddFile(file);
  for (const std::string& assignment : line.All("set")) {
    sources->AddOverride("simulation." + assignment);
  }
  if (line.Given("seed")) {
    sources->AddOverride("simulation.seed=" + std::to_string(FLAGS_seed));
  }
  sources->Read("simulation", &options);
  sources->CheckAllKeysUsed();
  return options;
}

int RunSimulate(const CommandLine& line) {
  RequireAbsent(FLAGS_out);
  ConfigSources sources;
  const SimulationOptions options = ReadOptions(line, &sources);
  OutputFolder folder(FLAGS_out);
  const SimulatedRecording simulated = Simulate(options);
  WriteSimulatedRecording(simulated, folder.path());
  WriteTextFile(folder.path() / "simulation.yaml", sources.ResolvedYaml());
  folder.Commit();
  std::printf("%zu frames of %d camera%s and %zu IMU samples in %s\n", simulated.frames.size(),
              options.cameras, options.cameras == 1 ? "" : "s", simulated.imu.size(),
              folder.target().c_str());
  return kDone;
}

}  // namespace

Command SimulateCommand() {
  return {
      .name = "simulate",
      .summary = "Simulates a recording: IMU, point tracks and their truth.",
      .description =
          "Writes an ASL folder with what a rig that moves through a room would have measured: "
          "imu0, tracks<k> in place of images, state_groundtruth_estimate0, and truth.yaml with "
          "the true calibration (the sensor files hold what an estimator is told). Everything "
          "random comes from --seed; the same settings give the same bytes. simulation.yaml "
          "beside mav0 holds every setting with its origin and can be given as --config.",
      .example = "duet simulate --preset room_easy --seed 7 --set duration_s=60 --out sim7",
      .flags = {{.name = "out", .value = "DIR", .required = true},
                {.name = "preset", .value = "NAME", .choices = SimulationPresetNames()},
                {.name = "config", .value = "FILE", .repeatable = true},
                {.name = "set", .value = "KEY=VALUE", .repeatable = true},
                {.name = "seed", .value = "N"}},
      .run = RunSimulate};
}

}  // namespace duet
