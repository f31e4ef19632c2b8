#include "experiments/simulation/world/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/support/logging.h"

namespace duet {
namespace {

// The axes of a box's six faces, u x v pointing outwards.
struct Face {
  int u, v;   // axes of the box
  bool high;  // on the high side of the third axis
};
// u x v is the third axis for (0, 1), (1, 2) and (2, 0), and its negative for the swapped pairs.
constexpr std::array<Face, 6> kFaces = {
    {{1, 2, true}, {2, 1, false}, {2, 0, true}, {0, 2, false}, {0, 1, true}, {1, 0, false}}};

double Fraction(double x) { return x - std::floor(x); }

// Where the number-th face begins in a texture that is larger than it: spread evenly (the R2
// sequence, steps of the plastic number's powers), so that no two boxes look alike.
Eigen::Vector2d OriginInTexture(const Texture& texture, const Surface& face, std::size_t number) {
  constexpr double kStepU = 0.7548776662466927;
  constexpr double kStepV = 0.5698402909980532;
  const auto& level = texture.levels().front();
  const double n = static_cast<double>(number);
  const double spare_u = std::max(0.0, level.width * texture.texel_m() - face.width_m);
  const double spare_v = std::max(0.0, level.height * texture.texel_m() - face.height_m);
  return {spare_u * Fraction(kStepU * n), spare_v * Fraction(kStepV * n)};
}

}  // namespace

int World::AddTexture(Texture texture) {
  textures_.push_back(std::move(texture));
  return static_cast<int>(textures_.size()) - 1;
}

int World::AddBody(Motion T_G_body) {
  motions_.push_back(std::move(T_G_body));
  trees_.emplace_back();
  return static_cast<int>(motions_.size());
}

int World::AddSurface(const Surface& surface) {
  CHECK_GT(surface.width_m, 0.0);
  CHECK_GT(surface.height_m, 0.0);
  CHECK_LT(std::abs(surface.u_axis.squaredNorm() - 1.0), 1e-9) << "u_axis is no unit vector";
  CHECK_LT(std::abs(surface.v_axis.squaredNorm() - 1.0), 1e-9) << "v_axis is no unit vector";
  CHECK_LT(std::abs(surface.u_axis.dot(surface.v_axis)), 1e-9) << "axes at no right angle";
  CHECK_GE(surface.body, 0);
  CHECK_LT(surface.body, body_count());
  const int index = static_cast<int>(surfaces_.size());
  surfaces_.push_back(surface);
  trees_[static_cast<std::size_t>(surface.body)].Insert(index, surface);
  return index;
}

void World::AddBox(const Pose& pose, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                   const Surface& surface) {
  CHECK((high - low).minCoeff() > 0.0) << "a box without inside";
  for (const Face& face : kFaces) {
    const int w = 3 - face.u - face.v;
    Eigen::Vector3d corner = low;
    corner[w] = face.high ? high[w] : low[w];
    Surface side = surface;
    side.corner = pose * corner;
    side.u_axis = (pose.R * Eigen::Vector3d::Unit(face.u)).normalized();
    side.v_axis = (pose.R * Eigen::Vector3d::Unit(face.v)).normalized();
    side.width_m = high[face.u] - low[face.u];
    side.height_m = high[face.v] - low[face.v];
    side.two_sided = false;
    if (surface.texture < static_cast<int>(textures_.size())) {
      side.texture_origin_m += OriginInTexture(textures_[static_cast<std::size_t>(surface.texture)],
                                               side, surfaces_.size());
    }
    AddSurface(side);
  }
  AddSolid(surface.body, pose, low, high);
}

void World::AddSolid(int body, const Pose& pose, const Eigen::Vector3d& low,
                     const Eigen::Vector3d& high) {
  CHECK((high - low).minCoeff() > 0.0) << "a box without inside";
  CHECK_GE(body, 0);
  CHECK_LT(body, body_count());
  solids_.push_back({body, pose, low, high});
}

void World::SetBounds(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  CHECK((high - low).minCoeff() > 0.0);
  low_ = low;
  high_ = high;
}

World World::Scaled(double factor) const {
  CHECK_GT(factor, 0.0);
  World scaled(name_);
  for (const Texture& texture : textures_) {
    scaled.textures_.push_back(texture);
    scaled.textures_.back().set_texel_m(factor * texture.texel_m());
  }
  for (const Motion& motion : motions_) {
    scaled.AddBody([motion, factor](double t_s) {
      Pose T_G_body = motion(t_s);
      T_G_body.p *= factor;
      return T_G_body;
    });
  }
  for (Surface surface : surfaces_) {
    surface.corner *= factor;
    surface.width_m *= factor;
    surface.height_m *= factor;
    surface.texture_origin_m *= factor;
    scaled.AddSurface(surface);
  }
  for (Solid solid : solids_) {
    solid.T_body_box.p *= factor;
    solid.low *= factor;
    solid.high *= factor;
    scaled.solids_.push_back(solid);
  }
  scaled.low_ = factor * low_;
  scaled.high_ = factor * high_;
  return scaled;
}

Pose World::BodyPose(int body, double t_s) const {
  return body == 0 ? Pose{} : motions_[static_cast<std::size_t>(body - 1)](t_s);
}

std::vector<Pose> World::BodyPoses(double t_s) const {
  std::vector<Pose> poses(1);
  poses.reserve(motions_.size() + 1);
  for (const Motion& motion : motions_) poses.push_back(motion(t_s));
  return poses;
}

std::optional<WorldHit> World::Cast(const Eigen::Vector3d& origin_G,
                                    const Eigen::Vector3d& direction_G,
                                    std::span<const Pose> T_G_body) const {
  CHECK_EQ(T_G_body.size(), trees_.size());
  WorldHit hit;
  hit.distance_m = std::numeric_limits<double>::infinity();
  trees_[0].Cast(origin_G, direction_G, &hit);
  for (std::size_t body = 1; body < trees_.size(); ++body) {
    const Eigen::Quaterniond R_body_G = T_G_body[body].R.conjugate();
    trees_[body].Cast(R_body_G * (origin_G - T_G_body[body].p), R_body_G * direction_G, &hit);
  }
  if (hit.surface < 0) return std::nullopt;
  return hit;
}

std::optional<WorldHit> World::Cast(const Eigen::Vector3d& origin_G,
                                    const Eigen::Vector3d& direction_G, double t_s) const {
  if (motions_.empty()) {
    const Pose at_rest;
    return Cast(origin_G, direction_G, std::span<const Pose>(&at_rest, 1));
  }
  return Cast(origin_G, direction_G, BodyPoses(t_s));
}

Eigen::Vector3d World::PointInGlobal(int surface, const Eigen::Vector2d& uv_m, double t_s) const {
  const Surface& s = surfaces_[static_cast<std::size_t>(surface)];
  const Eigen::Vector3d p_body = s.corner + uv_m.x() * s.u_axis + uv_m.y() * s.v_axis;
  return s.body == 0 ? p_body : BodyPose(s.body, t_s) * p_body;
}

bool World::IsFree(const Eigen::Vector3d& p_G, double margin_m, double t_s) const {
  if ((p_G.array() < low_.array()).any() || (p_G.array() > high_.array()).any()) return false;
  for (const Solid& solid : solids_) {
    const Eigen::Vector3d p_body =
        solid.body == 0 ? p_G : BodyPose(solid.body, t_s).Inverse() * p_G;
    const Eigen::Vector3d p_box = solid.T_body_box.Inverse() * p_body;
    const Eigen::Vector3d beyond = (solid.low - p_box).cwiseMax(p_box - solid.high).cwiseMax(0.0);
    const double distance_m = beyond.norm();
    if (distance_m == 0.0 || distance_m < margin_m) return false;
  }
  return true;
}

}  // namespace duet
