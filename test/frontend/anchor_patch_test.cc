#include "frontend/anchor_patch.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "test/frontend/synthetic_scene.h"

namespace duet {
namespace {

using Outcome = AnchorPatch::Outcome;

// The image seen through x -> A (x - center) + to, with another contrast and brightness.
cv::Mat Warp(const cv::Mat& image, const Eigen::Matrix2d& A, cv::Point2f center, cv::Point2f to,
             double contrast = 1.0, double brightness = 0.0) {
  const Eigen::Vector2d shift =
      Eigen::Vector2d(to.x, to.y) - A * Eigen::Vector2d(center.x, center.y);
  const cv::Mat map =
      (cv::Mat_<double>(2, 3) << A(0, 0), A(0, 1), shift.x(), A(1, 0), A(1, 1), shift.y());
  cv::Mat warped;
  cv::warpAffine(image, warped, map, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  warped.convertTo(warped, CV_8U, contrast, brightness);
  return warped;
}

class AnchorPatchTest : public testing::Test {
 protected:
  AnchorPatchTest() : image_(SyntheticScene(3).Render(SmallCamera(), Pose{})), shape_(8) {}

  Outcome Find(const cv::Mat& image, cv::Point2f* point) {
    return patch_.Find(shape_, image, 1.5, 0.85, point);
  }

  const cv::Point2f from_{150.4F, 110.7F};
  const cv::Point2f to_{153.1F, 112.2F};
  cv::Mat image_;
  PatchShape shape_;
  AnchorPatch patch_;
};

TEST_F(AnchorPatchTest, FindsADeformedPatchInAnotherLight) {
  ASSERT_TRUE(patch_.Take(shape_, image_, from_));
  Eigen::Matrix2d A;
  A << 1.05, -0.06, 0.04, 0.97;
  cv::Point2f found = to_ + cv::Point2f(0.5F, -0.4F);
  EXPECT_EQ(Find(Warp(image_, A, from_, to_, 0.6, 40.0), &found), Outcome::kFound);
  EXPECT_LT(cv::norm(found - to_), 0.05);  // bilinear against cubic interpolation
  EXPECT_EQ(patch_.age(), 1);
}

// Step by step an ever stronger deformation, always against the first image: errors stay where
// they are instead of adding up.
TEST_F(AnchorPatchTest, DoesNotDrift) {
  ASSERT_TRUE(patch_.Take(shape_, image_, from_));
  cv::Point2f found = from_;
  for (int step = 1; step <= 40; ++step) {
    Eigen::Matrix2d A;
    A << 1.0 + 0.006 * step, -0.005 * step, 0.004 * step, 1.0 + 0.005 * step;
    const cv::Point2f truth = from_ + 0.37F * static_cast<float>(step) * cv::Point2f(1.0F, -0.6F);
    found += 0.37F * cv::Point2f(1.0F, -0.6F) + cv::Point2f(0.2F, 0.1F);
    ASSERT_EQ(Find(Warp(image_, A, from_, truth), &found), Outcome::kFound) << step;
    EXPECT_LT(cv::norm(found - truth), 0.1) << step;
  }
}

TEST_F(AnchorPatchTest, SaysWhyItWasNotFound) {
  ASSERT_TRUE(patch_.Take(shape_, image_, from_));
  const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
  const cv::Point2f start = from_ + cv::Point2f(0.2F, 0.1F);

  cv::Point2f point = start;
  const Outcome other = Find(SyntheticScene(99).Render(SmallCamera(), Pose{}), &point);
  EXPECT_TRUE(other == Outcome::kDifferent || other == Outcome::kMoved);
  EXPECT_EQ(point, start);

  point = from_ + cv::Point2f(2.5F, 0.0F);  // further than the 1.5 px that are allowed
  EXPECT_EQ(Find(image_, &point), Outcome::kMoved);

  point = cv::Point2f(5.0F, 110.0F);
  EXPECT_EQ(Find(image_, &point), Outcome::kOutside);

  point = from_;
  EXPECT_EQ(Find(cv::Mat(image_.size(), CV_8U, cv::Scalar(50)), &point), Outcome::kDifferent);

  // Grows by a little each time: found, found, ..., beyond use.
  Outcome last = Outcome::kFound;
  for (int step = 1; step <= 40 && last == Outcome::kFound; ++step) {
    point = from_;
    last = Find(Warp(image_, (1.0 + 0.03 * step) * I, from_, from_), &point);
    if (last == Outcome::kFound) {
      EXPECT_LT(1.0 + 0.03 * step, 1.65);
    }
  }
  EXPECT_EQ(last, Outcome::kDeformed);
}

TEST_F(AnchorPatchTest, TakesNoPatchAtTheEdgeOrOfNothing) {
  EXPECT_FALSE(patch_.Take(shape_, image_, {8.0F, 100.0F}));
  cv::Point2f point(100.0F, 100.0F);
  EXPECT_EQ(Find(image_, &point), Outcome::kOutside);
  EXPECT_FALSE(patch_.Take(shape_, cv::Mat(100, 100, CV_8U, cv::Scalar(9)), {50.0F, 50.0F}));
}

}  // namespace
}  // namespace duet
