#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/yaml_map.h"
#include "common/geometry/se3.h"
#include "common/imu/imu_model.h"
#include "common/measurement/calibration.h"

namespace duet {

inline constexpr double kStandardGravity = 9.81;  ///< m/s^2, where a recording is silent

/// What imu0/sensor.yaml tells.
struct ImuSensor {
  ImuNoise noise;                     ///< no defaults: missing is an error
  double rate_hz = 0.0;               ///< 0: not told
  double gravity = kStandardGravity;  ///< optional key gravity_m_per_s2
  ImuCalibration calibration;         ///< optional keys T_g, T_s, T_a (9 numbers by rows)
};

/// What cam<k>/sensor.yaml or tracks<k>/sensor.yaml tells.
struct CameraSensor {
  CameraCalibration calibration;  ///< of T_BS, inverted once, here
  /// T_BS as told: written again with the same digits, so that a replay has the same bits.
  std::optional<Eigen::Matrix4d> T_BS;
  double rate_hz = 0.0;  ///< 0: not told
  double t_d_s = 0.0;    ///< optional key time_offset_s: taken at stamp + t_d
  double t_r_s = 0.0;    ///< optional key readout_time_s
  bool readout_by_columns = false;
  /// Of a track stream, where known: how it was made.
  std::string frontend_settings_sha256;
  std::string image_set_sha256;
};

/// Read sensor.yaml in ASL's form, with or without OpenCV's line "%YAML:1.0". Keys that they do not
/// know are appended to `unknown_keys` ("FILE: key"), misspelt ones are errors.
[[nodiscard]] ImuSensor ReadImuSensor(std::string_view yaml, const std::string& file,
                                      std::vector<std::string>* unknown_keys = nullptr);
[[nodiscard]] CameraSensor ReadCameraSensor(std::string_view yaml, const std::string& file,
                                            std::vector<std::string>* unknown_keys = nullptr);
/// The same of a map within a file.
[[nodiscard]] ImuSensor ReadImuSensor(YamlMap map,
                                      std::vector<std::string>* unknown_keys = nullptr);
[[nodiscard]] CameraSensor ReadCameraSensor(YamlMap map,
                                            std::vector<std::string>* unknown_keys = nullptr);
/// T_BS of any sensor (identity where the file has none).
[[nodiscard]] Pose ReadSensorPose(std::string_view yaml, const std::string& file);

/// The same as text; reading gives the same numbers again (extrinsics that do not come from T_BS to
/// rounding, because they are written as their inverse).
[[nodiscard]] std::string WriteImuSensor(const ImuSensor& sensor);
[[nodiscard]] std::string WriteCameraSensor(const CameraSensor& sensor);

/// One rig of its cameras. t_d and t_r are the rig's: their mean, InputError (naming `file`) where
/// cameras differ by more than a millisecond or in the direction of readout.
[[nodiscard]] RigCalibration MakeRig(const ImuCalibration& imu,
                                     const std::vector<CameraSensor>& cameras,
                                     const std::string& file);

/// The four densities, under the keys that ASL and Kalibr have in common; above zero.
[[nodiscard]] ImuNoise ReadImuNoise(YamlMap* map);

/// A 4x4 transform: ASL's {rows, cols, data} or Kalibr's four rows of four. InputError where it is
/// none, with how far its rotation is from one. Rounding (1e-3) is put right.
[[nodiscard]] Pose ReadTransform(YamlMap* map, const std::string& key);

/// A camera from "radial-tangential" (or "radtan") or "equidistant", its coefficients (k1 k2 t1 t2
/// [k3] or k1 k2 k3 k4), intrinsics fx fy ox oy and [width, height].
[[nodiscard]] CameraModel ReadCameraModel(YamlMap* map, const std::string& coefficients_key);

}  // namespace duet
