#include "frontend/klt_tracker.h"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

#include "common/support/logging.h"

namespace duet {

const cv::Mat& LevelOf(const ImagePyramid& pyramid, int level) {
  // OpenCV interleaves images and derivatives.
  return pyramid.at(std::min(2 * static_cast<std::size_t>(level), pyramid.size() - 2));
}

void KltTracker::BuildPyramid(const cv::Mat& image, ImagePyramid* pyramid) const {
  const int window = 2 * options_.klt_half_window_px + 1;
  cv::buildOpticalFlowPyramid(image, *pyramid, cv::Size(window, window), options_.klt_levels - 1,
                              /*withDerivatives=*/true, cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT,
                              /*tryReuseInputImage=*/false);
}

void KltTracker::Track(const ImagePyramid& from, const ImagePyramid& to,
                       const std::vector<cv::Point2f>& points_from, double forward_backward_px,
                       std::vector<cv::Point2f>* points_to, std::vector<FlowStatus>* status) {
  CHECK_EQ(points_from.size(), points_to->size());
  status->assign(points_from.size(), FlowStatus::kNotFound);
  if (points_from.empty()) return;
  const int window = 2 * options_.klt_half_window_px + 1;
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS,
                                  options_.klt_iterations, options_.klt_epsilon_px);
  start_ = *points_to;
  cv::calcOpticalFlowPyrLK(from, to, points_from, *points_to, found_, cv::noArray(),
                           cv::Size(window, window), options_.klt_levels - 1, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  back_.resize(points_from.size());
  for (std::size_t i = 0; i < points_from.size(); ++i) {
    back_[i] = points_from[i] + (*points_to)[i] - start_[i];
  }
  cv::calcOpticalFlowPyrLK(to, from, *points_to, back_, found_back_, cv::noArray(),
                           cv::Size(window, window), options_.klt_levels - 1, criteria,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  for (std::size_t i = 0; i < points_from.size(); ++i) {
    if (!found_[i]) continue;
    const double miss_px = cv::norm(back_[i] - points_from[i]);
    (*status)[i] = found_back_[i] && miss_px <= forward_backward_px ? FlowStatus::kTracked
                                                                    : FlowStatus::kBackwardMismatch;
  }
}

}  // namespace duet
