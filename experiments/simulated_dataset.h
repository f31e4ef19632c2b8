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

struct WrittenDataset {
  bool interrupted = false;  ///< nothing is left of it then
  std::string summary;       ///< for a person: what it is, how the real IMU fits its truth
};

/// Simulates and writes the data set, complete or absent, with `settings_yaml` as simulation.yaml.
/// Throws InputError and OutputError.
[[nodiscard]] WrittenDataset WriteSimulatedDataset(const SimulatedDatasetOptions& options,
                                                   const std::string& settings_yaml,
                                                   const std::filesystem::path& folder);

/// One image of camera 0, `after_s` after the first frame, as `file` (.png, .jpg). Throws
/// InputError and OutputError.
void WritePicture(const SimulatedDatasetOptions& options, double after_s,
                  const std::filesystem::path& file);

/// The settings that a simulated data set was made with, from its simulation.yaml. Throws
/// InputError where it has none.
[[nodiscard]] SimulatedDatasetOptions ReadSimulationOf(const std::filesystem::path& dataset);

}  // namespace duet
