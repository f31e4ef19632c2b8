#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/se3.h"
#include "experiments/simulation/world/surface_tree.h"
#include "experiments/simulation/world/texture.h"

namespace duet {

/// A textured rectangle: points corner + u u_axis + v v_axis for 0 <= u <= width_m, 0 <= v <=
/// height_m in the frame of its body; seen from the side that `u_axis x v_axis` points to, or from
/// both.
struct Surface {
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d u_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v_axis = Eigen::Vector3d::UnitY();
  double width_m = 1.0;
  double height_m = 1.0;
  bool two_sided = false;
  int body = 0;                                                ///< 0: the world at rest
  int texture = 0;                                             ///< index into World::textures()
  Eigen::Vector2d texture_origin_m = Eigen::Vector2d::Zero();  ///< of the corner in the texture
  double brightness = 1.0;  ///< multiplies the texture: its light
  /// How much a corner detector finds on it, 0 (a bare wall) to 1; for simulated tracks.
  double corner_density = 1.0;
};

/// Where a ray meets the world first.
struct WorldHit {
  double distance_m = 0.0;
  int surface = -1;
  Eigen::Vector2d uv_m = Eigen::Vector2d::Zero();  ///< place on the surface
};

/// A place made of textured rectangles, some of which move (walkers, cars): what the cameras of a
/// simulation see, the same for rendered images and for simulated tracks. G: z up, m.
class World {
 public:
  /// Where a body is at an instant of the simulation [s]; smooth.
  using Motion = std::function<Pose(double t_s)>;

  explicit World(std::string name) : name_(std::move(name)) {}

  int AddTexture(Texture texture);
  /// Returns the body's number, 1 for the first. `T_G_body` is called from several threads.
  int AddBody(Motion T_G_body);
  /// CHECKs that the axes are unit vectors at a right angle and that the body is there.
  int AddSurface(const Surface& surface);
  /// A closed box of body `surface.body` with low corner `low` and high corner `high` in the frame
  /// `pose` of it: six surfaces that look outwards, and a solid that no camera may be in. Texture,
  /// brightness and density are `surface`'s; each face begins elsewhere in the texture.
  void AddBox(const Pose& pose, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
              const Surface& surface);
  /// The solid alone, for a box whose faces are added one by one.
  void AddSolid(int body, const Pose& pose, const Eigen::Vector3d& low,
                const Eigen::Vector3d& high);
  /// The box outside of which no camera may be.
  void SetBounds(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

  /// The same world with all lengths, those of texels too, `factor` times as large.
  [[nodiscard]] World Scaled(double factor) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<Surface>& surfaces() const { return surfaces_; }
  [[nodiscard]] const std::vector<Texture>& textures() const { return textures_; }
  [[nodiscard]] int body_count() const { return static_cast<int>(motions_.size()) + 1; }
  [[nodiscard]] Pose BodyPose(int body, double t_s) const;      ///< T_G_body
  [[nodiscard]] std::vector<Pose> BodyPoses(double t_s) const;  ///< all, the world at rest first
  [[nodiscard]] const Eigen::Vector3d& low() const { return low_; }
  [[nodiscard]] const Eigen::Vector3d& high() const { return high_; }

  /// The first surface along a ray (unit direction), nothing where there is none.
  [[nodiscard]] std::optional<WorldHit> Cast(const Eigen::Vector3d& origin_G,
                                             const Eigen::Vector3d& direction_G, double t_s) const;
  /// The same with the bodies' poses at hand (BodyPoses): quicker for many rays of one instant.
  [[nodiscard]] std::optional<WorldHit> Cast(const Eigen::Vector3d& origin_G,
                                             const Eigen::Vector3d& direction_G,
                                             std::span<const Pose> T_G_body) const;
  [[nodiscard]] Eigen::Vector3d PointInGlobal(int surface, const Eigen::Vector2d& uv_m,
                                              double t_s) const;
  /// True where a point is within the bounds and at least `margin_m` outside of every solid.
  [[nodiscard]] bool IsFree(const Eigen::Vector3d& p_G, double margin_m, double t_s) const;

 private:
  struct Solid {
    int body;
    Pose T_body_box;
    Eigen::Vector3d low, high;
  };
  std::string name_;
  std::vector<Texture> textures_;
  std::vector<Surface> surfaces_;
  std::vector<Motion> motions_;
  std::vector<SurfaceTree> trees_{1};  // one a body, in its frame
  std::vector<Solid> solids_;
  Eigen::Vector3d low_ = Eigen::Vector3d::Constant(-1e9);
  Eigen::Vector3d high_ = Eigen::Vector3d::Constant(1e9);
};

}  // namespace duet
