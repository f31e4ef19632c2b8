#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/camera/camera_model.h"

namespace duet {

/// A rectangle of pixels.
struct Tile {
  int u = 0, v = 0;  ///< first pixel
  int width = 0, height = 0;
};

/// Rays (x, y) of a part of the image: all of its rays lie in the box.
using RayBox = Eigen::AlignedBox2f;

/// The rays of a pixel and how they change over it. Rays are (x, y) of the direction (x, y, 1).
struct PixelRays {
  Eigen::Vector2f center;
  Eigen::Vector2f low_low, high_low, low_high, high_high;  ///< corners, named by (u, v)

  [[nodiscard]] Eigen::Vector2f ByU() const {  ///< d ray / d u, 1/px
    return 0.5F * ((high_low - low_low) + (high_high - low_high));
  }
  [[nodiscard]] Eigen::Vector2f ByV() const {
    return 0.5F * ((low_high - low_low) + (high_high - high_low));
  }
  /// The ray `du`, `dv` in [-0.5, 0.5] px from the centre. Between the corners and the centre by a
  /// bilinear surface and a bump that is zero in the corners; the rest is of third order: below
  /// 2.5e-3 px up to 70 degrees off the axis for focal lengths from 95 px on.
  [[nodiscard]] Eigen::Vector2f At(float du, float dv) const {
    const float u = du + 0.5F;
    const float v = dv + 0.5F;
    const Eigen::Vector2f low = low_low + u * (high_low - low_low);
    const Eigen::Vector2f high = low_high + u * (high_high - low_high);
    const Eigen::Vector2f mean = 0.25F * ((low_low + high_high) + (high_low + low_high));
    return low + v * (high - low) + (1.0F - 2.0F * (du * du + dv * dv)) * (center - mean);
  }
};

/// The ray of every pixel's centre and corners by CameraModel::Unproject, made once a camera. In
/// float: 1e-7 of a ray of length 1 is 5e-5 px at a focal length of 460 px.
class RayTable {
 public:
  explicit RayTable(const CameraModel& model);

  [[nodiscard]] int width_px() const { return width_; }
  [[nodiscard]] int height_px() const { return height_; }
  /// False where centre or a corner has no ray: the pixel is black.
  [[nodiscard]] bool valid(int u, int v) const { return valid_[Index(u, v, width_)] != 0; }
  [[nodiscard]] PixelRays At(int u, int v) const {
    const std::size_t low = Index(u, v, width_ + 1);
    const std::size_t high = low + static_cast<std::size_t>(width_ + 1);
    return {centers_[Index(u, v, width_)], corners_[low], corners_[low + 1], corners_[high],
            corners_[high + 1]};
  }
  /// The ray at (u - 0.5, v - 0.5), not finite where there is none.
  [[nodiscard]] const Eigen::Vector2f& Corner(int u, int v) const {
    return corners_[Index(u, v, width_ + 1)];
  }
  /// The box of a tile's rays, widened by a pixel; empty where no pixel of it is valid.
  [[nodiscard]] RayBox BoxOf(const Tile& tile) const;

 private:
  static std::size_t Index(int u, int v, int width) {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }

  int width_;
  int height_;
  std::vector<Eigen::Vector2f> centers_;  // width x height
  std::vector<Eigen::Vector2f> corners_;  // (width + 1) x (height + 1), at (u - 0.5, v - 0.5)
  std::vector<std::uint8_t> valid_;
};

}  // namespace duet
