#include "frontend/overlay.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "common/support/input_error.h"

namespace duet {
namespace {

TrackFrameSet Frame(Timestamp t, std::vector<TrackObservation> observations) {
  return {t, {{t, 0, std::move(observations)}}};
}

TEST(TrackOverlayTest, ColoursByAgeAndForgetsTracksThatEnd) {
  TrackOverlay overlay(5, 10);
  for (int i = 0; i <= 10; ++i) {
    std::vector<TrackObservation> seen = {{1, 30.0F + static_cast<float>(i), 40.0F}};
    if (i < 5) seen.push_back({2, 100.0F, 80.0F});
    if (i == 10) seen.push_back({3, 150.0F, 60.0F});
    overlay.Add(Frame(i, seen));
  }
  const cv::Mat grey(120, 200, CV_8U, cv::Scalar(50));
  const cv::Mat drawn = overlay.Draw(0, grey);
  ASSERT_EQ(drawn.type(), CV_8UC3);
  EXPECT_EQ(drawn.size(), grey.size());
  EXPECT_EQ(drawn.at<cv::Vec3b>(40, 40), cv::Vec3b(37, 231, 253));  // old: viridis's yellow, BGR
  EXPECT_EQ(drawn.at<cv::Vec3b>(60, 150), cv::Vec3b(84, 1, 68));    // new: its violet
  EXPECT_EQ(drawn.at<cv::Vec3b>(80, 100), cv::Vec3b(50, 50, 50));   // ended
  // The tail reaches back four frames, not to the start.
  EXPECT_NE(drawn.at<cv::Vec3b>(40, 36), cv::Vec3b(50, 50, 50));
  EXPECT_EQ(drawn.at<cv::Vec3b>(40, 33), cv::Vec3b(50, 50, 50));
}

TEST(TrackOverlayTest, CamerasStandSideBySideAndAreWritten) {
  TrackOverlay overlay;
  overlay.Add({5, {{5, 0, {{1, 20.0F, 20.0F}}}, {5, 1, {{1, 15.0F, 20.0F}}}}});
  const cv::Mat grey(60, 80, CV_8U, cv::Scalar(0));
  const cv::Mat drawn = overlay.DrawAll({grey, grey});
  EXPECT_EQ(drawn.size(), cv::Size(160, 60));
  EXPECT_NE(drawn.at<cv::Vec3b>(20, 80 + 15), cv::Vec3b(0, 0, 0));
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("duet_overlay_" + std::to_string(getpid()) + ".png"))
                               .string();
  SaveOverlay(path, drawn);
  EXPECT_EQ(cv::imread(path).size(), drawn.size());
  std::filesystem::remove(path);
  EXPECT_THROW(SaveOverlay("/nonexistent/folder/a.png", drawn), OutputError);
}

}  // namespace
}  // namespace duet
