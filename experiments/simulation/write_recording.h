#pragma once

#include <filesystem>
#include <string>

#include "common/dataset/recording.h"
#include "experiments/simulation/simulator.h"

namespace duet {

/// A simulated recording as the readers would give it: sensors as *told*, tracks in place of
/// images, the truth with velocities and biases.
[[nodiscard]] Recording ToRecording(const SimulatedRecording& simulated);

/// The true calibration and noise as YAML, for whoever judges calibration: the keys of
/// imu0/sensor.yaml and tracks<k>/sensor.yaml, cameras below cam<k>.
[[nodiscard]] std::string TruthYaml(const SimulatedRecording& simulated);

/// ASL folder: mav0/imu0, mav0/tracks<k> (where `tracks`), mav0/state_groundtruth_estimate0,
/// mav0/recording.yaml and mav0/truth.yaml.
/// `folder` must not hold mav0 yet. Throws OutputError.
void WriteSimulatedRecording(const SimulatedRecording& simulated,
                             const std::filesystem::path& folder, bool tracks = true);

}  // namespace duet
