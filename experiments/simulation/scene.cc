#include "experiments/simulation/scene.h"

#include <algorithm>

#include "common/support/logging.h"

namespace duet {
namespace {

// A surface this close before a landmark does not hide it, m: the landmark's own, hit within
// rounding, and frames on walls.
constexpr double kOcclusionTolerance_m = 0.01;

}  // namespace

std::optional<ScenePoint> BoxScene::Draw(const Eigen::Vector3d& origin_G,
                                         const Eigen::Vector3d& direction_G, double /*t_s*/,
                                         Random* random) const {
  const double share = random->Uniform();
  const double depth_share = random->Uniform(0.35, 0.95);
  double distance = 1e9;
  for (int i = 0; i < 3; ++i) {
    if (direction_G[i] == 0.0) continue;
    const double wall = direction_G[i] > 0.0 ? high_[i] : low_[i];
    distance = std::min(distance, (wall - origin_G[i]) / direction_G[i]);
  }
  CHECK_GT(distance, 0.0) << "the trajectory leaves the room";
  if (share < clutter_share_) distance *= depth_share;
  ScenePoint point;
  point.p_G = origin_G + distance * direction_G;
  return point;
}

Eigen::Vector3d BoxScene::PositionAt(const ScenePoint& point, double /*t_s*/) const {
  return point.p_G;
}

bool BoxScene::Sees(const Eigen::Vector3d& /*origin_G*/, const ScenePoint& /*point*/,
                    double /*t_s*/) const {
  return true;
}

std::optional<ScenePoint> WorldScene::Draw(const Eigen::Vector3d& origin_G,
                                           const Eigen::Vector3d& direction_G, double t_s,
                                           Random* random) const {
  const double share = random->Uniform();
  const auto hit = world_->Cast(origin_G, direction_G.normalized(), t_s);
  if (!hit) return std::nullopt;
  const Surface& surface = world_->surfaces()[static_cast<std::size_t>(hit->surface)];
  if (share >= surface.corner_density) return std::nullopt;
  return ScenePoint{.surface = hit->surface,
                    .uv_m = hit->uv_m,
                    .p_G = world_->PointInGlobal(hit->surface, hit->uv_m, t_s)};
}

Eigen::Vector3d WorldScene::PositionAt(const ScenePoint& point, double t_s) const {
  const Surface& surface = world_->surfaces()[static_cast<std::size_t>(point.surface)];
  if (surface.body == 0) return point.p_G;
  return world_->PointInGlobal(point.surface, point.uv_m, t_s);
}

bool WorldScene::Sees(const Eigen::Vector3d& origin_G, const ScenePoint& point, double t_s) const {
  const Eigen::Vector3d to_point = PositionAt(point, t_s) - origin_G;
  const double distance = to_point.norm();
  const auto hit = world_->Cast(origin_G, to_point / distance, t_s);
  // Nothing is hit where the ray passes the landmark's surface by its very edge, or from behind.
  return hit && hit->distance_m > distance - kOcclusionTolerance_m;
}

}  // namespace duet
