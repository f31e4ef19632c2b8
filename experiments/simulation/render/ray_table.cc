#include "experiments/simulation/render/ray_table.h"

#include <limits>

namespace duet {
namespace {

Eigen::Vector2f RayAt(const CameraModel& model, double u, double v) {
  const auto ray = model.Unproject({u, v});
  if (!ray) return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
  return ray->head<2>().cast<float>();
}

}  // namespace

RayTable::RayTable(const CameraModel& model)
    : width_(model.width_px()), height_(model.height_px()) {
  const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  centers_.reserve(pixels);
  corners_.reserve(pixels + static_cast<std::size_t>(width_ + height_ + 1));
  valid_.reserve(pixels);
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) centers_.push_back(RayAt(model, u, v));
  }
  for (int v = 0; v <= height_; ++v) {
    for (int u = 0; u <= width_; ++u) corners_.push_back(RayAt(model, u - 0.5, v - 0.5));
  }
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      const PixelRays rays = At(u, v);
      const Eigen::Vector2f sum =
          rays.center + rays.low_low + rays.high_low + rays.low_high + rays.high_high;
      valid_.push_back(sum.allFinite() ? 1 : 0);
    }
  }
}

RayBox RayTable::BoxOf(const Tile& tile) const {
  RayBox box;
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  // the greatest extent of one
  for (int v = tile.v; v < tile.v + tile.height; ++v) {
    for (int u = tile.u; u < tile.u + tile.width; ++u) {
      if (!valid(u, v)) continue;
      const PixelRays pixel_rays = At(u, v);
      RayBox extent(pixel_rays.low_low);
      extent.extend(pixel_rays.high_low);
      extent.extend(pixel_rays.low_high);
      extent.extend(pixel_rays.high_high);
      box.extend(extent);
      pixel = pixel.cwiseMax(extent.sizes());
    }
  }
  if (!box.isEmpty()) {
    box.min() -= pixel;
    box.max() += pixel;
  }
  return box;
}

}  // namespace duet
