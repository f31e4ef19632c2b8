#include "frontend/feature_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "test/frontend/synthetic_scene.h"

namespace duet {
namespace {

constexpr int kTracks = 80;

cv::Mat Scene() {
  static const cv::Mat image = SyntheticScene(1).Render(SmallCamera(), Pose{});
  return image.clone();
}

std::vector<int> CountByCell(const FeatureGrid& grid, const std::vector<cv::Point2f>& points) {
  std::vector<int> counts(static_cast<std::size_t>(grid.columns() * grid.rows()), 0);
  for (const cv::Point2f& point : points) ++counts[static_cast<std::size_t>(grid.CellOf(point))];
  return counts;
}

double SmallestDistance(const std::vector<cv::Point2f>& points) {
  double smallest = 1e9;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      smallest = std::min(smallest, cv::norm(points[i] - points[j]));
    }
  }
  return smallest;
}

FrontendOptions Options() {
  FrontendOptions options;
  options.min_distance_px = 10.0;
  options.min_corner_quality = 5.0;
  return options;
}

TEST(FeatureGridTest, EveryCellGetsItsShareOfATexturedImage) {
  FeatureGrid grid(Options(), kTracks, Scene().size());
  std::vector<cv::Point2f> corners;
  grid.Detect(Scene(), {}, &corners);
  EXPECT_EQ(corners.size(), kTracks);
  const std::vector<int> counts = CountByCell(grid, corners);
  // 80 tracks, three a cell: 27 cells, so the poorest cells are one short of their share.
  EXPECT_GE(*std::min_element(counts.begin(), counts.end()), 2);
  EXPECT_LE(*std::max_element(counts.begin(), counts.end()), 4);
}

// One half of the image has a fifth of the other's contrast: a single threshold would leave it
// empty or drown the other in corners.
TEST(FeatureGridTest, ThresholdFollowsTheContrastOfEachCell) {
  cv::Mat image = Scene();
  cv::Mat left = image(cv::Rect(0, 0, image.cols / 2, image.rows));
  left.convertTo(left, CV_8U, 0.2, 90.0);
  FeatureGrid grid(Options(), kTracks, image.size());
  std::vector<cv::Point2f> corners;
  grid.Detect(image, {}, &corners);
  const auto in_left = std::count_if(corners.begin(), corners.end(), [&](const cv::Point2f& p) {
    return p.x < 0.5F * static_cast<float>(image.cols);
  });
  EXPECT_EQ(corners.size(), kTracks);
  EXPECT_GE(in_left, static_cast<std::ptrdiff_t>(kTracks / 3));
}

TEST(FeatureGridTest, CellsWithTextureTakeOverFromThoseWithout) {
  cv::Mat image = Scene();
  image(cv::Rect(0, 0, image.cols / 3, image.rows)).setTo(100);
  FeatureGrid grid(Options(), kTracks, image.size());
  std::vector<cv::Point2f> corners;
  grid.Detect(image, {}, &corners);
  EXPECT_EQ(corners.size(), kTracks);
  for (const cv::Point2f& corner : corners) {
    EXPECT_GE(corner.x, static_cast<float>(image.cols) / 3 - 4.0F);
  }
}

TEST(FeatureGridTest, KeepsItsDistanceFromTracksCornersAndTheBorder) {
  FrontendOptions options = Options();
  options.border_px = 20;
  FeatureGrid grid(options, kTracks, Scene().size());
  std::vector<cv::Point2f> tracks;
  grid.Detect(Scene(), {}, &tracks);
  tracks.resize(30);
  std::vector<cv::Point2f> corners;
  grid.Detect(Scene(), tracks, &corners);
  EXPECT_EQ(corners.size(), kTracks - 30);
  corners.insert(corners.end(), tracks.begin(), tracks.end());
  // The refinement to subpixels moves each of two by at most 2 px.
  EXPECT_GE(SmallestDistance(corners), options.min_distance_px - 4.0);
  for (const cv::Point2f& corner : corners) {
    EXPECT_GE(std::min(corner.x, corner.y), 18.0F);
    EXPECT_LE(corner.x, 376.0F - 18.0F);
    EXPECT_LE(corner.y, 240.0F - 18.0F);
  }
}

TEST(FeatureGridTest, DetectsNothingWhenThereIsNoRoomOrNoTexture) {
  FeatureGrid grid(Options(), kTracks, Scene().size());
  std::vector<cv::Point2f> corners(3);
  grid.Detect(Scene(), std::vector<cv::Point2f>(kTracks), &corners);
  EXPECT_TRUE(corners.empty());
  grid.Detect(cv::Mat(240, 376, CV_8U, cv::Scalar(77)), {}, &corners);
  EXPECT_TRUE(corners.empty());
}

// A corner that is moved by a part of a pixel is found moved by just that.
TEST(FeatureGridTest, RefinesCornersToSubpixels) {
  const auto corner_at = [](double cx, double cy) {
    cv::Mat image(160, 200, CV_8U);
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double sx = 1.0 + std::tanh((x - cx) / 1.2);
        const double sy = 1.0 + std::tanh((y - cy) / 1.2);
        image.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(20.0 + 55.0 * sx * sy);
      }
    }
    FrontendOptions options = Options();
    options.features_per_cell = 1;
    FeatureGrid grid(options, 1, image.size());
    std::vector<cv::Point2f> corners;
    grid.Detect(image, {}, &corners);
    return corners.size() == 1 ? corners[0] : cv::Point2f(-1, -1);
  };
  const cv::Point2f at_whole = corner_at(100.0, 80.0);
  EXPECT_LT(cv::norm(at_whole - cv::Point2f(100.0F, 80.0F)), 1.5);
  const cv::Point2f moved = corner_at(100.4, 79.7) - at_whole;
  // Eight bits; cornerSubPix stops at 0.01 px.
  EXPECT_NEAR(moved.x, 0.4, 0.05);
  EXPECT_NEAR(moved.y, -0.3, 0.05);
}

TEST(FeatureGridTest, MaskLetsTheFirstWin) {
  FeatureGrid grid(Options(), kTracks, cv::Size(376, 240));
  std::vector<bool> keep;
  grid.Mask({{50, 50}, {58, 50}, {66, 50}, {50, 59.9F}, {375, 239}}, 10.0, &keep);
  // The third is near the second only, which is gone.
  EXPECT_EQ(keep, (std::vector<bool>{true, false, true, false, true}));
}

}  // namespace
}  // namespace duet
