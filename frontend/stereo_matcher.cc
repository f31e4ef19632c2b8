#include "frontend/stereo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace duet {
namespace {

constexpr double kFirstInverseDepth = 0.3;  // 1/m; a room, before anything is known

// The inverse depth in C0 whose projection lies nearest to ray_1 in the plane z = 1 of C1, to first
// order in rho exact: x_1 ~ R ray_0 + rho p, both numerators linear in rho.
double TriangulateInverseDepth(const Eigen::Vector3d& ray_R, const Eigen::Vector3d& p,
                               const Eigen::Vector3d& ray_1) {
  // (ray_R + rho p) x ray_1 = 0 in its first two rows.
  const Eigen::Vector3d a = p.cross(ray_1);
  const Eigen::Vector3d b = ray_R.cross(ray_1);
  return -a.head<2>().dot(b.head<2>()) / a.head<2>().squaredNorm();
}

}  // namespace

StereoMatcher::StereoMatcher(const FrontendOptions& options, const CameraCalibration& first,
                             const CameraCalibration& other)
    : options_(options),
      other_model_(other.model),
      R_C1C0_((other.R_CB * first.R_CB.conjugate()).toRotationMatrix()),
      p_C1C0_(other.p_CB - R_C1C0_ * first.p_CB),
      focal_px_(0.5 * (other.model.parameters()[0] + other.model.parameters()[1])),
      border_px_(options.border_px) {}

double StereoMatcher::GuessInverseDepth(std::span<const StereoQuery> queries,
                                        std::size_t index) const {
  if (queries[index].inverse_depth) return *queries[index].inverse_depth;
  // The three nearest that were matched before; the middle one of their depths.
  struct Neighbour {
    float distance_squared;
    double inverse_depth;
  };
  std::array<Neighbour, 3> nearest;
  nearest.fill({1e30F, kFirstInverseDepth});
  for (const StereoQuery& query : queries) {
    if (!query.inverse_depth) continue;
    const cv::Point2f apart = query.point - queries[index].point;
    Neighbour candidate{apart.dot(apart), *query.inverse_depth};
    for (Neighbour& held : nearest) {
      if (candidate.distance_squared < held.distance_squared) std::swap(candidate, held);
    }
  }
  std::array<double, 3> depths;
  for (std::size_t i = 0; i < 3; ++i) depths[i] = nearest[i].inverse_depth;
  std::sort(depths.begin(), depths.end());
  return depths[1];
}

std::optional<StereoMatch> StereoMatcher::Verify(const StereoQuery& query,
                                                 cv::Point2f found) const {
  const Eigen::Vector2d uv(found.x, found.y);
  if (!other_model_.Contains(uv, -border_px_)) return std::nullopt;
  const std::optional<Eigen::Vector3d> ray_1 = other_model_.Unproject(uv);
  if (!ray_1) return std::nullopt;
  const Eigen::Vector3d ray_R = R_C1C0_ * query.ray;
  const double inverse_depth = TriangulateInverseDepth(ray_R, p_C1C0_, *ray_1);
  // Far points scatter around zero; beyond that a point behind the camera is a wrong match.
  const double noise = 2.0 * options_.stereo_epipolar_px / (focal_px_ * p_C1C0_.norm());
  if (inverse_depth > 1.0 / options_.stereo_min_depth_m || inverse_depth < -noise) {
    return std::nullopt;
  }
  Eigen::Vector2d expected;
  const Eigen::Vector3d on_curve = ray_R + inverse_depth * p_C1C0_;
  if (!other_model_.Project(on_curve, &expected)) return std::nullopt;
  if ((expected - uv).norm() > options_.stereo_epipolar_px) return std::nullopt;
  return StereoMatch{found, inverse_depth};
}

void StereoMatcher::Match(const ImagePyramid& first, const ImagePyramid& other,
                          std::span<const StereoQuery> queries, KltTracker* tracker,
                          std::vector<std::optional<StereoMatch>>* matches) {
  matches->assign(queries.size(), std::nullopt);
  points_.clear();
  found_.clear();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    points_.push_back(queries[i].point);
    const double inverse_depth = std::max(0.0, GuessInverseDepth(queries, i));
    Eigen::Vector2d guess(queries[i].point.x, queries[i].point.y);
    (void)other_model_.Project(R_C1C0_ * queries[i].ray + inverse_depth * p_C1C0_, &guess);
    found_.emplace_back(static_cast<float>(guess.x()), static_cast<float>(guess.y()));
  }
  tracker->Track(first, other, points_, options_.stereo_forward_backward_px, &found_, &status_);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (status_[i] == FlowStatus::kTracked) (*matches)[i] = Verify(queries[i], found_[i]);
  }
}

}  // namespace duet
