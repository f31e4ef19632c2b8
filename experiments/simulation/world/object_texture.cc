#include "experiments/simulation/world/object_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace duet {
namespace {

// Lines of words too small to read, from the top.
void PaintPrint(Canvas& canvas, const Area& area, Random& random, double line_m, double ink) {
  for (double y = area.y1 - line_m; y > area.y0; y -= 1.7 * line_m) {
    if (random.Index(9) == 0) continue;
    const double end = random.Index(4) == 0 ? random.Uniform(area.center_x(), area.x1) : area.x1;
    for (double x = area.x0; x < end;) {
      const double word = random.Uniform(1.2, 5.0) * line_m;
      canvas.Fill({x, y, std::min(x + word, end), y + line_m}, ink, random.Uniform(0.75, 1.0));
      x += word + 0.7 * line_m;
    }
  }
}

// A text in the middle of an area, as high as fits.
void PaintFittedText(Canvas& canvas, const Area& area, const std::string& text, double ink) {
  const double height =
      std::min(area.height(), area.width() / (Canvas::TextWidth(1.0, text) + 0.1));
  canvas.Text(area.center_x() - 0.48 * Canvas::TextWidth(height, text),
              area.center_y() - 0.5 * height, height, text, ink);
}

void PaintTags(Canvas& canvas, const Area& area, Random& random) {
  const int columns = std::max(1, static_cast<int>(std::lround(area.width() / 0.24)));
  const int rows = std::max(1, static_cast<int>(std::lround(area.height() / 0.24)));
  const double pitch = std::min(area.width() / columns, area.height() / rows);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const Area tag = Area{area.x0 + j * pitch, area.y0 + i * pitch, area.x0 + (j + 1) * pitch,
                            area.y0 + (i + 1) * pitch}
                           .Inset(0.1 * pitch);
      canvas.Fill(tag, 22.0);
      const double bit = tag.width() / 8.0;
      for (int b = 0; b < 36; ++b) {
        if (random.Index(2) == 0) continue;
        const double x = tag.x0 + (1 + b % 6) * bit;
        const double y = tag.y0 + (1 + b / 6) * bit;
        canvas.Fill({x, y, x + bit, y + bit}, 228.0);
      }
    }
  }
}

void PaintLandscape(Canvas& canvas, const Area& area, Random& random) {
  canvas.FillGradient(area, 215.0, 120.0);
  canvas.AddNoise(area, FractalNoise(random.Next(), 0.4, 0.15, 4), 45.0);
  canvas.FillDisc(random.Uniform(area.x0 + 0.2 * area.width(), area.x1 - 0.2 * area.width()),
                  area.y0 + 0.75 * area.height(), 0.07 * area.height(), 238.0);
  // Ranges of hills, the nearer the darker.
  for (int range = 0; range < 4; ++range) {
    const double base = area.y0 + (0.55 - 0.13 * range) * area.height();
    const double tone = 150.0 - 36.0 * range;
    FractalNoise ridge(random.Next(), 0.35 * area.width(), 6, 0.55);
    ridge.SetColumns(area.x0, 0.5 * canvas.texel_m(),
                     static_cast<int>(area.width() / (0.5 * canvas.texel_m())) + 4);
    const std::vector<float> heights = ridge.Row(0.37);
    const double step = 0.5 * canvas.texel_m();
    const double edge = Canvas::kEdgeTexels * canvas.texel_m();
    canvas.Map(area, [&](float g, float x, float y) {
      const int k = std::max(0, static_cast<int>((x - area.x0) / step));
      const double top = base + 0.25 * area.height() * heights[k];
      const double a = std::clamp(0.5 + (top - y) / edge, 0.0, 1.0);
      return static_cast<float>(g + a * (tone + 60.0 * (y - top) / area.height() - g));
    });
  }
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.08, 4, 0.8), 0.25);
}

