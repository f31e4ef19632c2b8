#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/measurement/calibration.h"
#include "frontend/anchor_patch.h"
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

/// Left-to-right tracking between cameras whose relation is told and whose images are turned little
/// against one another.
///
/// A point that was matched before is looked for where that depth says. A new one is searched along
/// its epipolar curve, by the correlation of a small patch in a halved image, and must have one
/// best place there: repeated texture is no match. Either is then tracked as an affine patch,
/// normalized in brightness and contrast (AnchorPatch; the two cameras expose differently), and
/// back. What is found must lie within stereo_epipolar_px of the curve, in front of both cameras
/// and not nearer than stereo_min_depth_m.
class StereoMatcher {
 public:
  StereoMatcher(const FrontendOptions& options, const CameraCalibration& first,
                const CameraCalibration& other);

  /// One result a query, in their order; nothing where there is no match.
  void Match(const ImagePyramid& first, const ImagePyramid& other,
             std::span<const StereoQuery> queries,
             std::vector<std::optional<StereoMatch>>* matches);

 private:
  /// Raw pixel in the other camera of the query's point at that inverse depth.
  [[nodiscard]] std::optional<cv::Point2f> Place(const StereoQuery& query,
                                                 double inverse_depth) const;
  [[nodiscard]] std::optional<cv::Point2f> Search(const cv::Mat& first, const cv::Mat& other,
                                                  const StereoQuery& query);
  [[nodiscard]] std::optional<StereoMatch> Track(const cv::Mat& first, const cv::Mat& other,
                                                 const StereoQuery& query, cv::Point2f start);
  [[nodiscard]] std::optional<StereoMatch> Verify(const StereoQuery& query,
                                                  cv::Point2f found) const;

  FrontendOptions options_;
  CameraModel other_model_;
  Eigen::Matrix3d R_C1C0_;
  Eigen::Vector3d p_C1C0_;           // C0's origin in C1, m
  double pixels_per_inverse_depth_;  // disparity of 1/m, about
  PatchShape shape_;
  // Scratch.
  AnchorPatch patch_;
  AnchorPatch patch_back_;
  std::vector<float> scores_;
  std::vector<cv::Point2f> places_;
};

}  // namespace duet
