#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/dataset/track_stream.h"

namespace duet {

/// Tracks over the image, coloured by age from dark violet (new) to yellow (`full_age` frames and
/// older; viridis, readable for the colour-blind), each with the tail of where it was. Works from a
/// track stream alone, live or replayed.
class TrackOverlay {
 public:
  explicit TrackOverlay(int tail_frames = 12, int full_age = 60);

  /// Takes a stamp's frames, in order.
  void Add(const TrackFrameSet& frames);

  /// The newest frame's tracks of `camera` over `image` (8 bit grey, may be empty for a blank
  /// one): a colour image (BGR).
  [[nodiscard]] cv::Mat Draw(int camera, const cv::Mat& image) const;

  /// All cameras side by side.
  [[nodiscard]] cv::Mat DrawAll(const std::vector<cv::Mat>& images) const;

 private:
  struct Tail {
    int age = 0;  // frames since the first
    std::vector<cv::Point2f> points;
  };
  int tail_frames_;
  int full_age_;
  std::map<int, std::map<std::uint64_t, Tail>> tails_;  // by camera, by id: those alive
};

/// Writes a PNG. Throws OutputError.
void SaveOverlay(const std::string& path, const cv::Mat& overlay);

}  // namespace duet