void PaintChart(Canvas& canvas, const Area& area, Random& random) {
  canvas.Fill(area, 225.0);
  PaintFittedText(canvas, area.Part(0.1, 0.88, 0.9, 0.96), RandomWord(random), 35.0);
  const Area plot = area.Part(0.1, 0.1, 0.93, 0.84);
  for (int k = 0; k <= 5; ++k) {
    const double y = plot.y0 + 0.2 * k * plot.height();
    canvas.Line(plot.x0, y, plot.x1, y, 0.004, 150.0);
  }
  const int bars = 6 + random.Index(6);
  double last = random.Uniform(0.3, 0.8);
  for (int k = 0; k < bars; ++k) {
    const double x = plot.x0 + (k + 0.5) * plot.width() / bars;
    const double value = random.Uniform(0.15, 0.95);
    canvas.Fill({x - 0.3 * plot.width() / bars, plot.y0, x + 0.3 * plot.width() / bars,
                 plot.y0 + value * plot.height()},
                random.Uniform(40.0, 170.0));
    const double next = std::clamp(last + random.Uniform(-0.25, 0.25), 0.1, 0.95);
    if (k > 0) {
      canvas.Line(x - plot.width() / bars, plot.y0 + last * plot.height(), x,
                  plot.y0 + next * plot.height(), 0.012, 20.0);
    }
    canvas.FillDisc(x, plot.y0 + next * plot.height(), 0.014, 20.0);
    last = next;
  }
  canvas.Line(plot.x0, plot.y0, plot.x1, plot.y0, 0.008, 20.0);
  canvas.Line(plot.x0, plot.y0, plot.x0, plot.y1, 0.008, 20.0);
}

void PaintShapes(Canvas& canvas, const Area& area, Random& random) {
  canvas.Fill(area, random.Uniform(150.0, 228.0));
  for (int k = 0; k < 9; ++k) {
    const double x = random.Uniform(area.x0 + 0.15 * area.width(), area.x1 - 0.15 * area.width());
    const double y = random.Uniform(area.y0 + 0.25 * area.height(), area.y1 - 0.15 * area.height());
    const double size = random.Uniform(0.06, 0.14) * std::min(area.width(), area.height());
    const double tone =
        random.Index(2) == 0 ? random.Uniform(22.0, 90.0) : random.Uniform(120.0, 240.0);
    switch (random.Index(4)) {
      case 0:
        canvas.FillDisc(x, y, size, tone);
        break;
      case 1:
        canvas.FillTurned(x, y, size, random.Uniform(0.3, 1.0) * size,
                          random.Uniform(0.0, std::numbers::pi), tone);
        break;
      case 2: {
        const double a = random.Uniform(0.0, std::numbers::pi);
        canvas.FillConvex({{x + size * std::cos(a), y + size * std::sin(a)},
                           {x + size * std::cos(a + 2.1), y + size * std::sin(a + 2.1)},
                           {x + size * std::cos(a + 4.2), y + size * std::sin(a + 4.2)}},
                          tone);
        break;
      }
      default:
        canvas.FillRing(x, y, size, 0.35 * size, tone);
    }
  }
  const Area foot = area.Part(0.0, 0.0, 1.0, 0.16);
  canvas.Fill(foot, 26.0);
  PaintFittedText(canvas, foot.Part(0.08, 0.25, 0.92, 0.75), RandomWord(random), 230.0);
}

void PaintMap(Canvas& canvas, const Area& area, Random& random) {
  // Contour lines of a noise landscape, water where it is low.
  const double texel = canvas.texel_m();
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.5, 4, 0.45), [texel](float, float n) {
    if (n < -0.22f) return 110.0f;
    const float level = n * 14.0f;
    const float line = std::abs(level - std::round(level));
    const float width = 0.14f + static_cast<float>(texel) * 8.0f;
    return 215.0f + 60.0f * n - 110.0f * std::clamp(1.5f - line / width, 0.0f, 1.0f);
  });
  for (int k = 0; k < 5; ++k) {
    double x = random.Uniform(area.x0, area.x1);
    double y = random.Uniform(area.y0, area.y1);
    double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
    for (int s = 0; s < 14; ++s) {
      angle += random.Uniform(-0.5, 0.5);
      const double nx = std::clamp(x + 0.07 * std::cos(angle), area.x0, area.x1);
      const double ny = std::clamp(y + 0.07 * std::sin(angle), area.y0, area.y1);
      canvas.Line(x, y, nx, ny, 0.012, 30.0);
      canvas.Line(x, y, nx, ny, 0.006, 235.0);
      x = nx;
      y = ny;
    }
    canvas.FillTurned(x, y, 0.018, 0.018, angle, 20.0);
  }
}

// Splits `area` into panels at random until they are small; f gets each.
template <typename F>
void Split(const Area& area, Random& random, double largest, F f) {
  const bool across = area.width() > area.height();
  const double size = across ? area.width() : area.height();
  if (size < largest || (size < 1.6 * largest && random.Index(3) == 0)) {
    f(area);
    return;
  }
  const double t = random.Uniform(0.35, 0.65);
  if (across) {
    Split({area.x0, area.y0, area.x0 + t * area.width(), area.y1}, random, largest, f);
    Split({area.x0 + t * area.width(), area.y0, area.x1, area.y1}, random, largest, f);
  } else {
    Split({area.x0, area.y0, area.x1, area.y0 + t * area.height()}, random, largest, f);
    Split({area.x0, area.y0 + t * area.height(), area.x1, area.y1}, random, largest, f);
  }
}

