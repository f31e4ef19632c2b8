#include "common/dataset/kalibr.h"

#include <optional>

#include "common/support/input_error.h"

namespace duet {
namespace {

void PassOver(YamlMap* map, std::initializer_list<const char*> keys) {
  for (const char* key : keys) (void)map->Has(key);
}

CameraSensor ReadCamera(YamlMap map, const std::optional<Pose>& previous_T_CB) {
  PassOver(&map, {"cam_overlaps", "rostopic", "T_cam_imu", "T_cn_cnm1"});
  Pose T_CB;
  if (map.Has("T_cam_imu")) {
    T_CB = ReadTransform(&map, "T_cam_imu");
  } else if (map.Has("T_cn_cnm1") && previous_T_CB) {
    T_CB = ReadTransform(&map, "T_cn_cnm1") * *previous_T_CB;
  } else {
    map.Fail("T_cam_imu",
             "is missing; expected the file of a camera-IMU calibration (camchain-imucam)");
  }
  CameraSensor sensor;
  sensor.calibration.R_CB = T_CB.R;
  sensor.calibration.p_CB = T_CB.p;
  sensor.calibration.model = ReadCameraModel(&map, "distortion_coeffs");
  sensor.t_d_s = map.NumberOr("timeshift_cam_imu", 0.0, {-10.0, 10.0});
  (void)map.UnknownKeys();
  return sensor;
}

}  // namespace

std::vector<CameraSensor> ReadKalibrCameras(std::string_view yaml, const std::string& file) {
  const YamlNode root = ParseYaml(yaml, file);
  YamlMap map(root, file);
  std::vector<CameraSensor> cameras;
  std::optional<Pose> T_CB;
  while (map.Has("cam" + std::to_string(cameras.size()))) {
    cameras.push_back(ReadCamera(map.Map("cam" + std::to_string(cameras.size())), T_CB));
    T_CB = Pose{cameras.back().calibration.R_CB, cameras.back().calibration.p_CB};
  }
  if (cameras.empty()) map.Fail("cam0", "is missing; expected Kalibr's cameras cam0, cam1, ...");
  return cameras;
}

ImuSensor ReadKalibrImu(std::string_view yaml, const std::string& file) {
  const YamlNode root = ParseYaml(yaml, file);
  YamlMap top(root, file);
  YamlMap map = top.Has("imu0") ? top.Map("imu0") : top;
  PassOver(&map, {"rostopic", "model", "T_i_b", "time_offset"});
  ImuSensor sensor;
  sensor.noise = ReadImuNoise(&map);
  sensor.rate_hz = map.NumberOr("update_rate", 0.0, {1e-3, 1e6});
  (void)map.UnknownKeys();
  return sensor;
}

}  // namespace duet
