#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "common/support/random.h"
#include "experiments/simulation/world/world.h"

namespace duet {

/// A landmark of a scene: a place on a surface, or a point at rest.
struct ScenePoint {
  int surface = -1;                                ///< -1: a point at rest, p_G
  Eigen::Vector2d uv_m = Eigen::Vector2d::Zero();  ///< on the surface
  Eigen::Vector3d p_G = Eigen::Vector3d::Zero();   ///< m, where it was when drawn
};

/// Where simulated tracks have their points.
class Scene {
 public:
  virtual ~Scene() = default;
  /// A landmark that a camera at `origin_G` sees along a (not normalized) direction at an instant
  /// of the simulation; nothing where it finds none, e.g. on a bare wall.
  [[nodiscard]] virtual std::optional<ScenePoint> Draw(const Eigen::Vector3d& origin_G,
                                                       const Eigen::Vector3d& direction_G,
                                                       double t_s, Random* random) const = 0;
  /// Where the landmark is at an instant.
  [[nodiscard]] virtual Eigen::Vector3d PositionAt(const ScenePoint& point, double t_s) const = 0;
  /// False where something stands between.
  [[nodiscard]] virtual bool Sees(const Eigen::Vector3d& origin_G, const ScenePoint& point,
                                  double t_s) const = 0;
};

/// Points on the walls of a box and, `clutter_share` of them, between walls and camera: nothing
/// hides anything. Made for Monte-Carlo: every pixel has its point.
class BoxScene final : public Scene {
 public:
  BoxScene(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double clutter_share)
      : low_(low), high_(high), clutter_share_(clutter_share) {}

  /// CHECKs that the origin is in the box.
  [[nodiscard]] std::optional<ScenePoint> Draw(const Eigen::Vector3d& origin_G,
                                               const Eigen::Vector3d& direction_G, double t_s,
                                               Random* random) const override;
  [[nodiscard]] Eigen::Vector3d PositionAt(const ScenePoint& point, double t_s) const override;
  [[nodiscard]] bool Sees(const Eigen::Vector3d& origin_G, const ScenePoint& point,
                          double t_s) const override;

 private:
  Eigen::Vector3d low_, high_;
  double clutter_share_;
};

/// The surfaces of a world, those that move too, with occlusion; a surface takes a landmark with
/// the probability of its corner_density.
class WorldScene final : public Scene {
 public:
  explicit WorldScene(std::shared_ptr<const World> world) : world_(std::move(world)) {}

  [[nodiscard]] std::optional<ScenePoint> Draw(const Eigen::Vector3d& origin_G,
                                               const Eigen::Vector3d& direction_G, double t_s,
                                               Random* random) const override;
  [[nodiscard]] Eigen::Vector3d PositionAt(const ScenePoint& point, double t_s) const override;
  [[nodiscard]] bool Sees(const Eigen::Vector3d& origin_G, const ScenePoint& point,
                          double t_s) const override;

 private:
  std::shared_ptr<const World> world_;
};

}  // namespace duet
