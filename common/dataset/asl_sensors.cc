#include "common/dataset/asl_sensors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

using RowMajor4d = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr double kRotationTolerance = 1e-3;

YamlNode ParseSensor(std::string_view yaml, const std::string& file) {
  YamlNode root = ParseYaml(yaml, file);
  if (root.kind == YamlNode::Kind::kNull) throw InputError(file, 0, "", "is empty");
  return root;
}

/// Keys of ASL that carry nothing for us.
void PassOverCommonKeys(YamlMap* map) {
  for (const char* key : {"sensor_type", "comment", "T_BS", "rate_hz"}) (void)map->Has(key);
}

void CollectUnknownKeys(const YamlMap& map, std::vector<std::string>* unknown_keys) {
  const std::vector<std::string> keys = map.UnknownKeys();
  if (unknown_keys == nullptr) return;
  for (const std::string& key : keys) unknown_keys->push_back(map.file() + ": " + key);
}

Pose ReadPoseOrIdentity(YamlMap* map) {
  return map->Has("T_BS") ? ReadTransform(map, "T_BS") : Pose();
}

Eigen::Matrix3d ReadMatrix3Or(YamlMap* map, const std::string& key,
                              const Eigen::Matrix3d& value_if_missing) {
  if (!map->Has(key)) return value_if_missing;
  return Eigen::Map<const RowMajor3d>(map->Numbers(key, 9).data());
}

RowMajor4d ReadMatrix4(YamlMap* map, const std::string& key) {
  const YamlNode& node = map->Node(key);
  std::vector<double> numbers;
  if (node.kind == YamlNode::Kind::kMap) {
    YamlMap matrix = map->Map(key);
    if (matrix.Integer("rows") != 4 || matrix.Integer("cols") != 4) {
      map->Fail(key, "expected a matrix of 4 rows and 4 columns");
    }
    numbers = matrix.Numbers("data", 16);
  } else {
    for (const YamlNode& row : node.items) {
      const std::optional<std::vector<double>> values = AsNumbers(row);
      if (!values || values->size() != 4) break;
      numbers.insert(numbers.end(), values->begin(), values->end());
    }
    if (node.items.size() != 4 || numbers.size() != 16) {
      map->Fail(key, "expected a 4x4 matrix: rows, cols and data, or four rows of four numbers");
    }
  }
  return Eigen::Map<const RowMajor4d>(numbers.data());
}

/// The pose nearest to a matrix that is one but for rounding.
Pose RoundedPose(const Eigen::Matrix4d& T) {
  Pose pose;
  pose.R = Eigen::Quaterniond(NearestRotation(T.topLeftCorner<3, 3>())).normalized();
  pose.p = T.topRightCorner<3, 1>();
  return pose;
}

/// The pose that a matrix is; InputError for `key` where it is none.
Pose PoseOfMatrix(const YamlMap& map, const std::string& key, const Eigen::Matrix4d& T) {
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double deviation = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= kRotationTolerance)) {
    map.Fail(key, "is no rotation: R R' differs from the identity by " + FormatNumber(deviation) +
                      "; expected at most " + FormatNumber(kRotationTolerance));
  }
  if (R.determinant() < 0.0) {
    map.Fail(key, "is no rotation: its determinant is -1 (a reflection); expected +1");
  }
  if (!T.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-12)) {
    map.Fail(key, "is no rigid transform: expected 0 0 0 1 as the last row");
  }
  return RoundedPose(T);
}

void AppendKey(const char* key, const std::vector<double>& numbers, std::string* text) {
  *text += key;
  *text += ": [";
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) *text += ", ";
    AppendNumber(numbers[i], text);
  }
  *text += "]\n";
}

void AppendKey(const char* key, double number, std::string* text) {
  *text += key;
  *text += ": ";
  AppendNumber(number, text);
  *text += "\n";
}

void AppendTransform(const Eigen::Matrix4d& T, std::string* text) {
  *text += "T_BS:\n  rows: 4\n  cols: 4\n  data: [";
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      AppendNumber(T(row, column), text);
      if (row < 3 || column < 3) *text += column < 3 ? ", " : ",\n         ";
    }
  }
  *text += "]\n";
}

