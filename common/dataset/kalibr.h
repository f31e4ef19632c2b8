#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/asl_sensors.h"

namespace duet {

/// Kalibr's camchain.yaml (cam0, cam1, ...): T_cam_imu (or T_cn_cnm1 after a camera that has it),
/// pinhole intrinsics, radtan or equidistant distortion, resolution, timeshift_cam_imu (t_imu =
/// t_cam + shift: our t_d). Keys about topics and overlaps are passed over.
[[nodiscard]] std::vector<CameraSensor> ReadKalibrCameras(std::string_view yaml,
                                                          const std::string& file);

/// Kalibr's imu.yaml: densities, random walks and update_rate, at the top or below imu0.
[[nodiscard]] ImuSensor ReadKalibrImu(std::string_view yaml, const std::string& file);

}  // namespace duet
