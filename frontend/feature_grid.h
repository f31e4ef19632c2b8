#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "frontend/frontend_options.h"

namespace duet {

/// FAST corners in the cells of a grid (thesis 5.3.1). Each cell has a threshold of its own, which
/// is kept from image to image and moved so that the cell yields a few times the corners that it
/// needs; only cells that lack tracks are searched. Where texture is missing in some cells, the
/// others take over what is wanted in all.
class FeatureGrid {
 public:
  /// Cells are about square, `options.features_per_cell` of `max_tracks` in each.
  FeatureGrid(const FrontendOptions& options, int max_tracks, cv::Size image_size);

  /// At most max_tracks - tracks.size() new corners, refined to subpixels, at least min_distance_px
  /// (less what the refinement moves) from `tracks` and one another, not in the border. The poorest
  /// cells get theirs first, the best corner of a cell comes first.
  void Detect(const cv::Mat& image, const std::vector<cv::Point2f>& tracks,
              std::vector<cv::Point2f>* corners);

  /// Points that come first win (hand in the oldest first): keep[i] is false for a point nearer
  /// than `distance_px` to one that is kept.
  void Mask(const std::vector<cv::Point2f>& points, double distance_px, std::vector<bool>* keep);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int CellOf(cv::Point2f point) const;

 private:
  struct Corner {
    cv::Point2f point;
    float quality;
  };

  [[nodiscard]] cv::Rect CellArea(int cell) const;
  /// The free corners of a cell, the best last.
  void FindCorners(const cv::Mat& image, int cell, int wanted, std::vector<Corner>* corners);
  void Refine(const cv::Mat& image, std::vector<cv::Point2f>* corners);

  // Occupancy: buckets as wide as the distance hold the points in them.
  void ClearOccupancy(double distance_px);
  [[nodiscard]] cv::Point BucketOf(cv::Point2f point) const;
  [[nodiscard]] bool Free(cv::Point2f point) const;
  void Occupy(cv::Point2f point);

  FrontendOptions options_;
  int max_tracks_;
  cv::Size image_size_;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<int> thresholds_;
  // Scratch.
  std::vector<int> count_of_cell_;
  std::vector<std::vector<Corner>> corners_of_cell_;
  std::vector<cv::KeyPoint> keypoints_;
  std::vector<cv::Point2f> refined_;
  std::vector<bool> searched_;
  float distance_px_ = 1.0F;
  int bucket_columns_ = 1;
  int bucket_rows_ = 1;
  std::vector<std::vector<cv::Point2f>> buckets_;
};

}  // namespace duet
