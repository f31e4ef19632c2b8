#include "experiments/simulation/world/illumination.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace duet {
namespace {

// As large as the sun seems, and hazy.
constexpr double kSunDistance_m = 120.0;
constexpr double kSunSize_m = 1.4;

// Whether the segment from `a` along `d` (all of it: t in 0..1) enters a box around the origin.
bool Enters(const Eigen::Vector3d& a, const Eigen::Vector3d& d, const Eigen::Vector3d& half) {
  double near = 0.0;
  double far = 1.0;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(d[i]) < 1e-12) {
      if (std::abs(a[i]) >= half[i]) return false;
      continue;
    }
    const double t0 = (-half[i] - a[i]) / d[i];
    const double t1 = (half[i] - a[i]) / d[i];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return near < far - 1e-9;
}

// Distance from a box around the origin, negative inside.
double Distance(const Eigen::Vector3d& p, const Eigen::Vector3d& half) {
  const Eigen::Vector3d q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

}  // namespace

void Illumination::AddBlocker(const Pose& T_G_box, const Eigen::Vector3d& low,
                              const Eigen::Vector3d& high) {
  const Eigen::Vector3d half = 0.5 * (high - low);
  blockers_.push_back({T_G_box * Eigen::Vector3d(0.5 * (low + high)), half,
                       T_G_box.R.toRotationMatrix().transpose(), half.norm()});
}

void Illumination::SetInside(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  inside_ = true;
  low_ = low;
  high_ = high;
}

void Illumination::AddLamp(const Eigen::Vector3d& p_G, double size_m, double power,
                           double range_m) {
  lamps_.push_back({p_G, size_m, power, range_m});
}

void Illumination::SetSun(const Eigen::Vector3d& direction_to_sun, double power) {
  to_sun_ = direction_to_sun.normalized();
  sun_power_ = power;
}

Illumination::Indices Illumination::Between(const Eigen::Vector3d& center, double radius,
                                            const Eigen::Vector3d& target, double size) const {
  Indices between;
  const Eigen::Vector3d d = target - center;
  const double length2 = d.squaredNorm();
  for (std::size_t k = 0; k < blockers_.size(); ++k) {
    const Eigen::Vector3d offset = blockers_[k].center - center;
    const double t = std::clamp(offset.dot(d) / length2, 0.0, 1.0);
    const double reach = blockers_[k].radius + radius + size;
    if ((offset - t * d).squaredNorm() < reach * reach) between.push_back(static_cast<int>(k));
  }
  return between;
}

Illumination::Neighbours Illumination::Find(const Eigen::Vector3d& center, double radius) const {
  Neighbours neighbours;
  for (std::size_t k = 0; k < blockers_.size(); ++k) {
    const double reach = 2.0 * reach_m_ + blockers_[k].radius + radius;
    if ((center - blockers_[k].center).squaredNorm() < reach * reach) {
      neighbours.near.push_back(static_cast<int>(k));
    }
  }
  for (const Lamp& lamp : lamps_) {
    neighbours.between.push_back(Between(center, radius, lamp.p, lamp.size));
  }
  neighbours.between.push_back(
      sun_power_ > 0.0 ? Between(center, radius, center + kSunDistance_m * to_sun_, kSunSize_m)
                       : Indices());
  return neighbours;
}

// Along the normal the distance to the nearest thing is the way gone where nothing is near, and
// less beside a neighbour (I. Quilez, "Ambient occlusion from distance fields").
double Illumination::Openness(const Eigen::Vector3d& p_G, const Eigen::Vector3d& normal,
                              const Indices& near) const {
  constexpr std::array<double, 4> kSteps = {0.12, 0.3, 0.6, 1.0};
  constexpr std::array<double, 4> kWeights = {0.28, 0.28, 0.24, 0.2};
  std::array<double, 4> distance;
  for (std::size_t k = 0; k < kSteps.size(); ++k) {
    distance[k] = reach_m_ * kSteps[k];
    if (!inside_) continue;
    const Eigen::Vector3d p = p_G + distance[k] * normal;
    distance[k] = std::min({distance[k], (p - low_).minCoeff(), (high_ - p).minCoeff()});
  }
  for (const int index : near) {
    const Blocker& blocker = blockers_[index];
    const double reach = 2.0 * reach_m_ + blocker.radius;
    const Eigen::Vector3d offset = p_G - blocker.center;
    if (offset.squaredNorm() > reach * reach) continue;
    const Eigen::Vector3d start = blocker.R_box_G * offset;
    const Eigen::Vector3d along = blocker.R_box_G * normal;
    for (std::size_t k = 0; k < kSteps.size(); ++k) {
      distance[k] =
          std::min(distance[k], Distance(start + reach_m_ * kSteps[k] * along, blocker.half));
    }
  }
  double closed = 0.0;
  for (std::size_t k = 0; k < kSteps.size(); ++k) {
    const double step = reach_m_ * kSteps[k];
    closed += kWeights[k] * std::clamp((step - distance[k]) / step, 0.0, 1.0);
  }
  return 1.0 - closed;
}

