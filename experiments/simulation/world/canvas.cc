#include "experiments/simulation/world/canvas.h"

#include <array>
#include <cctype>
#include <utility>

#include "common/support/logging.h"

namespace duet {
namespace {

// Strokes of a letter on a grid of 4 x 6: pairs of digits are points, a space lifts the pen.
std::string_view Glyph(char letter) {
  static constexpr std::array<std::string_view, 26> kLetters = {"002640 1232",
                                                                "00063645443303 3342413000",
                                                                "4536160501103041",
                                                                "00062645412000",
                                                                "46060040 0333",
                                                                "460600 0333",
                                                                "45361605011030414323",
                                                                "0600 4640 0343",
                                                                "1636 2620 1030",
                                                                "3631201001",
                                                                "0600 460340",
                                                                "060040",
                                                                "0006234640",
                                                                "00064046",
                                                                "100105163645413010",
                                                                "00063645443303",
                                                                "100105163645413010 2240",
                                                                "00063645443303 2340",
                                                                "453616050413334241301001",
                                                                "0646 2620",
                                                                "060110304146",
                                                                "062046",
                                                                "0610233046",
                                                                "0046 0640",
                                                                "062346 2320",
                                                                "06460040"};
  static constexpr std::array<std::string_view, 10> kDigits = {
      "100105163645413010",     "152620 1030", "05163645440040",
      "0646243443413010",       "30360242",    "460604344341301001",
      "4536160501103041423303", "064610",      "130405163645443313020110304142",
      "43130405163645413010"};
  const char upper = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  if (upper >= 'A' && upper <= 'Z') return kLetters[upper - 'A'];
  if (upper >= '0' && upper <= '9') return kDigits[upper - '0'];
  if (upper == '-') return "1333";
  if (upper == '.') return "2020";
  if (upper == '/') return "0046";
  if (upper == '!') return "2622 2020";
  return "";
}

constexpr double kAdvance = 0.95;  // from letter to letter, in heights

double SegmentDistance(double x, double y, double xa, double ya, double xb, double yb) {
  const double dx = xb - xa;
  const double dy = yb - ya;
  const double length2 = dx * dx + dy * dy;
  const double t =
      length2 > 0.0 ? std::clamp(((x - xa) * dx + (y - ya) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(x - xa - t * dx, y - ya - t * dy);
}

// Signed distance to a turned, rounded rectangle.
struct TurnedRectangle {
  double x, y, hx, hy, c, s, radius;
  TurnedRectangle(double x_in, double y_in, double hx_in, double hy_in, double angle, double r)
      : x(x_in),
        y(y_in),
        hx(hx_in - r),
        hy(hy_in - r),
        c(std::cos(angle)),
        s(std::sin(angle)),
        radius(r) {}
  double operator()(double px, double py) const {
    const double a = std::abs(c * (px - x) + s * (py - y)) - hx;
    const double b = std::abs(-s * (px - x) + c * (py - y)) - hy;
    if (a <= 0.0 || b <= 0.0) return std::max(a, b) - radius;
    return std::sqrt(a * a + b * b) - radius;
  }
  [[nodiscard]] Area Bounds(double margin) const {
    const double ex = std::abs(c) * (hx + radius) + std::abs(s) * (hy + radius) + margin;
    const double ey = std::abs(s) * (hx + radius) + std::abs(c) * (hy + radius) + margin;
    return {x - ex, y - ey, x + ex, y + ey};
  }
};

}  // namespace

Canvas::Canvas(const Area& area, double texel_m, double grey) : area_(area), texel_m_(texel_m) {
  CHECK_GT(texel_m, 0.0);
  width_ = std::max(1, static_cast<int>(std::ceil(area.width() / texel_m - 1e-6)));
  height_ = std::max(1, static_cast<int>(std::ceil(area.height() / texel_m - 1e-6)));
  grey_.assign(static_cast<std::size_t>(width_) * height_, static_cast<float>(grey));
}

Area Canvas::Extended(const Area& area) const {
  const double margin = 2.0 * kEdgeTexels * texel_m_;
  constexpr double kNear_m = 1e-9;
  return {area.x0 <= area_.x0 + kNear_m ? area_.x0 - margin : area.x0,
          area.y0 <= area_.y0 + kNear_m ? area_.y0 - margin : area.y0,
          area.x1 >= area_.x1 - kNear_m ? area_.x1 + margin : area.x1,
          area.y1 >= area_.y1 - kNear_m ? area_.y1 + margin : area.y1};
}

Canvas::Span Canvas::Texels(const Area& inside) const {
  const Area area = Extended(inside);
  const auto clip = [this](double x, double x0, int count) {
    return static_cast<int>(
        std::clamp(std::ceil((x - x0) / texel_m_ - 0.5), 0.0, static_cast<double>(count)));
  };
  return {clip(area.x0, area_.x0, width_), clip(area.x1, area_.x0, width_),
          clip(area.y0, area_.y0, height_), clip(area.y1, area_.y0, height_)};
}

void Canvas::AddNoise(const Area& area, const FractalNoise& noise, double amplitude) {
  const auto a = static_cast<float>(amplitude);
  MapNoise(area, noise, [a](float g, float n) { return g + a * n; });
}

void Canvas::ScaleNoise(const Area& area, const FractalNoise& noise, double amplitude) {
  const auto a = static_cast<float>(amplitude);
  MapNoise(area, noise, [a](float g, float n) { return g * (1.0f + a * n); });
}

void Canvas::Shade(const std::vector<float>& map, int columns, int rows) {
  CHECK_EQ(map.size(), static_cast<std::size_t>(columns) * rows);
  // The place of each texel between two cells, and the weight of the second.
  const auto place = [](int texel, int texels, int cells) {
    const double x = std::clamp((texel + 0.5) * cells / texels - 0.5, 0.0, cells - 1.0);
    const int cell = std::min(static_cast<int>(x), std::max(0, cells - 2));
    return std::pair(cell, static_cast<float>(x - cell));
  };
  std::vector<std::pair<int, float>> across(static_cast<std::size_t>(width_));
  for (int j = 0; j < width_; ++j) across[j] = place(j, width_, columns);
  std::vector<float> line(static_cast<std::size_t>(columns) + 1);
  for (int i = 0; i < height_; ++i) {
    const auto [row, up] = place(i, height_, rows);
    const float* low = map.data() + static_cast<std::size_t>(row) * columns;
    const float* high = rows > 1 ? low + columns : low;
    for (int k = 0; k < columns; ++k) line[k] = low[k] + up * (high[k] - low[k]);
    line[columns] = line[columns - 1];
    float* grey = grey_.data() + static_cast<std::size_t>(i) * width_;
    for (int j = 0; j < width_; ++j) {
      const auto [cell, right] = across[j];
      grey[j] *= line[cell] + right * (line[cell + 1] - line[cell]);
    }
  }
}

void Canvas::Fill(const Area& inside, double grey, double opacity) {
  const Area area = Extended(inside);
  const Span span = Texels(area.Inset(-kEdgeTexels * texel_m_));
  if (span.x0 >= span.x1) return;
  std::vector<float> across(static_cast<std::size_t>(span.x1 - span.x0));
  for (int j = span.x0; j < span.x1; ++j) {
    const double x = CenterX(j);
    across[j - span.x0] = Coverage(area.x0 - x) * Coverage(x - area.x1);
  }
  for (int i = span.y0; i < span.y1; ++i) {
    const double y = CenterY(i);
    const float up = static_cast<float>(opacity) * Coverage(area.y0 - y) * Coverage(y - area.y1);
    float* row = grey_.data() + static_cast<std::size_t>(i) * width_ + span.x0;
    for (std::size_t j = 0; j < across.size(); ++j) {
      row[j] += up * across[j] * (static_cast<float>(grey) - row[j]);
    }
  }
}

void Canvas::FillGradient(const Area& area, double grey_low, double grey_high) {
  const auto slope = static_cast<float>((grey_high - grey_low) / area.height());
  const auto low = static_cast<float>(grey_low);
  const auto y0 = static_cast<float>(area.y0);
  Map(area, [=](float, float, float y) { return low + slope * (y - y0); });
}

void Canvas::Frame(const Area& area, double thickness_m, double grey, double opacity) {
  const double t = thickness_m;
  Fill({area.x0, area.y0, area.x1, area.y0 + t}, grey, opacity);
  Fill({area.x0, area.y1 - t, area.x1, area.y1}, grey, opacity);
  Fill({area.x0, area.y0 + t, area.x0 + t, area.y1 - t}, grey, opacity);
  Fill({area.x1 - t, area.y0 + t, area.x1, area.y1 - t}, grey, opacity);
}

void Canvas::FillTurned(double x, double y, double hx, double hy, double angle, double grey,
                        double opacity, double corner_radius_m) {
  const TurnedRectangle rectangle(x, y, hx, hy, angle, std::min({corner_radius_m, hx, hy}));
  FillShape(rectangle.Bounds(0.0), grey, opacity, rectangle);
}

void Canvas::FillDisc(double x, double y, double radius_m, double grey, double opacity) {
  FillShape({x - radius_m, y - radius_m, x + radius_m, y + radius_m}, grey, opacity,
            [=](double px, double py) {
              const double dx = px - x;
              const double dy = py - y;
              return std::sqrt(dx * dx + dy * dy) - radius_m;
            });
}

void Canvas::FillRing(double x, double y, double radius_m, double thickness_m, double grey,
                      double opacity) {
  const double middle = radius_m - 0.5 * thickness_m;
  FillShape({x - radius_m, y - radius_m, x + radius_m, y + radius_m}, grey, opacity,
            [=](double px, double py) {
              const double dx = px - x;
              const double dy = py - y;
              return std::abs(std::sqrt(dx * dx + dy * dy) - middle) - 0.5 * thickness_m;
            });
}

void Canvas::FillConvex(const std::vector<Point>& corners, double grey, double opacity) {
  struct Edge {
    double nx, ny, offset;
  };
  std::vector<Edge> edges;
  Area bounds{1e9, 1e9, -1e9, -1e9};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Point a = corners[k];
    const Point b = corners[(k + 1) % corners.size()];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const double nx = (b.y - a.y) / length;
    const double ny = -(b.x - a.x) / length;
    edges.push_back({nx, ny, nx * a.x + ny * a.y});
    bounds = {std::min(bounds.x0, a.x), std::min(bounds.y0, a.y), std::max(bounds.x1, a.x),
              std::max(bounds.y1, a.y)};
  }
  FillShape(bounds, grey, opacity, [&edges](double x, double y) {
    double distance = -1e9;
    for (const Edge& e : edges) distance = std::max(distance, e.nx * x + e.ny * y - e.offset);
    return distance;
  });
}

void Canvas::Line(double xa, double ya, double xb, double yb, double thickness_m, double grey,
                  double opacity) {
  const double r = 0.5 * thickness_m;
  FillShape(
      {std::min(xa, xb) - r, std::min(ya, yb) - r, std::max(xa, xb) + r, std::max(ya, yb) + r},
      grey, opacity, [=](double x, double y) { return SegmentDistance(x, y, xa, ya, xb, yb) - r; });
}

void Canvas::Shadow(double x, double y, double hx, double hy, double angle, double fade_m,
                    double strength) {
  const TurnedRectangle rectangle(x, y, hx, hy, angle, 0.0);
  Map(rectangle.Bounds(fade_m), [&](float g, float px, float py) {
    const double t = std::clamp(1.0 - std::max(0.0, rectangle(px, py)) / fade_m, 0.0, 1.0);
    return g * static_cast<float>(1.0 - strength * t * t);
  });
}

void Canvas::Text(double x, double y, double height_m, std::string_view text, double grey,
                  double weight) {
  const double unit = height_m / 6.0;
  for (const char letter : text) {
    const std::string_view strokes = Glyph(letter);
    bool down = false;
    double last_x = 0.0;
    double last_y = 0.0;
    for (std::size_t k = 0; k + 1 < strokes.size();) {
      if (strokes[k] == ' ') {
        down = false;
        ++k;
        continue;
      }
      const double px = x + (strokes[k] - '0') * unit;
      const double py = y + (strokes[k + 1] - '0') * unit;
      if (down) Line(last_x, last_y, px, py, weight * height_m, grey);
      last_x = px;
      last_y = py;
      down = true;
      k += 2;
    }
    x += kAdvance * height_m;
  }
}

double Canvas::TextWidth(double height_m, std::string_view text) {
  return kAdvance * height_m * static_cast<double>(text.size());
}

Texture Canvas::ToTexture() const {
  constexpr float kShoulder = 200.0f;
  constexpr float kRoom = 50.0f;
  std::vector<std::uint8_t> texels(grey_.size());
  for (std::size_t k = 0; k < grey_.size(); ++k) {
    float grey = std::max(grey_[k], 0.0f);
    const float over = grey - kShoulder;
    if (over > 0.0f) grey = kShoulder + kRoom * over / (kRoom + over);
    texels[k] = static_cast<std::uint8_t>(grey + 0.5f);
  }
  return Texture(width_, height_, texel_m_, std::move(texels));
}

}  // namespace duet