void PaintGauge(Canvas& canvas, double x, double y, double radius, Random& random) {
  canvas.FillDisc(x, y, radius, 40.0);
  canvas.FillDisc(x, y, 0.85 * radius, 226.0);
  for (int k = 0; k < 9; ++k) {
    const double a = -0.6 + k * (std::numbers::pi + 1.2) / 8.0;
    canvas.Line(x + 0.6 * radius * std::cos(a), y + 0.6 * radius * std::sin(a),
                x + 0.76 * radius * std::cos(a), y + 0.76 * radius * std::sin(a), 0.07 * radius,
                30.0);
  }
  const double a = random.Uniform(-0.6, std::numbers::pi + 0.6);
  canvas.Line(x, y, x + 0.7 * radius * std::cos(a), y + 0.7 * radius * std::sin(a), 0.1 * radius,
              20.0);
}

void PaintMachinePanel(Canvas& canvas, const Area& cell, Random& random, double grey) {
  const double tone = NearGrey(random, grey, 26.0);
  canvas.Fill(cell, tone);
  canvas.Frame(cell, 0.008, 0.3 * grey);
  canvas.Frame(cell.Inset(0.008), 0.006, std::min(240.0, 1.4 * grey), 0.6);
  const Area in = cell.Inset(0.14 * std::min(cell.width(), cell.height()));
  const double small = std::min(in.width(), in.height());
  switch (random.Index(9)) {
    case 0:
    case 1: {  // louvres
      const double pitch = std::clamp(small / 7.0, 0.03, 0.07);
      for (double y = in.y0; y + pitch < in.y1; y += pitch) {
        canvas.Fill({in.x0, y, in.x1, y + 0.5 * pitch}, 30.0);
        canvas.Fill({in.x0, y + 0.5 * pitch, in.x1, y + 0.68 * pitch}, std::min(240.0, 1.5 * tone));
      }
      break;
    }
    case 2: {  // gauges
      const int count = std::max(1, static_cast<int>(in.width() / (small + 0.01)));
      for (int k = 0; k < std::min(count, 4); ++k) {
        PaintGauge(canvas, in.x0 + (k + 0.5) * small, in.center_y(), 0.42 * small, random);
      }
      break;
    }
    case 3: {  // a display
      canvas.Fill(in, 24.0);
      canvas.Frame(in, 0.012, 190.0);
      PaintPrint(canvas, in.Inset(0.12 * small), random, std::clamp(0.06 * small, 0.012, 0.03),
                 205.0);
      break;
    }
    case 4: {  // switches and lamps
      const double pitch = std::clamp(small / 3.0, 0.06, 0.14);
      for (double y = in.y0 + 0.5 * pitch; y < in.y1; y += pitch) {
        for (double x = in.x0 + 0.5 * pitch; x < in.x1; x += pitch) {
          if (random.Index(5) == 0) continue;
          canvas.FillDisc(x, y, 0.3 * pitch, 35.0);
          canvas.FillDisc(x, y, 0.2 * pitch, random.Index(2) == 0 ? 225.0 : 110.0);
        }
      }
      break;
    }
    case 5:  // a sign
      PaintLabel(canvas, in, random);
      break;
    case 6: {  // a door with hinges and handle
      canvas.Fill(in, NearGrey(random, 0.75 * grey, 15.0));
      canvas.Frame(in, 0.008, 30.0);
      for (const double f : {0.15, 0.8}) {
        const double y = in.y0 + f * in.height();
        canvas.Fill({in.x0 - 0.012, y, in.x0 + 0.03, y + 0.08}, 205.0);
      }
      canvas.FillTurned(in.x1 - 0.06, in.center_y(), 0.015, 0.06, 0.0, 220.0);
      PaintLabel(canvas, in.Part(0.3, 0.6, 0.7, 0.8), random);
      break;
    }
    case 7:  // warning stripes
      PaintHazardStripes(canvas, in.Part(0.0, 0.3, 1.0, 0.7), 0.16, 28.0, 205.0);
      break;
    default: {  // pipes and cables in front
      const int count = 2 + random.Index(3);
      for (int k = 0; k < count; ++k) {
        const double x = cell.x0 + (k + 0.7) / (count + 0.6) * cell.width();
        const double r = std::min(0.05, 0.12 * cell.width());
        PaintPipe(canvas, {x - r, cell.y0, x + r, cell.y1}, random, random.Uniform(70.0, 200.0));
      }
    }
  }
  const Area bolts = cell.Inset(0.03);
  for (const double x : {bolts.x0, bolts.x1}) {
    for (const double y : {bolts.y0, bolts.y1}) {
      canvas.FillDisc(x, y, 0.014, 0.35 * tone);
      canvas.FillDisc(x - 0.003, y + 0.003, 0.007, std::min(240.0, 1.5 * tone));
    }
  }
}

}  // namespace

