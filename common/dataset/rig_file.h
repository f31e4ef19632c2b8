#pragma once

#include <filesystem>
#include <vector>

#include "common/dataset/asl_sensors.h"

namespace duet {

/// The sensors of a rig without a recording.
struct RigFile {
  ImuSensor imu;
  std::vector<CameraSensor> cameras;  ///< one or two
};

/// Reads a YAML file with the maps imu0, cam0 and, of a stereo rig, cam1, each with the keys of the
/// sensor.yaml of that name (docs/formats.md), or, of a recording's folder, those sensor.yaml
/// files themselves. Unknown keys are errors in the one file, passed over in a recording. Throws
/// InputError.
[[nodiscard]] RigFile ReadRigFile(const std::filesystem::path& path);

}  // namespace duet
