#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "frontend/frontend_options.h"

namespace duet {

/// An image's pyramid with its derivatives, built once and used as the target, then as the
/// template.
using ImagePyramid = std::vector<cv::Mat>;

/// The image of a level, 0 the original; the coarsest one where there are fewer.
[[nodiscard]] const cv::Mat& LevelOf(const ImagePyramid& pyramid, int level);

enum class FlowStatus : unsigned char { kTracked, kNotFound, kBackwardMismatch };

/// Sparse pyramidal Lucas-Kanade flow with a forward-backward check.
class KltTracker {
 public:
  explicit KltTracker(const FrontendOptions& options) : options_(options) {}

  void BuildPyramid(const cv::Mat& image, ImagePyramid* pyramid) const;

  /// Finds in `to` what lies at `points_from` in `from`, starting at `points_to`, which it
  /// replaces. The way back starts from a guess that knows nothing of the way there:
  /// points_from + (found - start). Points that are lost keep some value; see `status`.
  void Track(const ImagePyramid& from, const ImagePyramid& to,
             const std::vector<cv::Point2f>& points_from, double forward_backward_px,
             std::vector<cv::Point2f>* points_to, std::vector<FlowStatus>* status);

 private:
  FrontendOptions options_;
  std::vector<cv::Point2f> back_;  // scratch
  std::vector<cv::Point2f> start_;
  std::vector<unsigned char> found_;
  std::vector<unsigned char> found_back_;
};

}  // namespace duet