void PaintLabel(Canvas& canvas, const Area& area, Random& random) {
  const bool inverse = random.Index(4) == 0;
  const double paper = inverse ? 30.0 : random.Uniform(200.0, 235.0);
  const double ink = inverse ? 225.0 : 25.0;
  canvas.Fill(area, paper);
  canvas.Frame(area, std::min(0.008, 0.08 * area.height()), ink);
  if (area.height() > 0.8 * area.width()) {
    PaintFittedText(canvas, area.Part(0.1, 0.72, 0.9, 0.92), RandomCode(random), ink);
    PaintPrint(canvas, area.Part(0.1, 0.35, 0.9, 0.66), random,
               std::clamp(0.05 * area.height(), 0.008, 0.03), ink);
    double x = area.x0 + 0.1 * area.width();
    while (x < area.x1 - 0.12 * area.width()) {
      const double bar = random.Uniform(0.015, 0.05) * area.width();
      canvas.Fill({x, area.y0 + 0.08 * area.height(), x + bar, area.y0 + 0.28 * area.height()},
                  ink);
      x += bar + random.Uniform(0.015, 0.05) * area.width();
    }
    return;
  }
  PaintFittedText(canvas, area.Part(0.06, 0.4, 0.94, 0.86),
                  random.Index(2) == 0 ? RandomWord(random) : RandomCode(random), ink);
  PaintPrint(canvas, area.Part(0.08, 0.1, 0.92, 0.34), random,
             std::clamp(0.07 * area.height(), 0.008, 0.03), ink);
}

void PaintPoster(Canvas& canvas, const Area& area, Random& random) {
  PaintPoster(canvas, area, random, random.Index(kPosterDesigns));
}

void PaintPoster(Canvas& canvas, const Area& area, Random& random, int design) {
  // It stands off the wall a little: a thin shadow below and to the right.
  canvas.Shadow(area.center_x() + 0.012, area.center_y() - 0.014, 0.5 * area.width(),
                0.5 * area.height(), 0.0, 0.03, 0.4);
  const double paper = random.Uniform(205.0, 235.0);
  canvas.Fill(area, paper);
  const Area in = area.Inset(0.05 * std::min(area.width(), area.height()));
  switch (design) {
    case 0:
      PaintShapes(canvas, in, random);
      break;
    case 1:
      PaintFittedText(canvas, in.Part(0.05, 0.84, 0.95, 0.97), RandomWord(random), 28.0);
      PaintPrint(canvas, in.Part(0.05, 0.42, 0.48, 0.8), random, 0.014, 60.0);
      PaintPrint(canvas, in.Part(0.54, 0.05, 0.95, 0.8), random, 0.014, 60.0);
      PaintLandscape(canvas, in.Part(0.05, 0.06, 0.48, 0.38), random);
      break;
    case 2:
      PaintTags(canvas, in, random);
      break;
    case 3:
      PaintLandscape(canvas, in, random);
      break;
    case 4:
      PaintChart(canvas, in, random);
      break;
    case 5: {
      canvas.Fill(in, 30.0);
      const double x = in.x0 + random.Uniform(0.35, 0.65) * in.width();
      const double y = in.y0 + random.Uniform(0.45, 0.65) * in.height();
      const double largest = 0.45 * std::min(in.width(), in.height());
      for (double r = largest; r > 0.03; r -= random.Uniform(0.05, 0.09)) {
        canvas.FillRing(x, y, r, 0.028, random.Uniform(150.0, 238.0));
      }
      for (int k = 0; k < 7; ++k) {
        canvas.Line(x, y, random.Uniform(in.x0, in.x1), random.Index(2) == 0 ? in.y0 : in.y1, 0.01,
                    200.0, 0.7);
      }
      PaintFittedText(canvas, in.Part(0.1, 0.04, 0.9, 0.13), RandomWord(random), 235.0);
      break;
    }
    case 6:
      PaintMap(canvas, in, random);
      break;
    default: {
      const double size = std::clamp(in.width() / 7.0, 0.06, 0.16);
      const int columns = static_cast<int>(in.width() / size);
      const int rows = static_cast<int>(in.height() / size);
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
          const Area cell{in.x0 + j * size, in.y0 + i * size, in.x0 + (j + 1) * size,
                          in.y0 + (i + 1) * size};
          const int kind = random.Index(4);
          if (kind == 0) continue;
          canvas.Fill(cell, random.Uniform(24.0, 190.0));
          if (kind == 1) canvas.FillDisc(cell.center_x(), cell.center_y(), 0.32 * size, 225.0);
          if (kind == 2) {
            canvas.FillConvex({{cell.x0, cell.y0}, {cell.x1, cell.y0}, {cell.x1, cell.y1}}, 215.0);
          }
        }
      }
    }
  }
  canvas.Frame(area, 0.006, 60.0);
  for (const double x : {area.x0 + 0.03, area.x1 - 0.03}) {
    canvas.FillDisc(x, area.y1 - 0.025, 0.009, 25.0);
  }
}

