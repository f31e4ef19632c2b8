#pragma once

#include <Eigen/Core>
#include <limits>

#include "experiments/simulation/world/world.h"

namespace duet {

/// A surface as one camera pose sees it: along the ray d = (x, y, 1) its plane has the inverse
/// depth q = w'd and the place u = a'd / q, v = b'd / q on the surface [m]. With the plane n'p = h,
/// the axes e and the corner c, all in C: w = n / h, a = e_u - (e_u'c) w, b = e_v - (e_v'c) w.
struct PlaneView {
  /// Surfaces that share a border overlap by this, so that rounding opens no gap between them.
  static constexpr float kSlack_m = 5e-6F;

  Eigen::Vector3f a = Eigen::Vector3f::Zero();
  Eigen::Vector3f b = Eigen::Vector3f::Zero();
  Eigen::Vector3f w = Eigen::Vector3f::Zero();  ///< zero where its back is seen: never hit
  float width_m = 0.0F;
  float height_m = 0.0F;

  static float Dot(const Eigen::Vector3f& plane, const Eigen::Vector2f& ray) {
    return plane.x() * ray.x() + plane.y() * ray.y() + plane.z();
  }
  [[nodiscard]] float InverseDepth(const Eigen::Vector2f& ray) const { return Dot(w, ray); }
  /// For a ray of inverse depth q > 0.
  [[nodiscard]] bool Within(const Eigen::Vector2f& ray, float q) const {
    const float u = Dot(a, ray);
    const float v = Dot(b, ray);
    const float slack = kSlack_m * q;
    return u >= -slack && v >= -slack && u <= width_m * q + slack && v <= height_m * q + slack;
  }
};

/// The view of a surface from x_C = R x_body + p.
[[nodiscard]] inline PlaneView ViewOf(const Surface& surface, const Eigen::Matrix3d& R,
                                      const Eigen::Vector3d& p) {
  const Eigen::Vector3d u = R * surface.u_axis;
  const Eigen::Vector3d v = R * surface.v_axis;
  const Eigen::Vector3d n = u.cross(v);
  const Eigen::Vector3d c = R * surface.corner + p;
  const double h = n.dot(c);  // negative in front of it
  PlaneView view;
  constexpr double kInPlane_m = 1e-9;
  if (h > -kInPlane_m && !(surface.two_sided && h > kInPlane_m)) return view;
  const Eigen::Vector3d w = n / h;
  view.w = w.cast<float>();
  view.a = (u - u.dot(c) * w).cast<float>();
  view.b = (v - v.dot(c) * w).cast<float>();
  view.width_m = static_cast<float>(surface.width_m);
  view.height_m = static_cast<float>(surface.height_m);
  return view;
}

}  // namespace duet
