#include "experiments/simulation/world/texture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/support/random.h"
#include "experiments/simulation/render/texture_sampler.h"

namespace duet {
namespace {

Texture Ramp(int width, int height, double by_u, double by_v) {
  std::vector<std::uint8_t> texels;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      texels.push_back(
          static_cast<std::uint8_t>(std::lround(20.0 + by_u * (u + 0.5) + by_v * (v + 0.5))));
    }
  }
  return {width, height, 0.01, std::move(texels)};
}

TEST(Texture, LevelsAreMeansOfFourDownToOneTexel) {
  const Texture texture(3, 2, 0.01, {10, 20, 30, 40, 50, 61});
  ASSERT_EQ(texture.levels().size(), 3U);
  EXPECT_EQ(texture.levels()[1].width, 2);
  EXPECT_EQ(texture.levels()[1].height, 1);
  // The right pair's missing column is its edge again: (30 + 30 + 61 + 61) / 4 = 45.5, to even.
  EXPECT_EQ(texture.levels()[1].texels, (std::vector<std::uint8_t>{30, 46}));
  EXPECT_EQ(texture.levels()[2].texels, (std::vector<std::uint8_t>{38}));
}

// A slope has the same value at the same place on every level, between levels too: none is shifted.
TEST(Texture, NoLevelIsShifted) {
  const Texture texture = Ramp(256, 256, 0.5, 0.25);
  for (float lod = 0.0F; lod <= 5.0F; lod += 0.25F) {
    for (const float u : {70.3F, 128.0F, 171.9F}) {
      for (const float v : {80.1F, 150.7F}) {
        const float value = TextureSampler(texture).Trilinear(u, v, lod);
        // A shift by half a texel of level 5 would be 8 grey levels. Rounding to whole levels costs
        // up to half a level.
        EXPECT_NEAR(value, 20.0F + 0.5F * u + 0.25F * v, 0.51F) << "lod " << lod;
      }
    }
  }
}

TEST(Texture, MeanIsKeptOverLevels) {
  Random random(3);
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 128 * 128; ++i) {
    texels.push_back(static_cast<std::uint8_t>(random.UniformInt(256)));
  }
  const Texture texture(128, 128, 0.01, std::move(texels));
  double first = 0.0;
  for (const Texture::Level& level : texture.levels()) {
    double sum = 0.0;
    for (const std::uint8_t t : level.texels) sum += t;
    const double mean = sum / static_cast<double>(level.texels.size());
    if (&level == &texture.levels().front()) first = mean;
    EXPECT_NEAR(mean, first, 1.0);
  }
}

TEST(Texture, EdgeTexelsGoOn) {
  const Texture texture(2, 2, 0.01, {10, 20, 30, 40});
  EXPECT_FLOAT_EQ(TextureSampler(texture).Trilinear(-5.0F, -5.0F, 0.0F), 10.0F);
  EXPECT_NEAR(TextureSampler(texture).Trilinear(99.0F, 0.5F, 0.0F), 20.0F, 0.01F);
  EXPECT_NEAR(TextureSampler(texture).Trilinear(1.0F, 99.0F, 0.0F), 35.0F, 0.01F);
  EXPECT_FLOAT_EQ(TextureSampler(texture).Trilinear(99.0F, 99.0F, 12.0F), 25.0F);
}

// The filter is centred whatever the footprint's shape: the mean of a slope is its middle's value.
TEST(Texture, FootprintsAreCentred) {
  const Texture texture = Ramp(400, 400, 0.3, 0.2);
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    TextureFootprint f{};
    f.u = static_cast<float>(random.Uniform(120.0, 280.0));
    f.v = static_cast<float>(random.Uniform(120.0, 280.0));
    f.u_by_x = static_cast<float>(4.0 * random.Normal());
    f.v_by_x = static_cast<float>(4.0 * random.Normal());
    f.u_by_y = static_cast<float>(random.Normal());
    f.v_by_y = static_cast<float>(random.Normal());
    for (const int probes : {1, 2, 16}) {
      EXPECT_NEAR(TextureSampler(texture).Over(f, probes), 20.0F + 0.3F * f.u + 0.2F * f.v, 0.6F);
    }
  }
}

// Seen at a slant, many probes keep the stripes across the short axis that one level would blur.
TEST(Texture, ProbesKeepDetailAcrossAStretchedFootprint) {
  std::vector<std::uint8_t> texels;
  for (int v = 0; v < 256; ++v) {
    for (int u = 0; u < 256; ++u) texels.push_back(v / 4 % 2 == 0 ? 50 : 200);
  }
  const Texture texture(256, 256, 0.01, std::move(texels));
  const TextureFootprint on_stripe = {128.0F, 130.0F, 12.0F, 0.0F, 0.0F, 1.0F};
  EXPECT_NEAR(TextureSampler(texture).Over(on_stripe, 16), 50.0F, 2.0F);
  EXPECT_GT(TextureSampler(texture).Over(on_stripe, 1), 100.0F);
}

TEST(Texture, CoarseLog2) {
  EXPECT_EQ(CoarseLog2(8.0F), 3.0F);
  EXPECT_EQ(CoarseLog2(0.25F), -2.0F);
  for (float x = 0.01F; x < 1000.0F; x *= 1.03F) {
    EXPECT_LE(CoarseLog2(x), std::log2(x) + 1e-5F);
    EXPECT_GT(CoarseLog2(x), std::log2(x) - 0.0861F);
  }
}

}  // namespace
}  // namespace duet
