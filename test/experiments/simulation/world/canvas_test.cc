#include "experiments/simulation/world/canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "experiments/simulation/world/noise.h"

namespace duet {
namespace {

double Sum(const Texture& texture) {
  double sum = 0.0;
  for (const std::uint8_t texel : texture.levels().front().texels) sum += texel;
  return sum;
}

int At(const Texture& texture, int x, int y) {
  const Texture::Level& level = texture.levels().front();
  return level.texels[static_cast<std::size_t>(y) * level.width + x];
}

// The area that a shape covers, from the greys: what makes its edges stay where they are.
double PaintedArea(const Canvas& canvas, double grey) {
  return Sum(canvas.ToTexture()) / grey * canvas.texel_m() * canvas.texel_m();
}

TEST(Canvas, ShapesCoverTheirAreaWhereverTheyLieOnTheGrid) {
  // Rounding to grey levels changes each texel of an edge by half a level of 200 at the most.
  for (const double shift : {0.0, 0.003, 0.0071}) {
    Canvas rectangle({0.0, 0.0, 1.0, 1.0}, 0.01, 0.0);
    rectangle.Fill({0.2 + shift, 0.3 + shift, 0.6 + shift, 0.5 + shift}, 200.0);
    EXPECT_NEAR(PaintedArea(rectangle, 200.0), 0.08, 0.0008);

    Canvas turned({0.0, 0.0, 1.0, 1.0}, 0.01, 0.0);
    turned.FillTurned(0.5 + shift, 0.5, 0.2, 0.1, 0.7, 200.0);
    EXPECT_NEAR(PaintedArea(turned, 200.0), 0.08, 0.0008);

    Canvas disc({0.0, 0.0, 1.0, 1.0}, 0.01, 0.0);
    disc.FillDisc(0.5, 0.5 + shift, 0.2, 200.0);
    EXPECT_NEAR(PaintedArea(disc, 200.0), std::numbers::pi * 0.04, 0.001);

    Canvas ring({0.0, 0.0, 1.0, 1.0}, 0.01, 0.0);
    ring.FillRing(0.5, 0.5 + shift, 0.2, 0.05, 200.0);
    EXPECT_NEAR(PaintedArea(ring, 200.0), std::numbers::pi * (0.04 - 0.0225), 0.001);

    Canvas triangle({0.0, 0.0, 1.0, 1.0}, 0.01, 0.0);
    triangle.FillConvex({{0.2 + shift, 0.2}, {0.8 + shift, 0.2}, {0.5 + shift, 0.8}}, 200.0);
    EXPECT_NEAR(PaintedArea(triangle, 200.0), 0.18, 0.001);
  }
}

TEST(Canvas, EdgesAreSmoothAndInTheMiddleOfTheirRamp) {
  Canvas canvas({0.0, 0.0, 1.0, 0.1}, 0.01, 0.0);
  canvas.Fill({0.505, 0.0, 1.0, 0.1}, 200.0);  // the edge is at the centre of texel 50
  const Texture texture = canvas.ToTexture();
  EXPECT_EQ(At(texture, 48, 5), 0);
  EXPECT_EQ(At(texture, 50, 5), 100);
  EXPECT_EQ(At(texture, 52, 5), 200);
  for (int x = 40; x < 60; ++x) {
    EXPECT_LE(At(texture, x + 1, 5) - At(texture, x, 5), 200.0 / Canvas::kEdgeTexels + 1.0);
  }
}

TEST(Canvas, WhatReachesTheEdgeCoversTheLastTexel) {
  // 1 m is no whole number of texels of 0.03 m.
  Canvas canvas({0.0, 0.0, 1.0, 1.0}, 0.03, 0.0);
  canvas.Fill(canvas.area(), 150.0);
  canvas.Map(canvas.area(), [](float g, float, float) { return g + 50.0f; });
  const Texture texture = canvas.ToTexture();
  ASSERT_EQ(texture.levels().front().width, 34);
  for (const std::uint8_t texel : texture.levels().front().texels) ASSERT_EQ(texel, 200);
}

TEST(Canvas, ShadeInterpolatesBetweenCellCentres) {
  Canvas canvas({0.0, 0.0, 1.0, 0.1}, 0.01, 100.0);
  canvas.Shade({0.5f, 1.5f}, 2, 1);
  const Texture texture = canvas.ToTexture();
  EXPECT_EQ(At(texture, 0, 5), 50);
  EXPECT_EQ(At(texture, 10, 5), 50);  // outside of the centres, 0.25 and 0.75, it goes on
  EXPECT_NEAR(At(texture, 50, 5), 101, 1);
  EXPECT_EQ(At(texture, 99, 5), 150);
}

TEST(Canvas, LettersAreInkOfTheirOwnShape) {
  const auto ink = [](const char* text) {
    Canvas canvas({0.0, 0.0, 1.0, 1.0}, 0.01, 0.0);
    canvas.Text(0.1, 0.1, 0.7, text, 200.0);
    return Sum(canvas.ToTexture());
  };
  EXPECT_EQ(ink(" "), 0.0);
  EXPECT_EQ(ink("a"), ink("A"));
  std::vector<double> sums;
  for (char letter = 'A'; letter <= 'Z'; ++letter)
    sums.push_back(ink(std::string(1, letter).c_str()));
  for (char digit = '0'; digit <= '9'; ++digit) sums.push_back(ink(std::string(1, digit).c_str()));
  for (const double sum : sums) EXPECT_GT(sum, 50000.0);
}

TEST(FractalNoise, IsTheSameFunctionForAnyPartOfThePlane) {
  FractalNoise all(7, 0.3, 4);
  FractalNoise part(7, 0.3, 4);
  all.SetColumns(-1.0, 0.01, 300);
  part.SetColumns(-1.0 + 0.01 * 120, 0.01, 50);
  for (const double y : {-0.7, -0.69, 0.0, 0.33, 0.2, 5.0}) {
    const std::vector<float> row = all.Row(y);
    const std::vector<float> cut = part.Row(y);
    // Places computed by different sums differ by rounding.
    for (int j = 0; j < 50; ++j) EXPECT_NEAR(row[120 + j], cut[j], 1e-4) << y << ' ' << j;
  }
}

TEST(FractalNoise, IsSmoothAndUsesItsRange) {
  FractalNoise noise(3, 0.5, 1);
  noise.SetColumns(0.0, 0.01, 4000);
  float low = 1.0f;
  float high = -1.0f;
  float last = 0.0f;
  for (int i = 0; i < 300; ++i) {
    const std::vector<float>& row = noise.Row(0.17 * i);
    for (std::size_t j = 0; j < row.size(); ++j) {
      low = std::min(low, row[j]);
      high = std::max(high, row[j]);
      // Between two lattice values 2 apart the steepest is 2 * 1.5 / cell.
      if (j > 0) {
        ASSERT_LE(std::abs(row[j] - last), 0.0601f);
      }
      last = row[j];
    }
  }
  EXPECT_LT(low, -0.9f);
  EXPECT_GT(high, 0.9f);
}

TEST(FractalNoise, LeavesOutWhatTheTexelCannotShow) {
  // Of octaves with cells of 0.04, 0.02, 0.01 and 0.005 only two are as large as two texels.
  FractalNoise noise(5, 0.04, 4, 1.0);
  noise.SetColumns(0.0, 0.01, 2000);
  for (int i = 0; i < 20; ++i) {
    for (const float n : noise.Row(0.01 * i)) ASSERT_LE(std::abs(n), 0.5f);
  }
}

}  // namespace
}  // namespace duet
