#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/measurement/calibration.h"
#include "frontend/frontend_options.h"
#include "frontend/klt_tracker.h"

namespace duet {

/// A point of the first camera that is looked for in another.
struct StereoQuery {
  cv::Point2f point;                    ///< raw px, first camera
  Eigen::Vector3d ray;                  ///< (x, y, 1) there
  std::optional<double> inverse_depth;  ///< 1/z from an earlier match, 1/m
};

struct StereoMatch {
  cv::Point2f point;           ///< raw px, other camera
  double inverse_depth = 0.0;  ///< 1/z in the first camera, 1/m; near 0 (or below) is far away
};

/// Left-to-right tracking between cameras whose relation is told. The search starts on the epipolar
/// curve at the depth of the point's last match, else at that of the nearest neighbours that have
/// one; what is found must lie within stereo_epipolar_px of the curve, in front of both cameras and
/// not nearer than stereo_min_depth_m, and lead back.
class StereoMatcher {
 public:
  StereoMatcher(const FrontendOptions& options, const CameraCalibration& first,
                const CameraCalibration& other);

  /// One result a query, in their order; nothing where there is no match.
  void Match(const ImagePyramid& first, const ImagePyramid& other,
             std::span<const StereoQuery> queries, KltTracker* tracker,
             std::vector<std::optional<StereoMatch>>* matches);

 private:
  [[nodiscard]] double GuessInverseDepth(std::span<const StereoQuery> queries,
                                         std::size_t index) const;
  [[nodiscard]] std::optional<StereoMatch> Verify(const StereoQuery& query,
                                                  cv::Point2f found) const;

  FrontendOptions options_;
  CameraModel other_model_;
  Eigen::Matrix3d R_C1C0_;
  Eigen::Vector3d p_C1C0_;  // C0's origin in C1, m
  double focal_px_;
  double border_px_;
  std::vector<cv::Point2f> points_;  // scratch
  std::vector<cv::Point2f> found_;
  std::vector<FlowStatus> status_;
};

}  // namespace duet
