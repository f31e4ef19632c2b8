#include "frontend/stereo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace duet {
namespace {

constexpr int kCoarseHalf = 4;  // of the searched patch, px of the halved image
constexpr int kCoarseCount = (2 * kCoarseHalf + 1) * (2 * kCoarseHalf + 1);
constexpr float kCoarseCorrelation = 0.7F;
constexpr float kDistinct = 0.1F;  // the best place correlates so much better than the next
// The way from the guess to the match: a pixel of the halved image and what depth changes in a
// frame.
constexpr double kMaxShift = 3.0;  // px

// A patch of kCoarseCount pixels around (x, y), normalized; false where it leaves the image or is
// flat.
bool Normalized(const cv::Mat& image, int x, int y, std::array<float, kCoarseCount>* patch) {
  if (x < kCoarseHalf || y < kCoarseHalf || x >= image.cols - kCoarseHalf ||
      y >= image.rows - kCoarseHalf) {
    return false;
  }
  int sum = 0;
  int squares = 0;
  std::array<int, kCoarseCount> values;
  std::size_t k = 0;
  for (int j = -kCoarseHalf; j <= kCoarseHalf; ++j) {
    const unsigned char* row = image.ptr<unsigned char>(y + j) + x;
    for (int i = -kCoarseHalf; i <= kCoarseHalf; ++i, ++k) {
      values[k] = row[i];
      sum += values[k];
      squares += values[k] * values[k];
    }
  }
  const float mean = static_cast<float>(sum) / kCoarseCount;
  const float energy = static_cast<float>(squares) - static_cast<float>(sum) * mean;
  if (energy < kCoarseCount) return false;  // a deviation of less than a grey level
  const float scale = 1.0F / std::sqrt(energy);
  for (k = 0; k < kCoarseCount; ++k) (*patch)[k] = scale * (static_cast<float>(values[k]) - mean);
  return true;
}

// The inverse depth in C0 at which the ray's point comes nearest to ray_1 in the sense of
// (R ray_0 + rho p) x ray_1 = 0, least squares of the first two rows.
double TriangulateInverseDepth(const Eigen::Vector3d& ray_R, const Eigen::Vector3d& p,
                               const Eigen::Vector3d& ray_1) {
  const Eigen::Vector3d a = p.cross(ray_1);
  const Eigen::Vector3d b = ray_R.cross(ray_1);
  return -a.head<2>().dot(b.head<2>()) / a.head<2>().squaredNorm();
}

// Of the parabola through a score and its neighbours where it is the highest of the three, else 0:
// the grid of whole pixels cuts peaks by up to a tenth.
float PeakHeight(const std::vector<float>& scores, std::size_t i) {
  const bool inner = i > 0 && i + 1 < scores.size();
  const float before = i > 0 ? scores[i - 1] : -1.0F;
  const float after = i + 1 < scores.size() ? scores[i + 1] : -1.0F;
  if (before > scores[i] || after >= scores[i]) return 0.0F;
  if (!inner) return scores[i];
  const float slope = 0.5F * (after - before);
  return scores[i] + 0.5F * slope * slope / (2.0F * scores[i] - before - after);
}

cv::Point Halved(cv::Point2f point) { return {cvRound(0.5F * point.x), cvRound(0.5F * point.y)}; }

}  // namespace

StereoMatcher::StereoMatcher(const FrontendOptions& options, const CameraCalibration& first,
                             const CameraCalibration& other)
    : options_(options),
      other_model_(other.model),
      R_C1C0_((other.R_CB * first.R_CB.conjugate()).toRotationMatrix()),
      p_C1C0_(other.p_CB - R_C1C0_ * first.p_CB),
      pixels_per_inverse_depth_(other.model.parameters()[0] * p_C1C0_.norm()),
      shape_(options.anchor_half_window_px) {}

std::optional<cv::Point2f> StereoMatcher::Place(const StereoQuery& query,
                                                double inverse_depth) const {
  Eigen::Vector2d uv;
  if (!other_model_.Project(R_C1C0_ * query.ray + inverse_depth * p_C1C0_, &uv)) {
    return std::nullopt;
  }
  if (!other_model_.Contains(uv)) return std::nullopt;
  return cv::Point2f(static_cast<float>(uv.x()), static_cast<float>(uv.y()));
}

