#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se3.h"

namespace duet {

/// The light that falls on a place of a world at rest, for baking into textures: light from all
/// around, weaker in corners and at the foot of boxes; lamps and the sun with soft shadows. 1 is
/// what a texture's grey is meant for. Not physics: smooth, cheap and believable.
class Illumination {
 public:
  /// Something that stands in the light.
  void AddBlocker(const Pose& T_G_box, const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  /// The inside of the place: its walls, floor and ceiling take light away from each other's
  /// corners.
  void SetInside(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  /// Light from above and from below (reflected).
  void SetAmbient(double above, double below) {
    above_ = above;
    below_ = below;
  }
  /// How far around a place others darken it [m].
  void SetOcclusionReach(double reach_m) { reach_m_ = reach_m; }
  /// A lamp that gives `power` to a surface that faces it from near and half of it at `range_m`.
  void AddLamp(const Eigen::Vector3d& p_G, double size_m, double power, double range_m);
  void SetSun(const Eigen::Vector3d& direction_to_sun, double power);

  /// A grid of places on a flat surface: origin + i x_step + j y_step, 0 <= i < columns.
  struct Grid {
    Eigen::Vector3d origin, x_step, y_step;
    int columns, rows;
  };
  /// The light on the side of the surface that `normal` points to, by rows.
  [[nodiscard]] std::vector<float> Map(const Grid& grid, const Eigen::Vector3d& normal) const;

 private:
  struct Blocker {
    Eigen::Vector3d center, half;
    Eigen::Matrix3d R_box_G;
    double radius;
  };
  struct Lamp {
    Eigen::Vector3d p;
    double size, power, range;
  };
  using Indices = std::vector<int>;
  // The blockers that matter to places within `radius` of a centre: those near by, and for each
  // lamp and at last the sun those between.
  struct Neighbours {
    Indices near;
    std::vector<Indices> between;
  };
  [[nodiscard]] Neighbours Find(const Eigen::Vector3d& center, double radius) const;
  [[nodiscard]] Indices Between(const Eigen::Vector3d& center, double radius,
                                const Eigen::Vector3d& target, double size) const;
  [[nodiscard]] double At(const Eigen::Vector3d& p_G, const Eigen::Vector3d& normal,
                          const Neighbours& neighbours) const;
  [[nodiscard]] double Openness(const Eigen::Vector3d& p_G, const Eigen::Vector3d& normal,
                                const Indices& near) const;
  // The share of the rays from p to places around `target` that meet none of the blockers.
  [[nodiscard]] double Visible(const Eigen::Vector3d& p_G, const Eigen::Vector3d& target,
                               double size, const Indices& between) const;

  std::vector<Blocker> blockers_;
  std::vector<Lamp> lamps_;
  bool inside_ = false;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d high_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d to_sun_ = Eigen::Vector3d::UnitZ();
  double sun_power_ = 0.0;
  double above_ = 0.7;
  double below_ = 0.5;
  double reach_m_ = 0.8;
};

}  // namespace duet
