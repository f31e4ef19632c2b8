#include "experiments/simulation/render/texture_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace duet {
namespace {

// 8 bits of grey and two weights of 12 just fit 32 bits.
constexpr int kBits = 12;
constexpr std::uint32_t kOne = 1U << kBits;

// By value, and such that they are the instructions min and max (std's take references).
float Lesser(float a, float b) { return a < b ? a : b; }
float Greater(float a, float b) { return a > b ? a : b; }

// 2^-n.
float PowerOfHalf(int n) { return std::bit_cast<float>(static_cast<std::uint32_t>(127 - n) << 23); }

}  // namespace

float CoarseLog2(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  return static_cast<float>(bits) * 0x1.0p-23F - 127.0F;
}

TextureSampler::TextureSampler(const Texture& texture)
    : last_level_(static_cast<float>(texture.levels().size() - 1)) {
  for (const Texture::Level& level : texture.levels()) {
    const std::uint8_t* texels = level.texels.data();
    const int width = std::max(level.width, 2);
    const int height = std::max(level.height, 2);
    if (width != level.width || height != level.height) {
      std::vector<std::uint8_t>& doubled = widened_.emplace_back();
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          doubled.push_back(level.texels[static_cast<std::size_t>(
              std::min(y, level.height - 1) * level.width + std::min(x, level.width - 1))]);
        }
      }
      texels = doubled.data();
    }
    // One step short of the last texel, so that its neighbour beyond is never asked for.
    levels_.push_back({texels, width,
                       static_cast<float>(kOne) * static_cast<float>(width - 1) - 1.0F,
                       static_cast<float>(kOne) * static_cast<float>(height - 1) - 1.0F});
  }
}

inline float TextureSampler::AtLevel(int index, float u, float v) const {
  const Level& level = levels_[static_cast<std::size_t>(index)];
  const float x = Lesser(Greater(static_cast<float>(kOne) * (u - 0.5F), 0.0F), level.max_x);
  const float y = Lesser(Greater(static_cast<float>(kOne) * (v - 0.5F), 0.0F), level.max_y);
  const auto x_fixed = static_cast<std::int32_t>(x);
  const auto y_fixed = static_cast<std::int32_t>(y);
  const std::uint32_t fx = static_cast<std::uint32_t>(x_fixed) & (kOne - 1);
  const std::uint32_t fy = static_cast<std::uint32_t>(y_fixed) & (kOne - 1);
  const std::uint8_t* upper = level.texels + (y_fixed >> kBits) * level.width + (x_fixed >> kBits);
  const std::uint8_t* lower = upper + level.width;
  const std::uint32_t top = upper[0] * (kOne - fx) + upper[1] * fx;
  const std::uint32_t bottom = lower[0] * (kOne - fx) + lower[1] * fx;
  const std::uint32_t sum = top * (kOne - fy) + bottom * fy;
  // Half of it fits a signed integer, whose conversion is the fast one.
  return static_cast<float>(static_cast<std::int32_t>(sum >> 1)) * 0x1.0p-23F;
}

float TextureSampler::Trilinear(float u, float v, float lod) const {
  const float bounded = Lesser(Greater(lod, 0.0F), last_level_);
  const int fine = static_cast<int>(bounded);
  const float share = bounded - static_cast<float>(fine);
  const float scale = PowerOfHalf(fine);
  const float value = AtLevel(fine, scale * u, scale * v);
  if (share == 0.0F) return value;
  const float half = 0.5F * scale;
  return value + share * (AtLevel(fine + 1, half * u, half * v) - value);
}

float TextureSampler::Over(const TextureFootprint& f, int max_probes, float lod_bias) const {
  // The footprint is the ellipse J J' with J = (by_x, by_y): its axes by closed form.
  const float uu = f.u_by_x * f.u_by_x + f.u_by_y * f.u_by_y;
  const float vv = f.v_by_x * f.v_by_x + f.v_by_y * f.v_by_y;
  const float uv = f.u_by_x * f.v_by_x + f.u_by_y * f.v_by_y;
  const float half_sum = 0.5F * (uu + vv);
  const float half_difference = 0.5F * (uu - vv);
  const float root = std::sqrt(half_difference * half_difference + uv * uv);
  const float major2 = half_sum + root;
  const float minor2 = Greater(half_sum - root, 1e-12F);
  // Up to a third longer than wide counts as round (up to twice, where there are but two probes); a
  // texel's own extent hides shorter ones.
  const float covered2 = Greater(minor2, 1.0F);
  const float round2 = max_probes <= 2 ? 4.0F : 1.75F;
  if (max_probes <= 1 || major2 <= round2 * covered2) {
    return Trilinear(f.u, f.v, 0.5F * CoarseLog2(major2) + lod_bias);
  }
  const int probes =
      std::min(max_probes, static_cast<int>(std::ceil(std::sqrt(major2 / covered2))));
  const auto count = static_cast<float>(probes);
  const float lod = 0.5F * CoarseLog2(std::max(minor2, major2 / (count * count))) + lod_bias;
  // The direction along: eigenvector of the greater eigenvalue, by the better conditioned row.
  float along_u = half_difference >= 0.0F ? root + half_difference : uv;
  float along_v = half_difference >= 0.0F ? uv : root - half_difference;
  const float scale =
      std::sqrt(major2 / std::max(1e-30F, along_u * along_u + along_v * along_v)) / count;
  along_u *= scale;
  along_v *= scale;
  float sum = 0.0F;
  for (int i = 0; i < probes; ++i) {
    const float place = static_cast<float>(i) - 0.5F * (count - 1.0F);
    sum += Trilinear(f.u + place * along_u, f.v + place * along_v, lod);
  }
  return sum / count;
}

float TextureSampler::OverByFour(const TextureFootprint& f, int max_probes) const {
  TextureFootprint quarter = {
      f.u, f.v, 0.5F * f.u_by_x, 0.5F * f.v_by_x, 0.5F * f.u_by_y, 0.5F * f.v_by_y};
  float sum = 0.0F;
  for (const float x : {-0.25F, 0.25F}) {
    for (const float y : {-0.25F, 0.25F}) {
      quarter.u = f.u + x * f.u_by_x + y * f.u_by_y;
      quarter.v = f.v + x * f.v_by_x + y * f.v_by_y;
      sum += Over(quarter, max_probes, 0.75F);
    }
  }
  return 0.25F * sum;
}

}  // namespace duet