double Illumination::Visible(const Eigen::Vector3d& p_G, const Eigen::Vector3d& target, double size,
                             const Indices& between) const {
  constexpr std::array<std::array<double, 2>, 5> kPlaces = {
      {{0.0, 0.0}, {0.9, 0.35}, {-0.35, 0.9}, {-0.9, -0.35}, {0.35, -0.9}}};
  const Eigen::Vector3d d = target - p_G;
  const double length2 = d.squaredNorm();
  const Eigen::Vector3d side = size * d.unitOrthogonal();
  const Eigen::Vector3d other = d.cross(side) / std::sqrt(length2);
  std::array<bool, kPlaces.size()> seen;
  seen.fill(true);
  for (const int index : between) {
    const Blocker& blocker = blockers_[index];
    const Eigen::Vector3d to_center = blocker.center - p_G;
    const double t = std::clamp(to_center.dot(d) / length2, 0.0, 1.0);
    const double reach = blocker.radius + size * t;
    if ((to_center - t * d).squaredNorm() > reach * reach) continue;
    const Eigen::Vector3d start = blocker.R_box_G * -to_center;
    for (std::size_t k = 0; k < kPlaces.size(); ++k) {
      if (!seen[k]) continue;
      const Eigen::Vector3d ray = d + kPlaces[k][0] * side + kPlaces[k][1] * other;
      if (Enters(start, blocker.R_box_G * ray, blocker.half)) seen[k] = false;
    }
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / kPlaces.size();
}

double Illumination::At(const Eigen::Vector3d& p_G, const Eigen::Vector3d& normal,
                        const Neighbours& neighbours) const {
  const double up = 0.5 + 0.5 * normal.z();
  const double open = Openness(p_G, normal, neighbours.near);
  double light = (above_ * up + below_ * (1.0 - up)) * (0.25 + 0.75 * open);
  const Eigen::Vector3d start = p_G + 1e-3 * normal;
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    const Lamp& lamp = lamps_[k];
    const Eigen::Vector3d d = lamp.p - start;
    const double distance = d.norm();
    const double ratio = distance / lamp.range;
    const double most = lamp.power * d.dot(normal) / distance / (1.0 + ratio * ratio);
    if (most < 0.004) continue;  // less than a grey level
    light += most * Visible(start, lamp.p, lamp.size, neighbours.between[k]);
  }
  const double sun = sun_power_ * to_sun_.dot(normal);
  if (sun > 0.0) {
    light += sun * Visible(start, start + kSunDistance_m * to_sun_, kSunSize_m,
                           neighbours.between.back());
  }
  return light;
}

std::vector<float> Illumination::Map(const Grid& grid, const Eigen::Vector3d& normal) const {
  constexpr int kTile = 12;  // cells that share their neighbours
  std::vector<float> light(static_cast<std::size_t>(grid.columns) * grid.rows);
  for (int y0 = 0; y0 < grid.rows; y0 += kTile) {
    const int y1 = std::min(y0 + kTile, grid.rows);
    for (int x0 = 0; x0 < grid.columns; x0 += kTile) {
      const int x1 = std::min(x0 + kTile, grid.columns);
      const Eigen::Vector3d center =
          grid.origin + 0.5 * (x0 + x1 - 1) * grid.x_step + 0.5 * (y0 + y1 - 1) * grid.y_step;
      const double radius =
          0.5 * std::hypot((x1 - x0) * grid.x_step.norm(), (y1 - y0) * grid.y_step.norm());
      const Neighbours neighbours = Find(center, radius);
      for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
          light[static_cast<std::size_t>(y) * grid.columns + x] = static_cast<float>(
              At(grid.origin + x * grid.x_step + y * grid.y_step, normal, neighbours));
        }
      }
    }
  }
  return light;
}

}  // namespace duet
