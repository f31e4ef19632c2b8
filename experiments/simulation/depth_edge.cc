#include "experiments/simulation/depth_edge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace duet {
namespace {

// Depths along the optical axis that differ by less than this share are no jump (a poster on a
// wall).
constexpr double kSmallJump = 0.005;

// A ray that goes through the very border of two surfaces.
constexpr double kTouching = 1e-9;

struct Look {
  Eigen::Vector3d ray_C;  // (x, y, 1)
  double depth_m;
  int surface;
};

class Caster {
 public:
  Caster(const TrueCamera& truth, int camera, Timestamp stamp, const Eigen::Vector2d& uv)
      : world_(truth.world()), model_(truth.model(camera)) {
    const double t_s = truth.TimeOf(camera, stamp, uv);
    T_CG_ = truth.PoseAt(camera, t_s);
    T_GC_ = T_CG_.Inverse();
    bodies_ = world_.BodyPoses(t_s);
  }

  [[nodiscard]] std::optional<Look> At(const Eigen::Vector2d& uv) const {
    const auto ray_C = model_.Unproject(uv);
    if (!ray_C) return std::nullopt;
    const auto hit = world_.Cast(T_GC_.p, (T_GC_.R * *ray_C).normalized(), bodies_);
    if (!hit) return std::nullopt;
    return Look{*ray_C, hit->distance_m / ray_C->norm(), hit->surface};
  }

  // True where what is seen changes from one surface to another that does not touch it here.
  //
  // Surfaces that meet between two rays change places in front: the plane that is nearer along one
  // ray is farther along the other (a corner of a room), or the other way round (an edge of a box).
  // One that merely hides another would hide it along both.
  [[nodiscard]] bool Jumps(const Look& a, const Look& b) const {
    if (a.surface == b.surface) return false;
    if (SurfaceOf(a).body != SurfaceOf(b).body) return true;
    const double at_a = PlaneInverseDepth(b.surface, a.ray_C) * a.depth_m - 1.0;
    const double at_b = 1.0 - PlaneInverseDepth(a.surface, b.ray_C) * b.depth_m;
    if (std::abs(at_a) < kSmallJump && std::abs(at_b) < kSmallJump) return false;
    if (std::min(std::abs(at_a), std::abs(at_b)) < kTouching) return false;
    return (at_a > 0.0) == (at_b > 0.0);
  }

 private:
  [[nodiscard]] const Surface& SurfaceOf(const Look& look) const {
    return world_.surfaces()[static_cast<std::size_t>(look.surface)];
  }
  [[nodiscard]] double PlaneInverseDepth(int index, const Eigen::Vector3d& ray_C) const {
    const Surface& surface = world_.surfaces()[static_cast<std::size_t>(index)];
    const Pose T_C_body = T_CG_ * bodies_[static_cast<std::size_t>(surface.body)];
    const Eigen::Vector3d n = T_C_body.R * surface.u_axis.cross(surface.v_axis);
    return n.dot(ray_C) / n.dot(T_C_body * surface.corner);
  }

  const World& world_;
  const CameraModel& model_;
  Pose T_CG_, T_GC_;
  std::vector<Pose> bodies_;
};

}  // namespace

bool NearDepthEdge(const TrueCamera& truth, int camera, Timestamp stamp, const Eigen::Vector2d& uv,
                   double radius_px) {
  constexpr int kDirections = 12;
  const int steps = static_cast<int>(std::ceil(radius_px / 1.25));
  const Caster caster(truth, camera, stamp, uv);
  const auto center = caster.At(uv);
  if (!center) return true;
  for (int direction = 0; direction < kDirections; ++direction) {
    const double angle = 2.0 * std::numbers::pi * direction / kDirections;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    Look before = *center;
    for (int step = 1; step <= steps; ++step) {
      const auto look = caster.At(uv + (radius_px * step / steps) * along);
      if (!look || caster.Jumps(before, *look)) return true;
      before = *look;
    }
  }
  return false;
}

}  // namespace duet
