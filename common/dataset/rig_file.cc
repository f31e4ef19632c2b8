#include "common/dataset/rig_file.h"

#include <string>

#include "common/support/input_error.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

RigFile ReadFolder(const fs::path& folder) {
  const fs::path mav = fs::exists(folder / "mav0") ? folder / "mav0" : folder;
  RigFile rig;
  const fs::path imu = mav / "imu0" / "sensor.yaml";
  rig.imu = ReadImuSensor(ReadTextFile(imu), imu.string());
  for (std::size_t k = 0; k < 2 && rig.cameras.size() == k; ++k) {
    for (const char* kind : {"cam", "tracks"}) {
      const fs::path camera = mav / (kind + std::to_string(k)) / "sensor.yaml";
      if (!fs::exists(camera)) continue;
      rig.cameras.push_back(ReadCameraSensor(ReadTextFile(camera), camera.string()));
      break;
    }
  }
  if (rig.cameras.empty()) {
    throw InputError(mav.string(), 0, "",
                     "has no cam0/sensor.yaml; expected a recording's sensors");
  }
  return rig;
}

}  // namespace

RigFile ReadRigFile(const fs::path& path) {
  if (fs::is_directory(path)) return ReadFolder(path);
  const YamlNode root = ParseYaml(ReadTextFile(path), path.string());
  YamlMap map(root, path.string());
  RigFile rig;
  std::vector<std::string> unknown_keys;
  rig.imu = ReadImuSensor(map.Map("imu0"), &unknown_keys);
  rig.cameras.push_back(ReadCameraSensor(map.Map("cam0"), &unknown_keys));
  if (map.Has("cam1")) rig.cameras.push_back(ReadCameraSensor(map.Map("cam1"), &unknown_keys));
  for (const std::string& key : map.UnknownKeys())
    unknown_keys.push_back(path.string() + ": " + key);
  if (!unknown_keys.empty()) {
    throw InputError(path.string(), 0, "",
                     "unknown key (" + unknown_keys.front() +
                         "); expected imu0, cam0 and cam1 with "
                         "the keys of a sensor.yaml");
  }
  return rig;
}

}  // namespace duet
