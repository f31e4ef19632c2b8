// The same points through OpenCV's cameras and ours.

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <vector>

#include "common/camera/camera_model.h"
#include "common/support/random.h"

namespace duet {
namespace {

class OpenCvAgreementTest : public testing::Test {
 protected:
  OpenCvAgreementTest() {
    Random random(1);
    for (int i = 0; i < 500; ++i) {
      const double z = 0.3 + 5.0 * random.Uniform();
      points_.emplace_back(z * (2.4 * random.Uniform() - 1.2), z * (2.0 * random.Uniform() - 1.0),
                           z);
    }
  }

  void ExpectAgreement(const CameraModel& camera, const std::vector<cv::Point2d>& pixels) {
    ASSERT_EQ(pixels.size(), points_.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      Eigen::Vector2d uv;
      ASSERT_TRUE(camera.Project({points_[i].x, points_[i].y, points_[i].z}, &uv));
      // Roundings of numbers up to 1000.
      EXPECT_NEAR(uv.x(), pixels[i].x, 1e-11);
      EXPECT_NEAR(uv.y(), pixels[i].y, 1e-11);
    }
  }

  std::vector<cv::Point3d> points_;
  const cv::Matx33d K_{458.654, 0.0, 367.215, 0.0, 457.296, 248.375, 0.0, 0.0, 1.0};
  const cv::Vec3d zero_{0.0, 0.0, 0.0};
};

TEST_F(OpenCvAgreementTest, RadialTangential) {
  const cv::Matx<double, 1, 5> k(-0.28, 0.07, 1e-3, -2e-3, 0.02);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points_, zero_, zero_, K_, k, pixels);
  CameraModel::Parameters parameters(9);
  parameters << 458.654, 457.296, 367.215, 248.375, -0.28, 0.07, 1e-3, -2e-3, 0.02;
  ExpectAgreement(CameraModel(DistortionModel::kRadialTangential, 752, 480, parameters), pixels);
}

TEST_F(OpenCvAgreementTest, Equidistant) {
  const cv::Vec4d k(0.0034, 0.0007, -0.0020, 0.0002);
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(points_, pixels, zero_, zero_, K_, k);
  CameraModel::Parameters parameters(8);
  parameters << 458.654, 457.296, 367.215, 248.375, 0.0034, 0.0007, -0.0020, 0.0002;
  ExpectAgreement(CameraModel(DistortionModel::kEquidistant, 752, 480, parameters), pixels);
}

}  // namespace
}  // namespace duet
