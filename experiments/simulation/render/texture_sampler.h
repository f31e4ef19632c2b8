#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "experiments/simulation/world/texture.h"

namespace duet {

/// Where a pixel falls in a texture and what it covers there to first order, in texels of level 0.
struct TextureFootprint {
  float u, v;
  float u_by_x, v_by_x;  ///< per pixel to the right
  float u_by_y, v_by_y;  ///< per pixel down
};

/// log2 by exponent and mantissa: continuous, exact at powers of two, at most 0.086 too small.
[[nodiscard]] inline float CoarseLog2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return static_cast<float>(bits) * 0x1.0p-23F - 127.0F;
}

/// Bilinear between the centres of a level's texels, edge texels going on; u, v in its texels,
/// weights in steps of 2^-12.
[[nodiscard]] inline float SampleLevel(const Texture::Level& level, float u, float v) {
  constexpr int kBits = 12;  // 8 bits of grey and two weights of 12 just fit 32 bits
  constexpr std::uint32_t kOne = 1U << kBits;
  const float x = std::clamp(u - 0.5F, 0.0F, static_cast<float>(level.width - 1));
  const float y = std::clamp(v - 0.5F, 0.0F, static_cast<float>(level.height - 1));
  const auto x_fixed = static_cast<std::int32_t>(static_cast<float>(kOne) * x);
  const auto y_fixed = static_cast<std::int32_t>(static_cast<float>(kOne) * y);
  const std::int32_t x0 = x_fixed >> kBits;
  const std::int32_t y0 = y_fixed >> kBits;
  const std::uint32_t fx = static_cast<std::uint32_t>(x_fixed) & (kOne - 1);
  const std::uint32_t fy = static_cast<std::uint32_t>(y_fixed) & (kOne - 1);
  const std::ptrdiff_t right = x0 + 1 < level.width ? 1 : 0;
  const std::uint8_t* upper =
      level.texels.data() + static_cast<std::ptrdiff_t>(y0) * level.width + x0;
  const std::uint8_t* lower = upper + (y0 + 1 < level.height ? level.width : 0);
  const std::uint32_t top = upper[0] * (kOne - fx) + upper[right] * fx;
  const std::uint32_t bottom = lower[0] * (kOne - fx) + lower[right] * fx;
  const std::uint32_t sum = top * (kOne - fy) + bottom * fy;
  // Half of it fits a signed integer, whose conversion is the fast one.
  return static_cast<float>(static_cast<std::int32_t>(sum >> 1)) * 0x1.0p-23F;
}

/// Trilinear: between the two levels whose texels are next to 2^lod texels of level 0.
[[nodiscard]] inline float SampleTrilinear(const Texture& texture, float u, float v, float lod) {
  const auto& levels = texture.levels();
  const auto last = static_cast<float>(levels.size() - 1);
  if (!(lod > 0.0F)) return SampleLevel(levels.front(), u, v);
  if (lod >= last) lod = last;
  const int fine = static_cast<int>(lod);
  const float share = lod - static_cast<float>(fine);
  // 2^-fine.
  const float scale = std::bit_cast<float>(static_cast<std::uint32_t>(127 - fine) << 23);
  const float value = SampleLevel(levels[fine], scale * u, scale * v);
  if (share == 0.0F) return value;
  const float half = 0.5F * scale;
  return value + share * (SampleLevel(levels[fine + 1], half * u, half * v) - value);
}

/// The mean of the texture over a footprint. Its extent across decides about the mip level, up to
/// `max_probes` samples side by side cover its extent along (as hardware's anisotropic filters do);
/// beyond that the level goes up. Samples lie symmetric to (u, v), so that nothing is shifted.
/// `lod_bias` takes that many levels more: softer.
[[nodiscard]] inline float SampleFootprint(const Texture& texture, const TextureFootprint& f,
                                           int max_probes, float lod_bias = 0.0F) {
  // The footprint is the ellipse J J' with J = (by_x, by_y): its axes by closed form.
  const float uu = f.u_by_x * f.u_by_x + f.u_by_y * f.u_by_y;
  const float vv = f.v_by_x * f.v_by_x + f.v_by_y * f.v_by_y;
  const float uv = f.u_by_x * f.v_by_x + f.u_by_y * f.v_by_y;
  const float half_sum = 0.5F * (uu + vv);
  const float half_difference = 0.5F * (uu - vv);
  const float root = std::sqrt(half_difference * half_difference + uv * uv);
  const float major2 = half_sum + root;
  const float minor2 = std::max(half_sum - root, 1e-12F);
  // Up to a third longer than wide counts as round (up to twice, where there are but two probes); a
  // texel's own extent hides shorter ones.
  const float covered2 = std::max(minor2, 1.0F);
  const float round2 = max_probes <= 2 ? 4.0F : 1.75F;
  if (max_probes <= 1 || major2 <= round2 * covered2) {
    return SampleTrilinear(texture, f.u, f.v, 0.5F * CoarseLog2(major2) + lod_bias);
  }
  const int probes =
      std::min(max_probes, static_cast<int>(std::ceil(std::sqrt(major2 / covered2))));
  const auto count = static_cast<float>(probes);
  const float lod = 0.5F * CoarseLog2(std::max(minor2, major2 / (count * count))) + lod_bias;
  // The direction along: eigenvector of the greater eigenvalue, by the better conditioned row.
  float along_u = half_difference >= 0.0F ? root + half_difference : uv;
  float along_v = half_difference >= 0.0F ? uv : root - half_difference;
  const float scale =
      std::sqrt(major2 / std::max(along_u * along_u + along_v * along_v, 1e-30F)) / count;
  along_u *= scale;
  along_v *= scale;
  float sum = 0.0F;
  for (int i = 0; i < probes; ++i) {
    const float place = static_cast<float>(i) - 0.5F * (count - 1.0F);
    sum += SampleTrilinear(texture, f.u + place * along_u, f.v + place * along_v, lod);
  }
  return sum / count;
}

/// The same by 2 x 2 samples of half the extent, each three quarters of a level softer. One sample
/// a pixel leaves the detail between one and two texels of the finer level to chance: a sharp
/// border wanders by up to 0.05 px with its place among the pixels. Here it stays within 0.02 px,
/// and fine detail has about the contrast that it has with one sample: 0.28 at half a cycle a
/// pixel, as through a good lens (the bare pixel has 0.64).
[[nodiscard]] inline float SampleFootprintByFour(const Texture& texture, const TextureFootprint& f,
                                                 int max_probes) {
  TextureFootprint quarter = {
      f.u, f.v, 0.5F * f.u_by_x, 0.5F * f.v_by_x, 0.5F * f.u_by_y, 0.5F * f.v_by_y};
  float sum = 0.0F;
  for (const float x : {-0.25F, 0.25F}) {
    for (const float y : {-0.25F, 0.25F}) {
      quarter.u = f.u + x * f.u_by_x + y * f.u_by_y;
      quarter.v = f.v + x * f.v_by_x + y * f.v_by_y;
      sum += SampleFootprint(texture, quarter, max_probes, 0.75F);
    }
  }
  return 0.25F * sum;
}

}  // namespace duet
