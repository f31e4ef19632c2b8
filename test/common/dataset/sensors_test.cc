#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/dataset/asl_sensors.h"
#include "common/dataset/kalibr.h"
#include "common/geometry/so3.h"
#include "common/support/input_error.h"
#include "common/support/random.h"

namespace duet {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string kImu =
    "sensor_type: imu\ncomment: VI-Sensor\n"
    "T_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, 0.0,\n         0.0, 1.0, 0.0, 0.0,\n"
    "         0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\nrate_hz: 200\n"
    "gyroscope_noise_density: 1.6968e-04     # [ rad / s / sqrt(Hz) ]\n"
    "gyroscope_random_walk: 1.9393e-05\naccelerometer_noise_density: 2.0000e-3\n"
    "accelerometer_random_walk: 3.0000e-3\n";

const std::string kCameraPose =
    "T_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,\n"
    "         0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,\n"
    "        -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,\n"
    "         0.0, 0.0, 0.0, 1.0]\n";
const std::string kCameraModel =
    "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
    "intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n";
const std::string kDistortion =
    "distortion_model: radial-tangential\n"
    "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";

std::string Without(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.substr(0, at) + text.substr(at + part.size());
}

TEST(ImuSensor, ReadsEurocsFileWithAndWithoutOpenCvsFirstLine) {
  for (const std::string& text : {kImu, "%YAML:1.0\n" + kImu}) {
    const ImuSensor sensor = ReadImuSensor(text, "sensor.yaml");
    EXPECT_EQ(sensor.noise.gyroscope_density, 1.6968e-4);
    EXPECT_EQ(sensor.noise.gyroscope_random_walk, 1.9393e-5);
    EXPECT_EQ(sensor.noise.accelerometer_density, 2e-3);
    EXPECT_EQ(sensor.noise.accelerometer_random_walk, 3e-3);
    EXPECT_EQ(sensor.rate_hz, 200.0);
    EXPECT_EQ(sensor.gravity, 9.81) << "where the file is silent";
    EXPECT_EQ(sensor.calibration.T_g, Eigen::Matrix3d::Identity());
    EXPECT_TRUE(sensor.calibration.T_s.isZero());
  }
}

TEST(ImuSensor, ReadsGravityAndTheErrorModelByRows) {
  const ImuSensor sensor = ReadImuSensor(
      kImu + "gravity_m_per_s2: 9.8066\nT_s: [1, 2, 3, 4, 5, 6, 7, 8, 9]\n", "sensor.yaml");
  EXPECT_EQ(sensor.gravity, 9.8066);
  EXPECT_EQ(sensor.calibration.T_s(0, 1), 2.0);
  EXPECT_EQ(sensor.calibration.T_s(2, 0), 7.0);
}

TEST(ImuSensor, ADensityHasNoDefault) {
  EXPECT_THAT(
      [] { (void)ReadImuSensor(Without(kImu, "gyroscope_random_walk: 1.9393e-05\n"), "imu.yaml"); },
      ThrowsMessage<InputError>(HasSubstr("gyroscope_random_walk: is missing; expected a number")));
  EXPECT_THAT(
      [] {
        (void)ReadImuSensor(
            Without(kImu, "gyroscope_random_walk: 1.9393e-05\n") + "gyroscope_randomwalk: 1\n",
            "imu.yaml");
      },
      ThrowsMessage<InputError>(HasSubstr("is 'gyroscope_randomwalk' meant to be it?")));
  EXPECT_THAT(
      [] {
        (void)ReadImuSensor(Without(kImu, "1.6968e-04     # [ rad / s / sqrt(Hz) ]\n"), "imu.yaml");
      },
      ThrowsMessage<InputError>(HasSubstr("imu.yaml:")));
}

TEST(ImuSensor, KeysOfOthersAreCollectedAndMisspeltOnesRefused) {
  std::vector<std::string> unknown;
  (void)ReadImuSensor(kImu + "vendor: x\n", "imu.yaml", &unknown);
  EXPECT_THAT(unknown, ElementsAre("imu.yaml: vendor"));
  EXPECT_THAT([] { (void)ReadImuSensor(kImu + "gravity_m_per_s: 9.8\n", "imu.yaml"); },
              ThrowsMessage<InputError>(
                  HasSubstr("gravity_m_per_s: unknown key; did you mean 'gravity_m_per_s2'?")));
}

TEST(ImuSensor, TheBodyIsTheImu) {
  std::string moved = kImu;
  moved.replace(moved.find("1.0, 0.0, 0.0, 0.0"), 18, "1.0, 0.0, 0.0, 0.1");
  EXPECT_THAT([&] { (void)ReadImuSensor(moved, "imu.yaml"); },
              ThrowsMessage<InputError>(HasSubstr("T_BS: expected the identity")));
}

TEST(CameraSensor, ReadsEurocsFileAndInvertsItsPoseOnce) {
  const CameraSensor sensor =
      ReadCameraSensor("%YAML:1.0\n" + kCameraPose + kCameraModel + kDistortion, "sensor.yaml");
  const CameraModel& model = sensor.calibration.model;
  EXPECT_EQ(model.model(), DistortionModel::kRadialTangential);
  EXPECT_EQ(model.width_px(), 752);
  EXPECT_EQ(model.height_px(), 480);
  EXPECT_THAT(std::vector<double>(model.parameters().begin(), model.parameters().end()),
              ElementsAre(458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019359,
                          1.76187114e-05, 0.0));
  EXPECT_EQ(sensor.rate_hz, 20.0);
  EXPECT_EQ(sensor.t_d_s, 0.0);
  // p_CB in the README of the data: (0.0652, -0.0207, -0.0081).
  EXPECT_LT((sensor.calibration.p_CB - Eigen::Vector3d(0.0652, -0.0207, -0.0081)).norm(), 1e-4);
  // The camera's own origin is p_BC in B: T_CB takes it to zero. 1e-11: the file's digits.
  const Eigen::Vector3d p_BC(-0.0216401454975, -0.064676986768, 0.00981073058949);
  EXPECT_LT((sensor.calibration.R_CB * p_BC + sensor.calibration.p_CB).norm(), 1e-11);
  // x of the camera is nearly y of the body.
  EXPECT_NEAR((sensor.calibration.R_CB * Eigen::Vector3d::UnitY()).x(), 0.999557249008, 1e-9);
}

TEST(CameraSensor, ReadsEquidistantAndOptionalTimes) {
  const CameraSensor sensor = ReadCameraSensor(
      kCameraPose + kCameraModel +
          "distortion_model: equidistant\ndistortion_coefficients: [1e-3, 2e-3, 3e-3, 4e-3]\n"
          "time_offset_s: -0.012\nreadout_time_s: 0.03\nreadout_by_columns: true\n",
      "sensor.yaml");
  EXPECT_EQ(sensor.calibration.model.model(), DistortionModel::kEquidistant);
  EXPECT_EQ(sensor.calibration.model.parameters()[7], 4e-3);
  EXPECT_EQ(sensor.t_d_s, -0.012);
  EXPECT_EQ(sensor.t_r_s, 0.03);
  EXPECT_TRUE(sensor.readout_by_columns);
}

struct BadSensor {
  std::string text;
  std::string message;
};
class RefusedCamera : public testing::TestWithParam<BadSensor> {};
TEST_P(RefusedCamera, NamesFileKeyAndWhatWasExpected) {
  EXPECT_THAT([] { (void)ReadCameraSensor(GetParam().text, "cam0/sensor.yaml"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("cam0/sensor.yaml"), HasSubstr(GetParam().message))));
}
INSTANTIATE_TEST_SUITE_P(
    Sensors, RefusedCamera,
    testing::Values(
        BadSensor{"", "is empty"}, BadSensor{"5\n", "expected keys with values, got '5'"},
        BadSensor{kCameraPose + kCameraModel, "distortion_model: is missing; expected a text"},
        BadSensor{kCameraPose + kCameraModel + "distortion_model: radtan\n",
                  "distortion_coefficients: is missing"},
        BadSensor{
            kCameraPose + kCameraModel + "distortion_model: none\ndistortion_coefficients: []\n",
            "expected radial-tangential, radtan or equidistant, got 'none'"},
        BadSensor{kCameraPose + kCameraModel +
                      "distortion_model: radtan\ndistortion_coefficients: [1, 2, 3]\n",
                  "expected k1 k2 t1 t2 [k3], 4 or 5 numbers, got 3"},
        BadSensor{kCameraPose + kCameraModel +
                      "distortion_model: equidistant\ndistortion_coefficients: [1, 2, 3, 4, 5]\n",
                  "expected k1 k2 k3 k4, 4 numbers, got 5"},
        BadSensor{kCameraModel + kDistortion, "T_BS: is missing"},
        BadSensor{"T_BS:\n  cols: 4\n  rows: 4\n  data: [1.1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, "
                  "0, 0, 1]\n" +
                      kCameraModel + kDistortion,
                  "T_BS: is no rotation: R R' differs from the identity by 0.21"},
        BadSensor{"T_BS:\n  cols: 4\n  rows: 4\n  data: [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, "
                  "0, 0, 1]\n" +
                      kCameraModel + kDistortion,
                  "T_BS: is no rotation: its determinant is -1"},
        BadSensor{"T_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, "
                  "0, 1, 1]\n" +
                      kCameraModel + kDistortion,
                  "T_BS: is no rigid transform"},
        BadSensor{"T_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0]\n" + kCameraModel + kDistortion,
                  "T_BS.data: expected a list of 16 numbers, got a list of 3"},
        BadSensor{"T_BS: [1, 0, 0]\n" + kCameraModel + kDistortion, "T_BS: expected a 4x4 matrix"},
        BadSensor{kCameraPose + kDistortion +
                      "camera_model: pinhole\nresolution: [752]\nintrinsics: [1, 1, 1, 1]\n",
                  "resolution: expected [width, height]"},
        BadSensor{kCameraPose + kDistortion +
                      "camera_model: pinhole\nresolution: [752, 480]\nintrinsics: [0, 1, 1, 1]\n",
                  "focal lengths above 0"},
        BadSensor{kCameraPose + kDistortion + "camera_model: omni\n", "expected pinhole"},
        BadSensor{kCameraPose + kCameraModel + kDistortion + "time_ofset_s: 0.01\n",
                  "time_ofset_s: unknown key; did you mean 'time_offset_s'?"}));

TEST(CameraSensor, WhatIsWrittenReadsBackToTheSameBits) {
  CameraSensor sensor = ReadCameraSensor(kCameraPose + kCameraModel + kDistortion, "sensor.yaml");
  sensor.t_d_s = 0.0123;
  sensor.frontend_settings_sha256 = "00e1";
  const CameraSensor again = ReadCameraSensor(WriteCameraSensor(sensor), "again.yaml");
  EXPECT_EQ(again.calibration.R_CB.coeffs(), sensor.calibration.R_CB.coeffs());
  EXPECT_EQ(again.calibration.p_CB, sensor.calibration.p_CB);
  EXPECT_EQ(again.calibration.model.parameters(), sensor.calibration.model.parameters());
  EXPECT_EQ(again.calibration.model.width_px(), 752);
  EXPECT_EQ(again.t_d_s, sensor.t_d_s);
  EXPECT_EQ(again.frontend_settings_sha256, "00e1");
}

TEST(CameraSensor, APoseThatWasChangedIsWrittenAndNotTheToldOne) {
  CameraSensor sensor = ReadCameraSensor(kCameraPose + kCameraModel + kDistortion, "sensor.yaml");
  sensor.calibration.p_CB.x() += 0.03;
  const CameraSensor again = ReadCameraSensor(WriteCameraSensor(sensor), "again.yaml");
  // Written as its inverse, so to rounding.
  EXPECT_LT((again.calibration.p_CB - sensor.calibration.p_CB).norm(), 1e-15);
}

TEST(ImuSensor, WhatIsWrittenReadsBackToTheSameBits) {
  Random random(3);
  ImuSensor sensor = ReadImuSensor(kImu, "imu.yaml");
  sensor.gravity = 9.80665;
  sensor.calibration.T_g += 0.01 * Eigen::Matrix3d::NullaryExpr([&] { return random.Normal(); });
  sensor.calibration.T_s = 0.01 * Eigen::Matrix3d::NullaryExpr([&] { return random.Normal(); });
  const ImuSensor again = ReadImuSensor(WriteImuSensor(sensor), "again.yaml");
  EXPECT_EQ(again.noise.gyroscope_density, sensor.noise.gyroscope_density);
  EXPECT_EQ(again.gravity, sensor.gravity);
  EXPECT_EQ(again.calibration.T_g, sensor.calibration.T_g);
  EXPECT_EQ(again.calibration.T_s, sensor.calibration.T_s);
  EXPECT_EQ(again.calibration.T_a, sensor.calibration.T_a);
}

TEST(Rig, HasOneTimeOffset) {
  CameraSensor a = ReadCameraSensor(kCameraPose + kCameraModel + kDistortion, "sensor.yaml");
  CameraSensor b = a;
  a.t_d_s = 0.0100;
  b.t_d_s = 0.0102;
  const RigCalibration rig = MakeRig({}, {a, b}, "mav0");
  EXPECT_EQ(rig.cameras.size(), 2U);
  EXPECT_NEAR(rig.t_d_s, 0.0101, 1e-17);
  b.t_d_s = a.t_d_s;
  EXPECT_EQ(MakeRig({}, {a, b, a}, "mav0").t_d_s, a.t_d_s) << "to the last bit";
  b.t_d_s = 0.02;
  EXPECT_THAT(
      [&] {
        (void)MakeRig({}, {a, b}, "mav0");
      },
      ThrowsMessage<InputError>(HasSubstr("differ between the cameras")));
}

const std::string kKalibr =
    "cam0:\n"
    "  T_cam_imu:\n"
    "  - [0.0, 1.0, 0.0, 0.1]\n"
    "  - [-1.0, 0.0, 0.0, 0.2]\n"
    "  - [0.0, 0.0, 1.0, 0.3]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  cam_overlaps: [1]\n"
    "  camera_model: pinhole\n"
    "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n"
    "  distortion_model: equidistant\n"
    "  intrinsics: [190.0, 191.0, 254.0, 256.0]\n"
    "  resolution: [512, 513]\n"
    "  rostopic: /cam0/image_raw\n"
    "  timeshift_cam_imu: -0.00017\n"
    "cam1:\n"
    "  T_cn_cnm1:\n"
    "  - [1.0, 0.0, 0.0, -0.1]\n"
    "  - [0.0, 1.0, 0.0, 0.0]\n"
    "  - [0.0, 0.0, 1.0, 0.0]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  camera_model: pinhole\n"
    "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n"
    "  distortion_model: radtan\n"
    "  intrinsics: [190.0, 191.0, 254.0, 256.0]\n"
    "  resolution: [512, 513]\n";

TEST(Kalibr, ReadsACamchain) {
  const std::vector<CameraSensor> cameras = ReadKalibrCameras(kKalibr, "camchain.yaml");
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].calibration.p_CB, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_LT(
      (cameras[0].calibration.R_CB * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitX()).norm(),
      1e-15)
      << "x_C = R_CB x_B, as T_cam_imu says";
  EXPECT_EQ(cameras[0].t_d_s, -0.00017);
  EXPECT_EQ(cameras[0].calibration.model.model(), DistortionModel::kEquidistant);
  EXPECT_EQ(cameras[0].calibration.model.height_px(), 513);
  EXPECT_EQ(cameras[1].calibration.model.model(), DistortionModel::kRadialTangential);
  EXPECT_LT((cameras[1].calibration.p_CB - Eigen::Vector3d(0.0, 0.2, 0.3)).norm(), 1e-15);
}