/// T_BS of a camera: as told where it still says the same, else the inverse of T_CB.
Eigen::Matrix4d SensorMatrix(const CameraSensor& sensor) {
  const CameraCalibration& camera = sensor.calibration;
  if (sensor.T_BS) {
    const Pose told = RoundedPose(*sensor.T_BS).Inverse();
    if (told.R.coeffs() == camera.R_CB.coeffs() && told.p == camera.p_CB) return *sensor.T_BS;
  }
  const Pose T_BC = Pose{camera.R_CB, camera.p_CB}.Inverse();
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = T_BC.R.toRotationMatrix();
  T.topRightCorner<3, 1>() = T_BC.p;
  return T;
}

void AppendMatrixUnless(const char* key, const Eigen::Matrix3d& matrix,
                        const Eigen::Matrix3d& preset, std::string* text) {
  if (matrix == preset) return;
  const RowMajor3d by_rows = matrix;
  AppendKey(key, std::vector<double>(by_rows.data(), by_rows.data() + 9), text);
}

}  // namespace

ImuNoise ReadImuNoise(YamlMap* map) {
  const NumberRange positive{1e-15, 1e3};  // a density of zero makes covariances singular
  ImuNoise noise;
  noise.gyroscope_density = map->Number("gyroscope_noise_density", positive);
  noise.gyroscope_random_walk = map->Number("gyroscope_random_walk", positive);
  noise.accelerometer_density = map->Number("accelerometer_noise_density", positive);
  noise.accelerometer_random_walk = map->Number("accelerometer_random_walk", positive);
  return noise;
}

Pose ReadTransform(YamlMap* map, const std::string& key) {
  return PoseOfMatrix(*map, key, ReadMatrix4(map, key));
}

CameraModel ReadCameraModel(YamlMap* map, const std::string& coefficients_key) {
  if (map->Text("camera_model") != "pinhole") {
    map->Fail("camera_model", "expected pinhole, got '" + map->Text("camera_model") + "'");
  }
  const std::string name = map->Text("distortion_model");
  DistortionModel model = DistortionModel::kRadialTangential;
  if (name == "equidistant") {
    model = DistortionModel::kEquidistant;
  } else if (name != "radial-tangential" && name != "radtan") {
    map->Fail("distortion_model",
              "expected radial-tangential, radtan or equidistant, got '" + name + "'");
  }
  std::vector<double> distortion = map->Numbers(coefficients_key);
  if (model == DistortionModel::kRadialTangential) {
    if (distortion.size() == 4) distortion.push_back(0.0);  // k3
    if (distortion.size() != 5) {
      map->Fail(coefficients_key, "expected k1 k2 t1 t2 [k3], 4 or 5 numbers, got " +
                                      std::to_string(distortion.size()));
    }
  } else if (distortion.size() != 4) {
    map->Fail(coefficients_key,
              "expected k1 k2 k3 k4, 4 numbers, got " + std::to_string(distortion.size()));
  }
  const std::vector<double> intrinsics = map->Numbers("intrinsics", 4);
  if (!(intrinsics[0] > 0.0) || !(intrinsics[1] > 0.0)) {
    map->Fail("intrinsics", "expected fx fy ox oy with focal lengths above 0 px");
  }
  const std::optional<std::vector<int>> size = AsIntegers(map->Node("resolution"));
  constexpr int kLargestImage = 100000;
  if (!size || size->size() != 2 || std::min((*size)[0], (*size)[1]) < 1 ||
      std::max((*size)[0], (*size)[1]) > kLargestImage) {
    map->Fail("resolution",
              "expected [width, height] in pixels, got " + Describe(map->Node("resolution")));
  }
  CameraModel::Parameters parameters(4 + static_cast<Eigen::Index>(distortion.size()));
  parameters << Eigen::Map<const Eigen::Vector4d>(intrinsics.data()),
      Eigen::Map<const Eigen::VectorXd>(distortion.data(),
                                        static_cast<Eigen::Index>(distortion.size()));
  return CameraModel(model, (*size)[0], (*size)[1], parameters);
}

