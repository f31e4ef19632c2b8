#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "experiments/simulation/world/noise.h"
#include "experiments/simulation/world/texture.h"

namespace duet {

/// A rectangle of a canvas, m.
struct Area {
  double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;

  [[nodiscard]] double width() const { return x1 - x0; }
  [[nodiscard]] double height() const { return y1 - y0; }
  [[nodiscard]] double center_x() const { return 0.5 * (x0 + x1); }
  [[nodiscard]] double center_y() const { return 0.5 * (y0 + y1); }
  [[nodiscard]] Area Inset(double d) const { return {x0 + d, y0 + d, x1 - d, y1 - d}; }
  /// The part from fractions (fx0, fy0) to (fx1, fy1).
  [[nodiscard]] Area Part(double fx0, double fy0, double fx1, double fy1) const {
    return {x0 + fx0 * width(), y0 + fy0 * height(), x0 + fx1 * width(), y0 + fy1 * height()};
  }
};

/// Grey levels (float, 0 black to 255 white) on a grid, painted in metres: x to the right, y up, as
/// somebody sees it who stands before it. All shapes have edges that are smooth over
/// kEdgeTexels texels, so that the texture is band-limited and its corners stay where they are
/// whatever the view. What is painted depends on metres alone, not on the texel.
class Canvas {
 public:
  static constexpr double kEdgeTexels = 1.6;

  /// `area` says which part of a plane it shows.
  Canvas(const Area& area, double texel_m, double grey);

  [[nodiscard]] const Area& area() const { return area_; }
  [[nodiscard]] double texel_m() const { return texel_m_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Replaces every grey g whose texel centre (x, y) is in `area` by f(g, x, y).
  template <typename F>
  void Map(const Area& area, F f);
  /// The same with noise: f(g, n), n in [-1, 1].
  template <typename F>
  void MapNoise(const Area& area, FractalNoise noise, F f);
  /// Adds `amplitude` times noise.
  void AddNoise(const Area& area, const FractalNoise& noise, double amplitude);
  /// Multiplies by 1 + `amplitude` times noise.
  void ScaleNoise(const Area& area, const FractalNoise& noise, double amplitude);
  /// Multiplies by a map given on `columns` x `rows` places, cell centres over the whole canvas,
  /// interpolated between them.
  void Shade(const std::vector<float>& map, int columns, int rows);

  void Fill(const Area& area, double grey, double opacity = 1.0);
  /// From `grey_low` at the bottom to `grey_high` at the top.
  void FillGradient(const Area& area, double grey_low, double grey_high);
  /// An outline of `area`, inside of it.
  void Frame(const Area& area, double thickness_m, double grey, double opacity = 1.0);
  /// A rectangle of half sizes (hx, hy) turned by `angle` [rad], its corners rounded.
  void FillTurned(double x, double y, double hx, double hy, double angle, double grey,
                  double opacity = 1.0, double corner_radius_m = 0.0);
  void FillDisc(double x, double y, double radius_m, double grey, double opacity = 1.0);
  void FillRing(double x, double y, double radius_m, double thickness_m, double grey,
                double opacity = 1.0);
  /// A convex polygon, corners counter-clockwise.
  struct Point {
    double x, y;
  };
  void FillConvex(const std::vector<Point>& corners, double grey, double opacity = 1.0);
  void Line(double xa, double ya, double xb, double yb, double thickness_m, double grey,
            double opacity = 1.0);
  /// A soft-edged darkening (strength > 0) or lightening of a turned rectangle: 1 - strength
  /// inside, fading over `fade_m` outside of it.
  void Shadow(double x, double y, double hx, double hy, double angle, double fade_m,
              double strength);
  /// Stroked capital letters, digits and "-./!" from (x, y), the left end of the base line.
  void Text(double x, double y, double height_m, std::string_view text, double grey,
            double weight = 0.14);
  [[nodiscard]] static double TextWidth(double height_m, std::string_view text);

  /// Rounded to whole grey levels; what is brighter than 200 is compressed to stay below 250, as a
  /// camera's response does, so that nothing burns out.
  [[nodiscard]] Texture ToTexture() const;

 private:
  struct Span {
    int x0, x1, y0, y1;
  };
  [[nodiscard]] Span Texels(const Area& area) const;
  // What reaches the canvas's edge goes on beyond: the last texels are cut by it.
  [[nodiscard]] Area Extended(const Area& area) const;
  [[nodiscard]] double CenterX(int j) const { return area_.x0 + (j + 0.5) * texel_m_; }
  [[nodiscard]] double CenterY(int i) const { return area_.y0 + (i + 0.5) * texel_m_; }
  /// The part of a texel that is inside, from the signed distance to the edge (negative inside).
  [[nodiscard]] float Coverage(double distance_m) const {
    return std::clamp(static_cast<float>(0.5 - distance_m / (kEdgeTexels * texel_m_)), 0.0f, 1.0f);
  }
  /// Blends `grey` where the signed distance f(x, y) is negative; `bounds` holds the shape.
  template <typename F>
  void FillShape(const Area& bounds, double grey, double opacity, F distance);

  Area area_;
  double texel_m_;
  int width_, height_;
  std::vector<float> grey_;
};

template <typename F>
void Canvas::Map(const Area& area, F f) {
  const Span span = Texels(area);
  for (int i = span.y0; i < span.y1; ++i) {
    float* row = grey_.data() + static_cast<std::size_t>(i) * width_;
    const auto y = static_cast<float>(CenterY(i));
    for (int j = span.x0; j < span.x1; ++j) {
      row[j] = f(row[j], static_cast<float>(CenterX(j)), y);
    }
  }
}

template <typename F>
void Canvas::MapNoise(const Area& area, FractalNoise noise, F f) {
  const Span span = Texels(area);
  if (span.x0 >= span.x1) return;
  noise.SetColumns(CenterX(span.x0), texel_m_, span.x1 - span.x0);
  for (int i = span.y0; i < span.y1; ++i) {
    float* row = grey_.data() + static_cast<std::size_t>(i) * width_ + span.x0;
    const float* n = noise.Row(CenterY(i)).data();
    for (int j = 0; j < span.x1 - span.x0; ++j) row[j] = f(row[j], n[j]);
  }
}

template <typename F>
void Canvas::FillShape(const Area& bounds, double grey, double opacity, F distance) {
  const Span span = Texels(bounds.Inset(-kEdgeTexels * texel_m_));
  for (int i = span.y0; i < span.y1; ++i) {
    float* row = grey_.data() + static_cast<std::size_t>(i) * width_;
    const double y = CenterY(i);
    for (int j = span.x0; j < span.x1; ++j) {
      const float a = static_cast<float>(opacity) * Coverage(distance(CenterX(j), y));
      row[j] += a * (static_cast<float>(grey) - row[j]);
    }
  }
}

}  // namespace duet
