#pragma once

#include <cstdint>
#include <vector>

#include "experiments/simulation/world/texture.h"

namespace duet {

/// Where a pixel falls in a texture and what it covers there to first order, in texels of level 0.
struct TextureFootprint {
  float u, v;
  float u_by_x, v_by_x;  ///< per pixel to the right
  float u_by_y, v_by_y;  ///< per pixel down
};

/// log2 by exponent and mantissa: continuous, exact at powers of two, at most 0.086 too small.
[[nodiscard]] float CoarseLog2(float x);

/// Looks a texture up, filtered by what a pixel covers of it; grey levels.
class TextureSampler {
 public:
  /// Keeps pointers into `texture`.
  explicit TextureSampler(const Texture& texture);

  /// Bilinear between the centres of a level's texels, edge texels going on; u, v in its texels,
  /// weights in steps of 2^-12.
  [[nodiscard]] float AtLevel(int level, float u, float v) const;

  /// Trilinear: between the two levels whose texels are next to 2^lod texels of level 0; u, v in
  /// texels of level 0.
  [[nodiscard]] float Trilinear(float u, float v, float lod) const;

  /// The mean of the texture over a footprint. Its extent across decides about the mip level, up to
  /// `max_probes` samples side by side cover its extent along (as hardware's anisotropic filters
  /// do); beyond that the level goes up. Samples lie symmetric to (u, v), so that nothing is
  /// shifted. `lod_bias` takes that many levels more: softer.
  [[nodiscard]] float Over(const TextureFootprint& footprint, int max_probes,
                           float lod_bias = 0.0F) const;

  /// The same by 2 x 2 samples of half the extent, each three quarters of a level softer. One
  /// sample a pixel leaves the detail between one and two texels of the finer level to chance: a
  /// sharp border wanders by up to 0.05 px with its place among the pixels. Here it stays within
  /// 0.025 px, and fine detail has about the contrast that it has with one sample: 0.28 at half a
  /// cycle a pixel, as through a good lens (the bare pixel has 0.64).
  [[nodiscard]] float OverByFour(const TextureFootprint& footprint, int max_probes) const;

 private:
  struct Level {
    const std::uint8_t* texels;
    std::ptrdiff_t width;
    float max_x, max_y;  // of the upper left one of four texels and the weight, in 2^-12 texels
  };

  std::vector<Level> levels_;
  std::vector<std::vector<std::uint8_t>> widened_;  // levels of a single column or row, doubled
  float last_level_;
};

}  // namespace duet
