#include "frontend/feature_grid.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace duet {
namespace {

constexpr int kFastBorder = 3;              // FAST looks at a circle of this radius
constexpr int kGradientHalfWindow = 4;      // of the gradient tensor
constexpr int kLargestShare = 2;            // a cell holds at most this many times its share
constexpr double kLargestRefinement = 2.0;  // px

// Smaller eigenvalue of the mean gradient tensor around (x, y), grey levels^2 / px^2 (Shi and
// Tomasi, 1994): how well the patch fixes a shift.
float CornerQuality(const cv::Mat& image, int x, int y) {
  int xx = 0;
  int xy = 0;
  int yy = 0;
  for (int j = y - kGradientHalfWindow; j <= y + kGradientHalfWindow; ++j) {
    const unsigned char* row = image.ptr<unsigned char>(j);
    const unsigned char* above = image.ptr<unsigned char>(j - 1);
    const unsigned char* below = image.ptr<unsigned char>(j + 1);
    for (int i = x - kGradientHalfWindow; i <= x + kGradientHalfWindow; ++i) {
      const int dx = row[i + 1] - row[i - 1];
      const int dy = below[i] - above[i];
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  const double mean = 0.5 * (static_cast<double>(xx) + yy);
  const double half_difference = 0.5 * (static_cast<double>(xx) - yy);
  const double smaller = mean - std::hypot(half_difference, static_cast<double>(xy));
  constexpr int kWidth = 2 * kGradientHalfWindow + 1;
  return static_cast<float>(smaller / (4.0 * kWidth * kWidth));
}

}  // namespace

FeatureGrid::FeatureGrid(const FrontendOptions& options, int max_tracks, cv::Size image_size)
    : options_(options), max_tracks_(max_tracks), image_size_(image_size) {
  // Corners need their surroundings for FAST, the gradient tensor and the refinement.
  options_.border_px = std::max(options_.border_px, kGradientHalfWindow + 2);
  const double cells = std::max(1.0, static_cast<double>(max_tracks) / options.features_per_cell);
  const double cell_px = std::sqrt(image_size.area() / cells);
  columns_ = std::max(1, static_cast<int>(std::lround(image_size.width / cell_px)));
  rows_ = std::max(1, static_cast<int>(std::lround(image_size.height / cell_px)));
  const std::size_t count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  thresholds_.assign(count, std::max(20, options.fast_threshold_min));
  corners_of_cell_.resize(count);
}

int FeatureGrid::CellOf(cv::Point2f point) const {
  const int column =
      std::clamp(static_cast<int>(point.x) * columns_ / image_size_.width, 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(point.y) * rows_ / image_size_.height, 0, rows_ - 1);
  return row * columns_ + column;
}

cv::Rect FeatureGrid::CellArea(int cell) const {
  // The inverse of CellOf: pixel x is in column floor(x columns / width).
  const auto first = [](int index, int count, int size) {
    return (index * size + count - 1) / count;
  };
  const int column = cell % columns_;
  const int row = cell / columns_;
  const int x0 = std::max(first(column, columns_, image_size_.width), options_.border_px);
  const int y0 = std::max(first(row, rows_, image_size_.height), options_.border_px);
  const int x1 = std::min(first(column + 1, columns_, image_size_.width),
                          image_size_.width - options_.border_px);
  const int y1 =
      std::min(first(row + 1, rows_, image_size_.height), image_size_.height - options_.border_px);
  return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

void FeatureGrid::FindCorners(const cv::Mat& image, int cell, int wanted,
                              std::vector<Corner>* corners) {
  corners->clear();
  const cv::Rect area = CellArea(cell);
  if (area.empty()) return;
  const cv::Rect searched(area.x - kFastBorder, area.y - kFastBorder, area.width + 2 * kFastBorder,
                          area.height + 2 * kFastBorder);
  int& threshold = thresholds_[static_cast<std::size_t>(cell)];
  const std::size_t fewest = static_cast<std::size_t>(4 * wanted);
  const std::size_t most = static_cast<std::size_t>(16 * wanted);
  while (true) {
    keypoints_.clear();
    cv::FAST(image(searched), keypoints_, threshold, /*nonmaxSuppression=*/true);
    if (keypoints_.size() >= fewest || threshold <= options_.fast_threshold_min) break;
    threshold = std::max(options_.fast_threshold_min, threshold * 2 / 3);
  }
  if (keypoints_.size() > most) {
    // For the next image; too many in this one only cost time.
    threshold = std::min(options_.fast_threshold_max, threshold * 5 / 4 + 1);
  }
  for (const cv::KeyPoint& keypoint : keypoints_) {
    const int x = static_cast<int>(keypoint.pt.x) + searched.x;
    const int y = static_cast<int>(keypoint.pt.y) + searched.y;
    const cv::Point2f point(static_cast<float>(x), static_cast<float>(y));
    if (!Free(point)) continue;
    const float quality = CornerQuality(image, x, y);
    if (quality >= static_cast<float>(options_.min_corner_quality)) {
      corners->push_back({point, quality});
    }
  }
  std::sort(corners->begin(), corners->end(), [](const Corner& a, const Corner& b) {
    if (a.quality != b.quality) return a.quality < b.quality;
    return a.point.y != b.point.y ? a.point.y > b.point.y : a.point.x > b.point.x;
  });
}

void FeatureGrid::Detect(const cv::Mat& image, const std::vector<cv::Point2f>& tracks,
                         std::vector<cv::Point2f>* corners) {
  corners->clear();
  int missing = max_tracks_ - static_cast<int>(tracks.size());
  if (missing <= 0) return;
  ClearOccupancy(options_.min_distance_px);
  count_of_cell_.assign(thresholds_.size(), 0);
  for (const cv::Point2f& track : tracks) {
    Occupy(track);
    ++count_of_cell_[static_cast<std::size_t>(CellOf(track))];
  }
  // Round by round, so that the poorest cells come first; beyond their share, cells take over what
  // others have no texture for.
  searched_.assign(thresholds_.size(), false);
  const int share = options_.features_per_cell;
  for (int held = 0; held < kLargestShare * share && missing > 0; ++held) {
    for (std::size_t cell = 0; cell < thresholds_.size() && missing > 0; ++cell) {
      if (count_of_cell_[cell] != held) continue;
      std::vector<Corner>& candidates = corners_of_cell_[cell];
      if (!searched_[cell]) FindCorners(image, static_cast<int>(cell), share, &candidates);
      searched_[cell] = true;
      while (!candidates.empty() && count_of_cell_[cell] == held) {
        const cv::Point2f point = candidates.back().point;
        candidates.pop_back();
        if (!Free(point)) continue;
        Occupy(point);
        corners->push_back(point);
        ++count_of_cell_[cell];
        --missing;
      }
    }
  }
  Refine(image, corners);
}

void FeatureGrid::Refine(const cv::Mat& image, std::vector<cv::Point2f>* corners) {
  const int half = options_.subpixel_half_window_px;
  if (half == 0 || corners->empty()) return;
  refined_ = *corners;
  cv::cornerSubPix(image, refined_, cv::Size(half, half), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 10, 0.01));
  for (std::size_t i = 0; i < corners->size(); ++i) {
    // One that runs away saw another corner; it is a good point to track where FAST found it.
    if (cv::norm(refined_[i] - (*corners)[i]) <= kLargestRefinement) (*corners)[i] = refined_[i];
  }
}

void FeatureGrid::Mask(const std::vector<cv::Point2f>& points, double distance_px,
                       std::vector<bool>* keep) {
  ClearOccupancy(distance_px);
  keep->assign(points.size(), true);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (Free(points[i])) {
      Occupy(points[i]);
    } else {
      (*keep)[i] = false;
    }
  }
}

void FeatureGrid::ClearOccupancy(double distance_px) {
  distance_px_ = static_cast<float>(distance_px);
  bucket_columns_ = static_cast<int>(static_cast<float>(image_size_.width) / distance_px_) + 1;
  bucket_rows_ = static_cast<int>(static_cast<float>(image_size_.height) / distance_px_) + 1;
  buckets_.resize(static_cast<std::size_t>(bucket_columns_) *
                  static_cast<std::size_t>(bucket_rows_));
  for (std::vector<cv::Point2f>& bucket : buckets_) bucket.clear();
}

cv::Point FeatureGrid::BucketOf(cv::Point2f point) const {
  return {std::clamp(static_cast<int>(point.x / distance_px_), 0, bucket_columns_ - 1),
          std::clamp(static_cast<int>(point.y / distance_px_), 0, bucket_rows_ - 1)};
}

bool FeatureGrid::Free(cv::Point2f point) const {
  const cv::Point center = BucketOf(point);
  for (int row = std::max(0, center.y - 1); row <= std::min(bucket_rows_ - 1, center.y + 1);
       ++row) {
    for (int column = std::max(0, center.x - 1);
         column <= std::min(bucket_columns_ - 1, center.x + 1); ++column) {
      for (const cv::Point2f& other :
           buckets_[static_cast<std::size_t>(row * bucket_columns_ + column)]) {
        const cv::Point2f apart = point - other;
        if (apart.dot(apart) < distance_px_ * distance_px_) return false;
      }
    }
  }
  return true;
}

void FeatureGrid::Occupy(cv::Point2f point) {
  const cv::Point bucket = BucketOf(point);
  buckets_[static_cast<std::size_t>(bucket.y * bucket_columns_ + bucket.x)].push_back(point);
}

}  // namespace duet