void PaintCurtain(Canvas& canvas, const Area& area, Random& random) {
  const double pitch = random.Uniform(0.13, 0.19);
  const double grey = random.Uniform(95.0, 170.0);
  const double ink = grey > 130.0 ? grey - 85.0 : grey + 85.0;
  const int kind = random.Index(3);
  canvas.Fill(area, grey);
  // The cloth lies in folds: figures are narrower on the flanks, the same on every fold's height.
  const double figure = random.Uniform(0.07, 0.11);
  if (kind == 0) {
    for (double y = area.y0 + figure; y < area.y1; y += 2.0 * figure) {
      for (double x = area.x0; x < area.x1; x += 0.25 * pitch) {
        const double sag = 0.25 * figure * std::sin(2.0 * std::numbers::pi * x / pitch);
        canvas.FillTurned(x + 0.125 * pitch, y + sag, 0.14 * pitch, 0.38 * figure, 0.0, ink);
      }
    }
  }
  if (kind != 0) {
    for (double y = area.y0 + 0.5 * figure; y < area.y1; y += 1.5 * figure) {
      const double shift = random.Uniform(0.0, figure);
      for (double x = area.x0 + shift; x < area.x1; x += random.Uniform(0.8, 1.8) * figure) {
        if (kind == 1) {
          canvas.FillDisc(x, y, random.Uniform(0.2, 0.42) * figure, ink);
          canvas.FillDisc(x, y, 0.12 * figure, grey);
        } else {
          const double a = random.Uniform(0.0, std::numbers::pi);
          canvas.FillTurned(x, y, 0.45 * figure, 0.16 * figure, a, ink, 1.0, 0.16 * figure);
          canvas.FillTurned(x, y, 0.45 * figure, 0.16 * figure, a + 1.2, ink, 1.0, 0.16 * figure);
        }
      }
    }
  }
  FractalNoise wander(random.Next(), 0.7, 3.0, 3);
  const double phase = random.Uniform(0.0, 6.0);
  std::vector<float> fold(static_cast<std::size_t>(canvas.width()));
  wander.SetColumns(canvas.area().x0, canvas.texel_m(), canvas.width());
  const std::vector<float>& bend = wander.Row(0.5);
  for (int j = 0; j < canvas.width(); ++j) {
    const double x = j * canvas.texel_m() / pitch + 1.4 * bend[j] + phase;
    fold[j] = static_cast<float>(0.78 + 0.3 * std::sin(2.0 * std::numbers::pi * x) +
                                 0.1 * std::sin(5.3 * std::numbers::pi * x));
  }
  canvas.Map(area, [&](float g, float x, float) {
    const int j = std::clamp(static_cast<int>((x - canvas.area().x0) / canvas.texel_m()), 0,
                             canvas.width() - 1);
    return g * fold[j];
  });
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.02, 2), 0.08);
  canvas.Fill({area.x0, area.y1 - 0.05, area.x1, area.y1}, 60.0);
  for (double x = area.x0 + 0.07; x < area.x1; x += 0.17) {
    canvas.FillRing(x, area.y1 - 0.045, 0.024, 0.01, 215.0);
  }
}