ImuSensor ReadImuSensor(std::string_view yaml, const std::string& file,
                        std::vector<std::string>* unknown_keys) {
  const YamlNode root = ParseSensor(yaml, file);
  return ReadImuSensor(YamlMap(root, file), unknown_keys);
}

ImuSensor ReadImuSensor(YamlMap map, std::vector<std::string>* unknown_keys) {
  PassOverCommonKeys(&map);
  const Pose T_BS = ReadPoseOrIdentity(&map);
  if (T_BS.p.norm() > 1e-9 || T_BS.R.vec().norm() > 1e-9) {
    map.Fail("T_BS", "expected the identity: the body frame is the IMU's");
  }
  ImuSensor sensor;
  sensor.noise = ReadImuNoise(&map);
  sensor.rate_hz = map.NumberOr("rate_hz", 0.0, {1e-3, 1e6});
  sensor.gravity = map.NumberOr("gravity_m_per_s2", kStandardGravity, {0.1, 100.0});
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  sensor.calibration.T_g = ReadMatrix3Or(&map, "T_g", identity);
  sensor.calibration.T_s = ReadMatrix3Or(&map, "T_s", Eigen::Matrix3d::Zero());
  sensor.calibration.T_a = ReadMatrix3Or(&map, "T_a", identity);
  for (const char* key : {"T_g", "T_a"}) {
    const Eigen::Matrix3d& T = key[2] == 'g' ? sensor.calibration.T_g : sensor.calibration.T_a;
    if (!(std::abs(T.determinant()) > 1e-3)) map.Fail(key, "expected a matrix with an inverse");
  }
  CollectUnknownKeys(map, unknown_keys);
  return sensor;
}

CameraSensor ReadCameraSensor(std::string_view yaml, const std::string& file,
                              std::vector<std::string>* unknown_keys) {
  const YamlNode root = ParseSensor(yaml, file);
  return ReadCameraSensor(YamlMap(root, file), unknown_keys);
}

CameraSensor ReadCameraSensor(YamlMap map, std::vector<std::string>* unknown_keys) {
  PassOverCommonKeys(&map);
  CameraSensor sensor;
  sensor.T_BS = ReadMatrix4(&map, "T_BS");
  const Pose T_CB = PoseOfMatrix(map, "T_BS", *sensor.T_BS).Inverse();
  sensor.calibration.R_CB = T_CB.R;
  sensor.calibration.p_CB = T_CB.p;
  sensor.calibration.model = ReadCameraModel(&map, "distortion_coefficients");
  sensor.rate_hz = map.NumberOr("rate_hz", 0.0, {1e-3, 1e6});
  sensor.t_d_s = map.NumberOr("time_offset_s", 0.0, {-10.0, 10.0});
  sensor.t_r_s = map.NumberOr("readout_time_s", 0.0, {-1.0, 1.0});
  if (map.Has("readout_by_columns")) {
    const std::optional<bool> by_columns = AsBool(map.Node("readout_by_columns"));
    if (!by_columns) map.Fail("readout_by_columns", "expected true or false");
    sensor.readout_by_columns = *by_columns;
  }
  if (map.Has("frontend_settings_sha256")) {
    sensor.frontend_settings_sha256 = map.Text("frontend_settings_sha256");
  }
  if (map.Has("image_set_sha256")) sensor.image_set_sha256 = map.Text("image_set_sha256");
  CollectUnknownKeys(map, unknown_keys);
  return sensor;
}

Pose ReadSensorPose(std::string_view yaml, const std::string& file) {
  const YamlNode root = ParseSensor(yaml, file);
  YamlMap map(root, file);
  return ReadPoseOrIdentity(&map);
}