TEST(Kalibr, RefusesACamchainWithoutImu) {
  const std::string text = kKalibr.substr(0, 6) + kKalibr.substr(kKalibr.find("  cam_overlaps"));
  EXPECT_THAT([&] { (void)ReadKalibrCameras(text, "camchain.yaml"); },
              ThrowsMessage<InputError>(HasSubstr("cam0.T_cam_imu: is missing")));
  EXPECT_THAT([&] { (void)ReadKalibrCameras("a: 1\n", "camchain.yaml"); },
              ThrowsMessage<InputError>(HasSubstr("cam0: is missing")));
}

TEST(Kalibr, ReadsAnImuFileFlatAndNested) {
  const std::string flat =
      "accelerometer_noise_density: 0.0014\naccelerometer_random_walk: 8.0e-05\n"
      "gyroscope_noise_density: 8.0e-05\ngyroscope_random_walk: 2.2e-06\n"
      "rostopic: /imu0\nupdate_rate: 200.0\n";
  const ImuSensor sensor = ReadKalibrImu(flat, "imu.yaml");
  EXPECT_EQ(sensor.noise.accelerometer_density, 0.0014);
  EXPECT_EQ(sensor.noise.gyroscope_random_walk, 2.2e-6);
  EXPECT_EQ(sensor.rate_hz, 200.0);
  std::string nested = "imu0:\n";
  for (std::size_t at = 0; at < flat.size(); at = flat.find('\n', at) + 1) {
    nested += "  " + flat.substr(at, flat.find('\n', at) - at + 1);
  }
  EXPECT_EQ(ReadKalibrImu(nested, "imu.yaml").noise.gyroscope_density, 8e-5);
  EXPECT_THAT([] { (void)ReadKalibrImu("update_rate: 200\n", "imu.yaml"); },
              ThrowsMessage<InputError>(HasSubstr("gyroscope_noise_density: is missing")));
}

}  // namespace
}  // namespace duet