void PaintMattress(Canvas& canvas, const Area& area, Random& random) {
  const double grey = random.Uniform(70.0, 165.0);
  canvas.Fill(area, grey);
  const double ink = grey > 115.0 ? grey - 70.0 : grey + 75.0;
  for (double x = area.x0; x < area.x1; x += 0.24) {
    canvas.Fill({x, area.y0, std::min(area.x1, x + 0.05), area.y1}, ink, 0.9);
    canvas.Fill({x + 0.075, area.y0, std::min(area.x1, x + 0.09), area.y1}, ink, 0.8);
  }
  const double pitch = 0.2;
  int row = 0;
  for (double y = area.y0 + 0.5 * pitch; y < area.y1; y += 0.5 * pitch, ++row) {
    for (double x = area.x0 + (row % 2 == 0 ? 0.25 : 0.75) * pitch; x < area.x1; x += pitch) {
      canvas.Shadow(x, y, 0.004, 0.004, 0.0, 0.055, 0.5);
      canvas.FillDisc(x, y, 0.012, ink > grey ? 225.0 : 30.0);
    }
  }
  canvas.Frame(area, 0.02, 0.5 * grey);
  canvas.Frame(area.Inset(0.02), 0.012, std::min(235.0, 1.5 * grey));
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.5, 4), 0.2);
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.015, 2), 0.1);
}

void PaintPlaid(Canvas& canvas, const Area& area, Random& random, double grey) {
  canvas.Fill(area, grey);
  const int bands = 3 + random.Index(3);
  const double period = random.Uniform(0.09, 0.16);
  for (int k = 0; k < bands; ++k) {
    const double offset = random.Uniform(0.0, period);
    const double width = random.Uniform(0.08, 0.3) * period;
    const double tone = random.Index(2) == 0 ? 25.0 : 225.0;
    const double opacity = random.Uniform(0.4, 0.75);
    for (double x = area.x0 + offset; x < area.x1; x += period) {
      canvas.Fill({x, area.y0, std::min(area.x1, x + width), area.y1}, tone, opacity);
    }
    for (double y = area.y0 + offset; y < area.y1; y += period) {
      canvas.Fill({area.x0, y, area.x1, std::min(area.y1, y + width)}, tone, opacity);
    }
  }
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.2, 5, 0.7), 0.4);
}

void PaintShelf(Canvas& canvas, const Area& area, Random& random) {
  const double wood = random.Uniform(105.0, 190.0);
  PaintBoards(canvas, area, random, false, 0.3, wood, 8.0);
  const int levels = std::max(1, static_cast<int>(std::lround(area.height() / 0.36)));
  const double pitch = area.height() / levels;
  for (int level = 0; level < levels; ++level) {
    const Area bay{area.x0 + 0.03, area.y0 + level * pitch + 0.03, area.x1 - 0.03,
                   area.y0 + (level + 1) * pitch};
    canvas.FillGradient(bay, 48.0, 24.0);
    double x = bay.x0 + 0.01;
    while (x < bay.x1 - 0.03) {
      const int kind = random.Index(8);
      if (kind == 0) {
        x += random.Uniform(0.04, 0.16);
        continue;
      }
      if (kind == 1) {  // a box
        const double w = std::min(random.Uniform(0.15, 0.32), bay.x1 - x - 0.01);
        if (w < 0.1) break;
        const Area box{x, bay.y0, x + w, bay.y0 + random.Uniform(0.4, 0.85) * bay.height()};
        PaintCardboard(canvas, box, random);
        x += w + 0.01;
        continue;
      }
      const bool binder = kind < 4;
      const double w =
          std::min(binder ? random.Uniform(0.06, 0.085) : random.Uniform(0.02, 0.05), bay.x1 - x);
      const double h = random.Uniform(binder ? 0.78 : 0.5, 0.9) * bay.height();
      const Area spine{x, bay.y0, x + w, bay.y0 + h};
      const double tone = random.Uniform(30.0, 230.0);
      const double ink = tone > 125.0 ? 30.0 : 220.0;
      canvas.Fill(spine, tone);
      canvas.Fill({x, bay.y0, x + 0.003, bay.y0 + h}, 15.0, 0.8);
      if (binder) {
        canvas.Fill(spine.Part(0.15, 0.5, 0.85, 0.85), 225.0);
        PaintPrint(canvas, spine.Part(0.22, 0.54, 0.8, 0.82), random, 0.01, 40.0);
        canvas.FillRing(spine.center_x(), spine.y0 + 0.18 * h, 0.3 * w, 0.08 * w, ink);
      } else {
        canvas.Fill(spine.Part(0.0, 0.12, 1.0, 0.17), ink);
        canvas.Fill(spine.Part(0.0, 0.82, 1.0, 0.86), ink);
        canvas.Fill(spine.Part(0.32, 0.3, 0.68, random.Uniform(0.5, 0.75)), ink, 0.9);
      }
      x += w;
    }
    // The board above throws a shadow.
    canvas.Shadow(bay.center_x(), bay.y1, 0.5 * bay.width(), 0.01, 0.0, 0.1, 0.6);
  }
  PaintGrain(canvas, area, random, 0.07);
}