std::optional<cv::Point2f> StereoMatcher::Search(const cv::Mat& first, const cv::Mat& other,
                                                 const StereoQuery& query) {
  std::array<float, kCoarseCount> wanted;
  std::array<float, kCoarseCount> candidate;
  const cv::Point from = Halved(query.point);
  if (!Normalized(first, from.x, from.y, &wanted)) return std::nullopt;
  scores_.clear();
  places_.clear();
  cv::Point last(-1, -1);
  const double step = 2.0 / pixels_per_inverse_depth_;  // a pixel of the halved image
  for (double rho = 0.0; rho <= 1.0 / options_.stereo_min_depth_m; rho += step) {
    const std::optional<cv::Point2f> place = Place(query, rho);
    if (!place) continue;
    const cv::Point at = Halved(*place);
    if (at == last || !Normalized(other, at.x, at.y, &candidate)) continue;
    last = at;
    float score = 0.0F;
    for (std::size_t k = 0; k < kCoarseCount; ++k) score += wanted[k] * candidate[k];
    scores_.push_back(score);
    places_.push_back(*place);
  }
  if (scores_.empty()) return std::nullopt;
  std::size_t best = 0;
  float best_peak = 0.0F;
  for (std::size_t i = 0; i < scores_.size(); ++i) {
    const float peak = PeakHeight(scores_, i);
    if (peak > best_peak) {
      best = i;
      best_peak = peak;
    }
  }
  if (best_peak < kCoarseCorrelation) return std::nullopt;
  for (std::size_t i = 0; i < scores_.size(); ++i) {
    const cv::Point2f apart = places_[i] - places_[best];
    // Its own peak is as wide as the patch's structure, a few pixels of the halved image.
    const bool elsewhere = apart.dot(apart) > 8.0F * 8.0F;
    if (elsewhere && PeakHeight(scores_, i) > best_peak - kDistinct) return std::nullopt;
  }
  return places_[best];
}

std::optional<StereoMatch> StereoMatcher::Track(const cv::Mat& first, const cv::Mat& other,
                                                const StereoQuery& query, cv::Point2f start) {
  cv::Point2f found = start;
  if (patch_.Find(shape_, other, kMaxShift, options_.anchor_min_correlation, &found) !=
      AnchorPatch::Outcome::kFound) {
    return std::nullopt;
  }
  const std::optional<StereoMatch> match = Verify(query, found);
  if (!match || !patch_back_.Take(shape_, other, found)) return std::nullopt;
  // The way back starts as far from its goal as the way there did.
  cv::Point2f back = query.point + 0.5F * (found - start);
  if (patch_back_.Find(shape_, first, kMaxShift, options_.anchor_min_correlation, &back) !=
      AnchorPatch::Outcome::kFound) {
    return std::nullopt;
  }
  if (cv::norm(back - query.point) > options_.stereo_forward_backward_px) return std::nullopt;
  return match;
}

std::optional<StereoMatch> StereoMatcher::Verify(const StereoQuery& query,
                                                 cv::Point2f found) const {
  const Eigen::Vector2d uv(found.x, found.y);
  if (!other_model_.Contains(uv, -options_.border_px)) return std::nullopt;
  const std::optional<Eigen::Vector3d> ray_1 = other_model_.Unproject(uv);
  if (!ray_1) return std::nullopt;
  const Eigen::Vector3d ray_R = R_C1C0_ * query.ray;
  const double inverse_depth = TriangulateInverseDepth(ray_R, p_C1C0_, *ray_1);
  // Far points scatter around zero; what lies further behind the camera is a wrong match.
  const double noise = 2.0 * options_.stereo_epipolar_px / pixels_per_inverse_depth_;
  if (inverse_depth > 1.0 / options_.stereo_min_depth_m || inverse_depth < -noise) {
    return std::nullopt;
  }
  Eigen::Vector2d expected;
  if (!other_model_.Project(ray_R + inverse_depth * p_C1C0_, &expected)) return std::nullopt;
  if ((expected - uv).norm() > options_.stereo_epipolar_px) return std::nullopt;
  return StereoMatch{found, inverse_depth};
}

void StereoMatcher::Match(const ImagePyramid& first, const ImagePyramid& other,
                          std::span<const StereoQuery> queries,
                          std::vector<std::optional<StereoMatch>>* matches) {
  matches->assign(queries.size(), std::nullopt);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const StereoQuery& query = queries[i];
    if (!patch_.Take(shape_, LevelOf(first, 0), query.point)) continue;
    std::optional<StereoMatch>& match = (*matches)[i];
    if (query.inverse_depth) {
      const std::optional<cv::Point2f> start = Place(query, std::max(0.0, *query.inverse_depth));
      if (start) match = Track(LevelOf(first, 0), LevelOf(other, 0), query, *start);
    }
    if (match) continue;
    const std::optional<cv::Point2f> start = Search(LevelOf(first, 1), LevelOf(other, 1), query);
    if (start) match = Track(LevelOf(first, 0), LevelOf(other, 0), query, *start);
  }
}

}  // namespace duet