std::string WriteImuSensor(const ImuSensor& sensor) {
  std::string text = "sensor_type: imu\n";
  AppendTransform(Eigen::Matrix4d::Identity(), &text);
  if (sensor.rate_hz > 0.0) AppendKey("rate_hz", sensor.rate_hz, &text);
  text += "# rad/s/sqrt(Hz), rad/s^2/sqrt(Hz), m/s^2/sqrt(Hz), m/s^3/sqrt(Hz)\n";
  AppendKey("gyroscope_noise_density", sensor.noise.gyroscope_density, &text);
  AppendKey("gyroscope_random_walk", sensor.noise.gyroscope_random_walk, &text);
  AppendKey("accelerometer_noise_density", sensor.noise.accelerometer_density, &text);
  AppendKey("accelerometer_random_walk", sensor.noise.accelerometer_random_walk, &text);
  AppendKey("gravity_m_per_s2", sensor.gravity, &text);
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  AppendMatrixUnless("T_g", sensor.calibration.T_g, identity, &text);
  AppendMatrixUnless("T_s", sensor.calibration.T_s, Eigen::Matrix3d::Zero(), &text);
  AppendMatrixUnless("T_a", sensor.calibration.T_a, identity, &text);
  return text;
}

std::string WriteCameraSensor(const CameraSensor& sensor) {
  const CameraCalibration& camera = sensor.calibration;
  std::string text = "sensor_type: camera\n";
  AppendTransform(SensorMatrix(sensor), &text);
  if (sensor.rate_hz > 0.0) AppendKey("rate_hz", sensor.rate_hz, &text);
  text += "resolution: [" + std::to_string(camera.model.width_px()) + ", " +
          std::to_string(camera.model.height_px()) + "]\n";
  text += "camera_model: pinhole\n";
  const CameraModel::Parameters& parameters = camera.model.parameters();
  AppendKey("intrinsics", std::vector<double>(parameters.data(), parameters.data() + 4), &text);
  text += std::string("distortion_model: ") + DistortionModelName(camera.model.model()) + "\n";
  AppendKey("distortion_coefficients",
            std::vector<double>(parameters.data() + 4, parameters.data() + parameters.size()),
            &text);
  if (sensor.t_d_s != 0.0) AppendKey("time_offset_s", sensor.t_d_s, &text);
  if (sensor.t_r_s != 0.0) AppendKey("readout_time_s", sensor.t_r_s, &text);
  if (sensor.readout_by_columns) text += "readout_by_columns: true\n";
  if (!sensor.frontend_settings_sha256.empty()) {
    text += "frontend_settings_sha256: \"" + sensor.frontend_settings_sha256 + "\"\n";
  }
  if (!sensor.image_set_sha256.empty()) {
    text += "image_set_sha256: \"" + sensor.image_set_sha256 + "\"\n";
  }
  return text;
}

RigCalibration MakeRig(const ImuCalibration& imu, const std::vector<CameraSensor>& cameras,
                       const std::string& file) {
  // What clocks in hardware leave; above it, one t_d for the rig describes no camera.
  constexpr double kLargestSpread_s = 1e-3;
  RigCalibration rig;
  rig.imu = imu;
  // Means of the differences to the first: cameras that agree keep their number to the last bit.
  const double weight = cameras.empty() ? 0.0 : 1.0 / static_cast<double>(cameras.size());
  if (!cameras.empty()) {
    rig.t_d_s = cameras.front().t_d_s;
    rig.t_r_s = cameras.front().t_r_s;
    rig.readout_by_columns = cameras.front().readout_by_columns;
  }
  for (const CameraSensor& camera : cameras) {
    rig.cameras.push_back(camera.calibration);
    rig.t_d_s += weight * (camera.t_d_s - cameras.front().t_d_s);
    rig.t_r_s += weight * (camera.t_r_s - cameras.front().t_r_s);
    if (std::abs(camera.t_d_s - cameras.front().t_d_s) > kLargestSpread_s ||
        std::abs(camera.t_r_s - cameras.front().t_r_s) > kLargestSpread_s) {
      throw InputError(file, 0, "time_offset_s, readout_time_s",
                       "differ between the cameras by more than 1 ms; expected one time offset and "
                       "one readout time for the rig");
    }
    if (camera.readout_by_columns != cameras.front().readout_by_columns) {
      throw InputError(file, 0, "readout_by_columns", "differs between the cameras");
    }
  }
  return rig;
}

}  // namespace duet
