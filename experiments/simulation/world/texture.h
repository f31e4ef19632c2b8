#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace duet {

/// Reflectance of a surface as grey levels on a grid of square texels, with its mip levels. Texel
/// (i, j) of level l covers [i, i + 1) x [j, j + 1) * texel_m * 2^l in the surface's (u, v), so
/// that no level is shifted against another. Outside the edge texels go on.
class Texture {
 public:
  /// Takes level 0, `width` x `height` by rows of ascending v, and makes the others by 2 x 2 means.
  Texture(int width, int height, double texel_m, std::vector<std::uint8_t> texels);

  struct Level {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> texels;
  };
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
  [[nodiscard]] double texel_m() const { return texel_m_; }
  void set_texel_m(double texel_m) { texel_m_ = texel_m; }

 private:
  double texel_m_;
  std::vector<Level> levels_;
};

}  // namespace duet