void PaintCrateSide(Canvas& canvas, const Area& area, Random& random) {
  const double grey = random.Uniform(115.0, 175.0);
  PaintBoards(canvas, area, random, true, std::max(0.08, area.height() / 6.0), grey, 22.0);
  const double batten = std::clamp(0.12 * std::min(area.width(), area.height()), 0.03, 0.1);
  const auto board = [&](const Area& place, bool along_x) {
    canvas.Shadow(place.center_x(), place.center_y(), 0.5 * place.width(), 0.5 * place.height(),
                  0.0, 0.02, 0.45);
    PaintBoards(canvas, place, random, along_x, batten, 1.15 * grey, 12.0);
  };
  if (random.Index(2) == 0) {
    const double angle = std::atan2(area.height() - batten, area.width() - batten);
    const double half = 0.5 * std::hypot(area.width() - batten, area.height() - batten);
    canvas.FillTurned(area.center_x(), area.center_y(), half, 0.55 * batten, angle, 0.4 * grey);
    canvas.FillTurned(area.center_x(), area.center_y(), half, 0.45 * batten, angle, 1.1 * grey);
  }
  board({area.x0, area.y0, area.x0 + batten, area.y1}, false);
  board({area.x1 - batten, area.y0, area.x1, area.y1}, false);
  board({area.x0, area.y0, area.x1, area.y0 + batten}, true);
  board({area.x0, area.y1 - batten, area.x1, area.y1}, true);
  const double height = 0.14 * area.height();
  const std::string text = random.Index(2) == 0 ? RandomWord(random) : RandomCode(random);
  PaintFittedText(canvas, area.Part(0.2, 0.42, 0.8, 0.42 + height / area.height()), text, 25.0);
  if (random.Index(2) == 0) PaintLabel(canvas, area.Part(0.58, 0.18, 0.82, 0.36), random);
  PaintWear(canvas, area, random, 0.2, 3);
}

void PaintCardboard(Canvas& canvas, const Area& area, Random& random) {
  const double grey = random.Uniform(118.0, 178.0);
  const double small = std::min(area.width(), area.height());
  canvas.Fill(area, grey);
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.012, 0.4, 2), 0.14);
  canvas.Frame(area, 0.004, 0.5 * grey);
  canvas.Fill(area.Part(0.0, 0.44, 1.0, 0.54), std::min(235.0, 1.35 * grey), 0.8);
  canvas.Line(area.x0, area.y0 + 0.49 * area.height(), area.x1, area.y0 + 0.49 * area.height(),
              0.003, 0.4 * grey);
  if (random.Index(3) != 0) {
    const double x = random.Uniform(0.05, 0.5);
    PaintLabel(canvas, area.Part(x, 0.56, x + 0.4, 0.92), random);
  }
  if (random.Index(2) == 0) {  // this side up
    const double x = area.x0 + random.Uniform(0.15, 0.3) * area.width();
    const double y = area.y0 + 0.12 * area.height();
    const double s = 0.13 * small;
    for (const double shift : {0.0, 1.3 * s}) {
      canvas.Fill({x + shift - 0.2 * s, y, x + shift + 0.2 * s, y + 1.2 * s}, 35.0);
      canvas.FillConvex({{x + shift - 0.55 * s, y + 1.1 * s},
                         {x + shift + 0.55 * s, y + 1.1 * s},
                         {x + shift, y + 1.9 * s}},
                        35.0);
    }
  }
  if (random.Index(2) == 0) {
    PaintFittedText(canvas, area.Part(0.5, 0.14, 0.94, 0.34), RandomWord(random), 35.0);
  }
  PaintGrain(canvas, area, random, 0.06);
}

void PaintMachineSide(Canvas& canvas, const Area& area, Random& random, double grey) {
  canvas.Fill(area, grey);
  const double panel = std::clamp(0.4 * std::max(area.width(), area.height()), 0.35, 0.8);
  const Area body{area.x0, area.y0 + std::min(0.1, 0.08 * area.height()), area.x1, area.y1};
  Split(body, random, panel,
        [&](const Area& cell) { PaintMachinePanel(canvas, cell, random, grey); });
  canvas.Fill({area.x0, area.y0, area.x1, body.y0}, 40.0);
  canvas.Frame(area, 0.02, 0.5 * grey, 0.8);
  const double square = area.width() * area.height();
  PaintWear(canvas, area, random, 0.2, std::min(40, static_cast<int>(4.0 * square) + 2));
  PaintGrain(canvas, area, random, 0.07);
  // Oil and dust gather at the foot.
  canvas.Shadow(area.center_x(), area.y0, 0.5 * area.width(), 0.01, 0.0,
                0.35 * area.height() + 0.01, 0.4);
}

