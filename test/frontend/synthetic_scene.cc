#include "test/frontend/synthetic_scene.h"

#include <opencv2/imgproc.hpp>

#include "common/support/random.h"

namespace duet {
namespace {

constexpr int kTextureSize = 2048;
constexpr double kTexelsPerMetre = 110.0;  // about one a pixel at kDepth

cv::Mat Noise(Random* random, int size, double sigma) {
  cv::Mat noise(size, size, CV_32F);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) noise.at<float>(y, x) = static_cast<float>(random->Normal());
  }
  cv::GaussianBlur(noise, noise, cv::Size(), sigma, sigma);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(noise, mean, deviation);
  return (noise - mean[0]) / deviation[0];
}

}  // namespace

SyntheticScene::SyntheticScene(std::uint64_t seed) {
  Random random(seed);
  const cv::Mat fine = Noise(&random, kTextureSize, 2.2);
  cv::Mat coarse;
  cv::resize(Noise(&random, kTextureSize / 16, 1.5), coarse, fine.size(), 0, 0, cv::INTER_CUBIC);
  cv::Mat(32.0 * fine + 22.0 * coarse + 120.0).convertTo(texture_, CV_8U);
}

std::optional<Eigen::Vector3d> SyntheticScene::PointAt(const CameraModel& model, const Pose& T_GC,
                                                       const Eigen::Vector2d& uv) {
  const std::optional<Eigen::Vector3d> ray = model.Unproject(uv);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d ray_G = T_GC.R * *ray;
  if (ray_G.z() < 1e-3) return std::nullopt;
  return T_GC.p + ray_G * ((kDepth - T_GC.p.z()) / ray_G.z());
}

std::optional<Eigen::Vector2d> SyntheticScene::PixelOf(const CameraModel& model, const Pose& T_GC,
                                                       const Eigen::Vector3d& point_G) {
  Eigen::Vector2d uv;
  if (!model.Project(T_GC.Inverse() * point_G, &uv)) return std::nullopt;
  return uv;
}

cv::Mat SyntheticScene::Render(const CameraModel& model, const Pose& T_GC) const {
  cv::Mat map(model.height_px(), model.width_px(), CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    for (int x = 0; x < map.cols; ++x) {
      const std::optional<Eigen::Vector3d> point = PointAt(model, T_GC, {x, y});
      const Eigen::Vector2d texel =
          point ? Eigen::Vector2d(kTexelsPerMetre * point->head<2>()) : Eigen::Vector2d(1e6, 1e6);
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(texel.x() + kTextureSize / 2.0),
                                 static_cast<float>(texel.y() + kTextureSize / 2.0)};
    }
  }
  cv::Mat image;
  cv::remap(texture_, image, map, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_CONSTANT, 0);
  return image;
}

CameraModel SmallCamera() {
  CameraModel::Parameters parameters(9);
  parameters << 230.0, 229.0, 186.0, 122.0, -0.28, 0.074, 2e-4, 2e-5, 0.0;
  return {DistortionModel::kRadialTangential, 376, 240, parameters};
}

RigCalibration SmallRig(bool stereo) {
  RigCalibration rig;
  CameraCalibration camera;
  camera.model = SmallCamera();
  // The body's axes are the camera's, permuted: x_C = y_B, y_C = -x_B.
  camera.R_CB = ExpQuaternion(Eigen::Vector3d(0, 0, -std::acos(0.0)));
  camera.p_CB = Eigen::Vector3d(0.01, -0.02, 0.005);
  rig.cameras.push_back(camera);
  if (!stereo) return rig;
  const Eigen::Quaterniond R_C1C0 = ExpQuaternion(Eigen::Vector3d(0.004, -0.01, 0.006));
  camera.R_CB = R_C1C0 * camera.R_CB;
  camera.p_CB = R_C1C0 * (camera.p_CB - Eigen::Vector3d(0.11, 0.001, -0.002));
  rig.cameras.push_back(camera);
  return rig;
}

Pose CameraPose(const RigCalibration& rig, std::size_t camera, const Pose& T_GB) {
  const Pose T_CB{rig.cameras[camera].R_CB, rig.cameras[camera].p_CB};
  return T_GB * T_CB.Inverse();
}

}  // namespace duet
