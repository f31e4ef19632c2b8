#include "frontend/overlay.h"

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/support/input_error.h"

namespace duet {
namespace {

// Viridis at nine equal steps (van der Walt and Smith, 2015), red green blue.
constexpr std::array<std::array<int, 3>, 9> kViridis = {{{68, 1, 84},
                                                         {71, 44, 122},
                                                         {59, 81, 139},
                                                         {44, 113, 142},
                                                         {33, 144, 141},
                                                         {39, 173, 129},
                                                         {92, 200, 99},
                                                         {170, 220, 50},
                                                         {253, 231, 37}}};
constexpr int kShift = 3;  // drawing in eighths of a pixel

cv::Scalar Color(double share) {
  const double position = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const std::size_t index = std::min(static_cast<std::size_t>(position), kViridis.size() - 2);
  const double w = position - static_cast<double>(index);
  const auto channel = [&](std::size_t c) {
    return (1.0 - w) * kViridis[index][c] + w * kViridis[index + 1][c];
  };
  return {channel(2), channel(1), channel(0)};
}

cv::Point Shifted(cv::Point2f point) {
  constexpr float kOne = 1 << kShift;
  return {cvRound(point.x * kOne), cvRound(point.y * kOne)};
}

}  // namespace

TrackOverlay::TrackOverlay(int tail_frames, int full_age)
    : tail_frames_(std::max(1, tail_frames)), full_age_(std::max(1, full_age)) {}

void TrackOverlay::Add(const TrackFrameSet& frames) {
  for (const TrackFrame& frame : frames.frames) {
    std::map<std::uint64_t, Tail>& tails = tails_[frame.camera];
    std::map<std::uint64_t, Tail> alive;
    for (const TrackObservation& observation : frame.observations) {
      Tail& tail = alive[observation.track_id];
      if (const auto before = tails.find(observation.track_id); before != tails.end()) {
        tail = std::move(before->second);
        ++tail.age;
      }
      tail.points.emplace_back(observation.u, observation.v);
      if (tail.points.size() > static_cast<std::size_t>(tail_frames_)) {
        tail.points.erase(tail.points.begin());
      }
    }
    tails = std::move(alive);
  }
}

cv::Mat TrackOverlay::Draw(int camera, const cv::Mat& image) const {
  cv::Mat canvas;
  if (image.empty()) {
    canvas = cv::Mat(480, 752, CV_8UC3, cv::Scalar(0, 0, 0));
  } else {
    cv::cvtColor(image, canvas, cv::COLOR_GRAY2BGR);
  }
  const auto tails = tails_.find(camera);
  if (tails == tails_.end()) return canvas;
  for (const auto& [id, tail] : tails->second) {
    const cv::Scalar color = Color(static_cast<double>(tail.age) / full_age_);
    for (std::size_t i = 1; i < tail.points.size(); ++i) {
      cv::line(canvas, Shifted(tail.points[i - 1]), Shifted(tail.points[i]), color, 1, cv::LINE_AA,
               kShift);
    }
    // A white ring keeps the dark new ones visible on dark ground.
    const cv::Point center = Shifted(tail.points.back());
    cv::circle(canvas, center, 4 << kShift, cv::Scalar(255, 255, 255), 1, cv::LINE_AA, kShift);
    cv::circle(canvas, center, 3 << kShift, color, cv::FILLED, cv::LINE_AA, kShift);
  }
  return canvas;
}

cv::Mat TrackOverlay::DrawAll(const std::vector<cv::Mat>& images) const {
  std::vector<cv::Mat> drawn;
  int height = 0;
  int width = 0;
  for (std::size_t camera = 0; camera < images.size(); ++camera) {
    drawn.push_back(Draw(static_cast<int>(camera), images[camera]));
    height = std::max(height, drawn.back().rows);
    width += drawn.back().cols;
  }
  cv::Mat all(height, width, CV_8UC3, cv::Scalar(0, 0, 0));
  int x = 0;
  for (const cv::Mat& one : drawn) {
    one.copyTo(all(cv::Rect(x, 0, one.cols, one.rows)));
    x += one.cols;
  }
  return all;
}

void SaveOverlay(const std::string& path, const cv::Mat& overlay) {
  bool written = false;
  try {
    written = cv::imwrite(path, overlay);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw OutputError(path, "the overlay could not be written");
}

}  // namespace duet
