#include "frontend/stereo_matcher.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "test/frontend/synthetic_scene.h"

namespace duet {
namespace {

class StereoMatcherTest : public testing::Test {
 protected:
  StereoMatcherTest() : rig_(SmallRig(true)), scene_(6) {
    const KltTracker tracker(options_);
    for (std::size_t camera = 0; camera < 2; ++camera) {
      images_.push_back(
          scene_.Render(rig_.cameras[camera].model, CameraPose(rig_, camera, Pose{})));
      pyramids_.emplace_back();
      tracker.BuildPyramid(images_[camera], &pyramids_[camera]);
    }
    for (int y = 40; y <= 200; y += 20) {
      for (int x = 60; x <= 320; x += 20) {
        const cv::Point2f point(static_cast<float>(x), static_cast<float>(y));
        const auto ray = rig_.cameras[0].model.Unproject({point.x, point.y});
        queries_.push_back({point, *ray, std::nullopt});
      }
    }
  }

  int Match(const RigCalibration& told) {
    StereoMatcher matcher(options_, told.cameras[0], told.cameras[1]);
    matcher.Match(pyramids_[0], pyramids_[1], queries_, &matches_);
    return static_cast<int>(std::count_if(matches_.begin(), matches_.end(),
                                          [](const auto& match) { return match.has_value(); }));
  }

  FrontendOptions options_;
  RigCalibration rig_;
  SyntheticScene scene_;
  std::vector<cv::Mat> images_;
  std::vector<ImagePyramid> pyramids_;
  std::vector<StereoQuery> queries_;
  std::vector<std::optional<StereoMatch>> matches_;
};

TEST_F(StereoMatcherTest, FindsPointAndDepthWithoutAGuess) {
  EXPECT_GE(Match(rig_), static_cast<int>(queries_.size() * 8 / 10));
  for (std::size_t i = 0; i < queries_.size(); ++i) {
    if (!matches_[i]) continue;
    // The wall is parallel to the first camera's image, at 3 m less the camera's own place.
    const double depth = SyntheticScene::kDepth - CameraPose(rig_, 0, Pose{}).p.z();
    // 0.11 m x 230 px: a tenth of a pixel is 0.004 in inverse depth.
    EXPECT_NEAR(matches_[i]->inverse_depth, 1.0 / depth, 0.02);
  }
}

TEST_F(StereoMatcherTest, AnEarlierDepthGivesTheSameMatch) {
  (void)Match(rig_);
  const auto searched = matches_;
  for (std::size_t i = 0; i < queries_.size(); ++i) {
    if (searched[i]) queries_[i].inverse_depth = searched[i]->inverse_depth + 0.03;
  }
  (void)Match(rig_);
  for (std::size_t i = 0; i < queries_.size(); ++i) {
    if (!searched[i]) continue;
    ASSERT_TRUE(matches_[i]);
    EXPECT_LT(cv::norm(searched[i]->point - matches_[i]->point), 0.1);
  }
}

TEST_F(StereoMatcherTest, RefusesWhatLiesOffTheEpipolarCurve) {
  RigCalibration wrong = rig_;
  // 0.02 rad about the optical axis's side: some 5 px across the epipolar curves.
  wrong.cameras[1].R_CB = ExpQuaternion(Eigen::Vector3d(0.02, 0, 0)) * wrong.cameras[1].R_CB;
  wrong.cameras[1].p_CB = ExpQuaternion(Eigen::Vector3d(0.02, 0, 0)) * wrong.cameras[1].p_CB;
  EXPECT_LE(Match(wrong), static_cast<int>(queries_.size() / 20));
}

TEST_F(StereoMatcherTest, RefusesRepeatedTexture) {
  cv::Mat stripes(240, 376, CV_8U);
  for (int y = 0; y < stripes.rows; ++y) {
    for (int x = 0; x < stripes.cols; ++x) {
      stripes.at<unsigned char>(y, x) = static_cast<unsigned char>(
          128 + 60 * std::sin(x * 2 * M_PI / 24) * std::sin(y * 2 * M_PI / 24));
    }
  }
  const KltTracker tracker(options_);
  for (ImagePyramid& pyramid : pyramids_) tracker.BuildPyramid(stripes, &pyramid);
  // Left are points whose other places lie outside of the image or are cut differently by the
  // grid of pixels.
  EXPECT_LE(Match(rig_), static_cast<int>(queries_.size() / 5));
}

}  // namespace
}  // namespace duet
