#include "frontend/klt_tracker.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "test/frontend/synthetic_scene.h"

namespace duet {
namespace {

class KltTrackerTest : public testing::Test {
 protected:
  KltTrackerTest() : tracker_(options_), scene_(2) {
    for (int y = 40; y <= 200; y += 20) {
      for (int x = 40; x <= 340; x += 20) {
        points_.emplace_back(static_cast<float>(x) + 0.3F, static_cast<float>(y) + 0.6F);
      }
    }
  }

  ImagePyramid Pyramid(const cv::Mat& image) const {
    ImagePyramid pyramid;
    tracker_.BuildPyramid(image, &pyramid);
    return pyramid;
  }

  FrontendOptions options_;
  KltTracker tracker_;
  SyntheticScene scene_;
  std::vector<cv::Point2f> points_;
  std::vector<FlowStatus> status_;
};

TEST_F(KltTrackerTest, FindsAKnownMotionToATenthOfAPixel) {
  const Pose from;
  const Pose to{ExpQuaternion(Eigen::Vector3d(0.005, -0.01, 0.02)),
                Eigen::Vector3d(0.05, -0.03, 0.04)};
  std::vector<cv::Point2f> found = points_;
  tracker_.Track(Pyramid(scene_.Render(SmallCamera(), from)),
                 Pyramid(scene_.Render(SmallCamera(), to)), points_, 0.5, &found, &status_);
  double sum = 0.0;
  int tracked = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (status_[i] != FlowStatus::kTracked) continue;
    const auto point = SyntheticScene::PointAt(SmallCamera(), from, {points_[i].x, points_[i].y});
    const auto truth = SyntheticScene::PixelOf(SmallCamera(), to, *point);
    sum += (*truth - Eigen::Vector2d(found[i].x, found[i].y)).squaredNorm();
    ++tracked;
  }
  EXPECT_GE(tracked, static_cast<int>(0.9 * static_cast<double>(points_.size())));
  // Eight-bit images, bilinear samples and a patch that only shifts.
  EXPECT_LT(std::sqrt(sum / (2.0 * tracked)), 0.1);
}

// What is covered in the second image has no place there; the way back tells.
TEST_F(KltTrackerTest, TheWayBackCatchesOcclusion) {
  const cv::Mat from = scene_.Render(SmallCamera(), Pose{});
  cv::Mat to = from.clone();
  const cv::Rect covered(150, 60, 120, 120);
  SyntheticScene(77).Render(SmallCamera(), Pose{})(covered).copyTo(to(covered));
  std::vector<cv::Point2f> found = points_;
  tracker_.Track(Pyramid(from), Pyramid(to), points_, 0.5, &found, &status_);
  int inside = 0;
  int passed = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const bool hidden =
        points_[i].x > 158 && points_[i].x < 262 && points_[i].y > 68 && points_[i].y < 172;
    inside += hidden ? 1 : 0;
    if (hidden && status_[i] == FlowStatus::kTracked) ++passed;
    const bool free = points_[i].x < 130 || points_[i].x > 290 || points_[i].y < 40;
    if (free) {
      EXPECT_EQ(status_[i], FlowStatus::kTracked) << points_[i];
    }
  }
  EXPECT_GE(inside, 20);
  EXPECT_LE(passed, inside / 10);
}

TEST_F(KltTrackerTest, TakesNoPoints) {
  const ImagePyramid pyramid = Pyramid(scene_.Render(SmallCamera(), Pose{}));
  std::vector<cv::Point2f> none;
  tracker_.Track(pyramid, pyramid, {}, 0.5, &none, &status_);
  EXPECT_TRUE(status_.empty());
}

TEST_F(KltTrackerTest, LevelsAreHalvedImages) {
  const ImagePyramid pyramid = Pyramid(scene_.Render(SmallCamera(), Pose{}));
  EXPECT_EQ(LevelOf(pyramid, 0).size(), cv::Size(376, 240));
  EXPECT_EQ(LevelOf(pyramid, 1).size(), cv::Size(188, 120));
  EXPECT_EQ(LevelOf(pyramid, 99).cols, 376 >> (options_.klt_levels - 1));
}

}  // namespace
}  // namespace duet
