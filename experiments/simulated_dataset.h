#pragma once

#include <filesystem>
#include <string>

#include "common/config/config_sources.h"
#include "experiments/simulation/render/render_options.h"
#include "experiments/simulation/simulator.h"

namespace duet {

/// A simulated data set: what is simulated, how images are made, what is written.
struct SimulatedDatasetOptions {
  SimulationOptions simulation;
  RenderOptions render;
  bool images = false;
  bool tracks = true;
  bool quiet = false;
};

/// Reads the sections simulation, told_errors (which calibration is told wrongly, and by how much)
/// and render over the options' values.
void ReadSimulatedDatasetOptions(ConfigSources* sources, SimulatedDatasetOptions* options);

/// Simulates and writes the data set, complete or absent, with `settings_yaml` as simulation.yaml,
/// and says on stdout what it is. Returns the exit status (kDone, kInterrupted). Throws InputError
/// and OutputError.
int WriteSimulatedDataset(const SimulatedDatasetOptions& options, const std::string& settings_yaml,
                          const std::filesystem::path& folder);

}  // namespace duet
