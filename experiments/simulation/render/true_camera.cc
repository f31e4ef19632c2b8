#include "experiments/simulation/render/true_camera.h"

#include <utility>

#include "common/support/logging.h"

namespace duet {

TrueCamera::TrueCamera(RigCalibration rig, std::shared_ptr<const World> world,
                       std::shared_ptr<const Trajectory> trajectory, Timestamp start,
                       Shutter shutter)
    : MovingCamera(std::move(rig), std::move(trajectory), start, shutter),
      world_(std::move(world)) {
  CHECK(world_ != nullptr);
}

std::optional<SurfacePoint> TrueCamera::PointAt(int camera, Timestamp stamp,
                                                const Eigen::Vector2d& uv) const {
  const auto ray_C = model(camera).Unproject(uv);
  if (!ray_C) return std::nullopt;
  const double t_s = TimeOf(camera, stamp, uv);
  const Pose T_GC = PoseAt(camera, t_s).Inverse();
  const auto hit = world_->Cast(T_GC.p, (T_GC.R * *ray_C).normalized(), t_s);
  if (!hit) return std::nullopt;
  return SurfacePoint{hit->surface, hit->uv_m, hit->distance_m};
}

std::optional<Eigen::Vector2d> TrueCamera::PixelOf(int camera, Timestamp stamp,
                                                   const SurfacePoint& point) const {
  return MovingCamera::PixelOf(camera, stamp, [this, &point](double t_s) {
    return world_->PointInGlobal(point.surface, point.uv_m, t_s);
  });
}

bool TrueCamera::IsVisible(int camera, Timestamp stamp, const SurfacePoint& point,
                           const Eigen::Vector2d& uv) const {
  // Less than this apart it is the point itself, or one on a surface that meets its own.
  constexpr double kSame = 1e-4;
  const auto seen = PointAt(camera, stamp, uv);
  if (!seen) return false;
  if (seen->surface == point.surface) return true;
  const double t_s = TimeOf(camera, stamp, uv);
  const Pose T_CG = PoseAt(camera, t_s);
  const double distance_m = (T_CG * world_->PointInGlobal(point.surface, point.uv_m, t_s)).norm();
  return seen->distance_m > (1.0 - kSame) * distance_m;
}

}  // namespace duet