void PaintPipe(Canvas& canvas, const Area& area, Random& random, double grey) {
  const bool upright = area.height() > area.width();
  const double radius = 0.5 * (upright ? area.width() : area.height());
  const double middle = upright ? area.center_x() : area.center_y();
  canvas.Map(area, [=](float, float x, float y) {
    const double t = std::clamp(((upright ? x : y) - middle) / radius, -1.0, 1.0);
    const double round = std::sqrt(std::max(0.0, 1.0 - t * t));
    const double shine = std::exp(-30.0 * (t - 0.35) * (t - 0.35));
    return static_cast<float>(grey * (0.35 + 0.6 * round) + 60.0 * shine);
  });
  const double length = upright ? area.height() : area.width();
  for (double s = random.Uniform(0.1, 0.5); s < length; s += random.Uniform(0.35, 0.9)) {
    const double flange = 0.05;
    const Area ring =
        upright ? Area{area.x0, area.y0 + s, area.x1, std::min(area.y1, area.y0 + s + flange)}
                : Area{area.x0 + s, area.y0, std::min(area.x1, area.x0 + s + flange), area.y1};
    canvas.Fill(ring, grey > 120.0 ? 0.5 * grey : 1.7 * grey);
    canvas.Frame(ring, 0.008, 30.0);
  }
  PaintGrain(canvas, area, random, 0.1);
}

void PaintBeam(Canvas& canvas, const Area& area, Random& random, double grey) {
  const bool upright = area.height() > area.width();
  canvas.Fill(area, grey);
  const double edge = 0.2 * std::min(area.width(), area.height());
  const auto strip = [&](double f0, double f1, double tone) {
    canvas.Fill(upright ? area.Part(f0, 0.0, f1, 1.0) : area.Part(0.0, f0, 1.0, f1), tone);
  };
  strip(0.0, 0.16, std::min(235.0, 1.3 * grey));
  strip(0.16, 0.24, 0.5 * grey);
  strip(0.76, 0.84, 0.5 * grey);
  strip(0.84, 1.0, std::min(235.0, 1.2 * grey));
  const double length = upright ? area.height() : area.width();
  const double rivet = std::clamp(0.4 * edge, 0.008, 0.02);
  for (double s = 0.1; s < length; s += 0.2 + random.Uniform(-0.02, 0.02)) {
    for (const double f : {0.08, 0.92}) {
      const double x = upright ? area.x0 + f * area.width() : area.x0 + s;
      const double y = upright ? area.y0 + s : area.y0 + f * area.height();
      canvas.FillDisc(x, y, rivet, 0.35 * grey);
      canvas.FillDisc(x - 0.3 * rivet, y + 0.3 * rivet, 0.5 * rivet, std::min(240.0, 1.6 * grey));
    }
  }
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.25, 5, 0.75), [](float g, float n) {
    const float rust = std::clamp((n - 0.12f) * 6.0f, 0.0f, 1.0f);
    return g * (1.0f - 0.45f * rust);
  });
}

void PaintFoliage(Canvas& canvas, const Area& area, Random& random, double grey) {
  canvas.Fill(area, grey);
  const auto base = static_cast<float>(grey);
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.4, 5, 0.9), [base](float, float n) {
    // Bright leaves before dark gaps: the noise stretched and bent.
    const float t = std::clamp(0.47f + 2.1f * n, 0.0f, 1.0f);
    return base * (0.3f + 1.5f * t * t);
  });
  const int leaves = static_cast<int>(area.width() * area.height() * 60.0);
  for (int k = 0; k < leaves; ++k) {
    canvas.FillTurned(random.Uniform(area.x0, area.x1), random.Uniform(area.y0, area.y1),
                      random.Uniform(0.03, 0.08), random.Uniform(0.015, 0.04),
                      random.Uniform(0.0, std::numbers::pi),
                      std::min(235.0, grey * random.Uniform(0.35, 1.9)), 0.9, 0.015);
  }
}

void PaintBark(Canvas& canvas, const Area& area, Random& random) {
  canvas.Fill(area, 78.0);
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.05, 0.35, 4, 0.7),
                  [](float g, float n) { return g * (1.0f + 1.5f * std::clamp(n, -0.55f, 0.7f)); });
}

}  // namespace duet
