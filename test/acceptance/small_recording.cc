#include "test/acceptance/small_recording.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/support/random.h"
#include "test/acceptance/program.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

constexpr long long kFramePeriod = 50'000'000;
constexpr long long kImuPeriod = 5'000'000;
constexpr int kImuMargin = 100;  // samples before the first and after the last image

constexpr const char* kImuSensor =
    "sensor_type: imu\n"
    "T_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\n"
    "rate_hz: 200\n"
    "gyroscope_noise_density: 1.6968e-04\n"
    "gyroscope_random_walk: 1.9393e-05\n"
    "accelerometer_noise_density: 2.0000e-3\n"
    "accelerometer_random_walk: 3.0000e-3\n";
constexpr const char* kCameraSensor =
    "sensor_type: camera\n"
    "T_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [1.0, 0.0, 0.0, 0.05, 0.0, 1.0, 0.0, 0.01, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\n"
    "rate_hz: 20\n"
    "resolution: [320, 240]\n"
    "camera_model: pinhole\n"
    "intrinsics: [200.0, 200.0, 160.0, 120.0]\n"
    "distortion_model: radial-tangential\n"
    "distortion_coefficients: [-0.1, 0.01, 0.0, 0.0]\n";

/// Blurred blocks of random brightness: corners everywhere.
cv::Mat Texture(Random* random) {
  cv::Mat blocks(30, 40, CV_8U);
  for (int i = 0; i < blocks.rows * blocks.cols; ++i) {
    blocks.data[i] = static_cast<unsigned char>(random->Index(256));
  }
  cv::Mat image;
  cv::resize(blocks, image, cv::Size(320, 240), 0, 0, cv::INTER_NEAREST);
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.8);
  return image;
}

}  // namespace

void WriteSmallRecording(const fs::path& folder) {
  Random random(1);
  const fs::path mav = folder / "mav0";
  for (const char* name : {"imu0", "cam0/data", "state_groundtruth_estimate0"}) {
    fs::create_directories(mav / name);
  }
  WriteFile(mav / "imu0/sensor.yaml", kImuSensor);
  WriteFile(mav / "cam0/sensor.yaml", kCameraSensor);
  const cv::Mat image = Texture(&random);
  std::string images = "#timestamp [ns],filename\n";
  for (int i = 0; i < kSmallImages; ++i) {
    const std::string stamp = std::to_string(kSmallFirstImage + i * kFramePeriod);
    images += stamp + "," + stamp + ".png\n";
    cv::imwrite(mav / "cam0/data" / (stamp + ".png"), image);
  }
  WriteFile(mav / "cam0/data.csv", images);

  std::string imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
  std::string truth = "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n";
  const int samples = static_cast<int>(kSmallImages * kFramePeriod / kImuPeriod) + 2 * kImuMargin;
  for (int i = 0; i < samples; ++i) {
    const std::string stamp = std::to_string(kSmallFirstImage + (i - kImuMargin) * kImuPeriod);
    imu += stamp;
    for (const double mean : {0.0, 0.0, 0.0}) {
      imu += "," + std::to_string(mean + 0.002 * random.Normal());
    }
    for (const double mean : {0.0, 0.0, 9.81}) {
      imu += "," + std::to_string(mean + 0.03 * random.Normal());
    }
    imu += "\n";
    truth += stamp + ",0,0,0,1,0,0,0\n";
  }
  WriteFile(mav / "imu0/data.csv", imu);
  WriteFile(mav / "state_groundtruth_estimate0/data.csv", truth);
}

}  // namespace duet
