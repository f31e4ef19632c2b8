#include "experiments/simulation/world/facade_texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "experiments/simulation/world/object_texture.h"
#include "experiments/simulation/world/procedural_texture.h"

namespace duet {
namespace {

struct Style {
  int wall;  ///< bricks, plaster, stones, boards, panels
  double grey, trim, glass;
  int head;  ///< of a window: a lintel, a gable, an arch, none
  bool shutters, balconies, quoins;
  int columns, rows;  ///< panes
};

Style DrawStyle(Random& random) {
  Style style;
  style.wall = random.Index(5);
  style.grey = random.Uniform(82.0, 195.0);
  style.trim = style.grey > 140.0 ? random.Uniform(70.0, 110.0) : random.Uniform(185.0, 225.0);
  style.glass = random.Uniform(42.0, 70.0);
  style.head = random.Index(4);
  style.shutters = random.Index(3) == 0;
  style.balconies = random.Index(3) == 0;
  style.quoins = random.Index(2) == 0;
  style.columns = 1 + random.Index(2);
  style.rows = 2 + random.Index(2);
  return style;
}

void PaintStones(Canvas& canvas, const Area& area, Random& random, double grey) {
  canvas.Fill(area, 0.5 * grey);
  int row = 0;
  for (double y = area.y0; y < area.y1; y += 0.34, ++row) {
    for (double x = area.x0 - (row % 2) * 0.31; x < area.x1;) {
      const double width = random.Uniform(0.45, 0.75);
      canvas.Fill({std::max(area.x0, x + 0.012), y + 0.012, std::min(area.x1, x + width - 0.012),
                   std::min(area.y1, y + 0.328)},
                  NearGrey(random, grey, 24.0));
      x += width;
    }
  }
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.2, 4, 0.8), 0.2);
}

void PaintWallMaterial(Canvas& canvas, const Area& area, Random& random, const Style& style) {
  switch (style.wall) {
    case 0:
      PaintBricks(canvas, area, random, 0.26, 0.09, style.grey, 28.0);
      break;
    case 1:
      PaintPlaster(canvas, area, random, style.grey);
      PaintCracks(canvas, area, random, static_cast<int>(area.width()), 0.6 * style.grey);
      break;
    case 2:
      PaintStones(canvas, area, random, style.grey);
      break;
    case 3:
      PaintBoards(canvas, area, random, true, 0.2, style.grey, 16.0);
      break;
    default:
      PaintWallPanels(canvas, area, random, 1.5, 1.05, style.grey, 18.0);
  }
}

void PaintHead(Canvas& canvas, const Area& window, const Style& style) {
  const double x = window.center_x();
  const double half = 0.5 * window.width() + 0.16;
  const double y = window.y1;
  switch (style.head) {
    case 0:
      canvas.Fill({x - half, y, x + half, y + 0.2}, style.trim);
      canvas.Fill({x - half - 0.06, y + 0.2, x + half + 0.06, y + 0.27}, 0.8 * style.trim);
      canvas.Shadow(x, y - 0.02, half, 0.01, 0.0, 0.14, 0.4);
      break;
    case 1:
      canvas.FillConvex({{x - half, y + 0.06}, {x + half, y + 0.06}, {x, y + 0.48}}, style.trim);
      canvas.FillConvex({{x - 0.7 * half, y + 0.11}, {x + 0.7 * half, y + 0.11}, {x, y + 0.4}},
                        0.6 * style.trim);
      break;
    case 2:
      for (int k = -4; k <= 4; ++k) {  // a flat arch of wedge stones
        canvas.FillTurned(x + 0.25 * half * k, y + 0.15, 0.1 * half, 0.16, -0.06 * k,
                          k == 0 ? 0.75 * style.trim : style.trim);
      }
      break;
    default:
      break;
  }
}

void PaintBalcony(Canvas& canvas, const Area& window) {
  const Area rail{window.x0 - 0.35, window.y0 - 0.1, window.x1 + 0.35, window.y0 + 0.85};
  for (double x = rail.x0; x < rail.x1; x += 0.13) {
    canvas.Fill({x, rail.y0, x + 0.035, rail.y1}, 28.0);
  }
  canvas.Fill({rail.x0, rail.y1 - 0.06, rail.x1, rail.y1}, 24.0);
  canvas.Fill({rail.x0 - 0.1, rail.y0 - 0.2, rail.x1 + 0.1, rail.y0}, 190.0);
  canvas.Shadow(rail.center_x(), rail.y0 - 0.25, 0.5 * rail.width(), 0.02, 0.0, 0.4, 0.5);
}

void PaintFacadeWindow(Canvas& canvas, const Area& window, Random& random, const Style& style) {
  canvas.Fill(window.Inset(-0.1), style.trim);
  canvas.Frame(window.Inset(-0.1), 0.02, 0.6 * style.trim);
  PaintWindow(canvas, window, random, style.columns, style.rows, 218.0, style.glass);
  // The reveal throws a shadow on the upper part; the sill sheds water that leaves streaks.
  canvas.Shadow(window.center_x(), window.y1, 0.5 * window.width(), 0.01, 0.0, 0.16, 0.45);
  const double sill = window.y0 - 0.1;
  canvas.Fill({window.x0 - 0.18, sill - 0.1, window.x1 + 0.18, sill}, 210.0);
  canvas.Shadow(window.center_x(), sill - 0.12, 0.5 * window.width() + 0.16, 0.01, 0.0, 0.12, 0.5);
  for (int k = 0; k < 3; ++k) {
    canvas.Shadow(random.Uniform(window.x0 - 0.1, window.x1 + 0.1), sill - 0.4, 0.015,
                  random.Uniform(0.1, 0.35), 0.0, 0.08, 0.2);
  }
  PaintHead(canvas, window, style);
  if (style.shutters) {
    const double width = 0.5 * window.width();
    for (const double x : {window.x0 - width - 0.1, window.x1 + 0.1}) {
      const Area shutter{x, window.y0, x + width, window.y1};
      const double tone = 0.7 * style.trim;
      canvas.Fill(shutter, tone);
      for (double y = shutter.y0 + 0.06; y < shutter.y1 - 0.06; y += 0.075) {
        canvas.Fill({shutter.x0 + 0.06, y, shutter.x1 - 0.06, y + 0.035}, 0.5 * tone);
      }
      canvas.Frame(shutter, 0.05, 0.85 * tone);
      canvas.Frame(shutter, 0.012, 0.4 * tone);
    }
  }
}

void PaintShop(Canvas& canvas, const Area& area, Random& random) {
  const double grey = random.Uniform(35.0, 170.0);
  canvas.Fill(area, grey);
  PaintGrain(canvas, area, random, 0.1);
  const Area board = area.Part(0.03, 0.78, 0.97, 0.96);
  const bool dark = random.Index(2) == 0;
  canvas.Fill(board, dark ? 28.0 : 222.0);
  canvas.Frame(board, 0.04, dark ? 200.0 : 50.0);
  static constexpr const char* kShops[] = {"CAFE",   "BAKERY", "BOOKS",    "HOTEL",  "PHARMACY",
                                           "BIKES",  "CINEMA", "BAR",      "OPTICS", "SHOES",
                                           "TAILOR", "MARKET", "RADIO",    "BANK",   "FLOWERS",
                                           "WINE",   "TOYS",   "BARBER 7", "DELI",   "PHOTO"};
  const std::string name = kShops[random.Index(20)];
  const double height =
      std::min(0.62 * board.height(), 0.6 * board.width() / Canvas::TextWidth(1.0, name));
  canvas.Text(board.center_x() - 0.48 * Canvas::TextWidth(height, name),
              board.center_y() - 0.5 * height, height, name, dark ? 232.0 : 26.0, 0.17);
  const int panes = std::max(2, static_cast<int>(area.width() / 2.3));
  const int door = random.Index(panes);
  for (int k = 0; k < panes; ++k) {
    const double x = area.x0 + 0.03 * area.width() + k * 0.94 * area.width() / panes;
    const Area pane{x + 0.12, area.y0 + (k == door ? 0.05 : 0.6), x + 0.94 * area.width() / panes,
                    area.y0 + 0.74 * area.height()};
    if (k == door) {
      PaintDoor(canvas, {pane.x0 + 0.1, area.y0, std::min(pane.x1, pane.x0 + 1.3), pane.y1}, random,
                random.Uniform(45.0, 120.0));
      continue;
    }
    if (random.Index(7) == 0) {  // a shutter, sprayed on
      for (double y = pane.y0; y < pane.y1; y += 0.12) {
        canvas.Fill({pane.x0, y, pane.x1, y + 0.1}, NearGrey(random, 150.0, 10.0));
      }
      canvas.Text(pane.x0 + 0.1, pane.y0 + 0.3, 0.3 * pane.width(), RandomCode(random).substr(0, 3),
                  40.0, 0.22);
      continue;
    }
    canvas.FillGradient(pane, 62.0, 30.0);
    // Goods on two boards, notices on the glass.
    for (const double f : {0.04, 0.45}) {
      double gx = pane.x0 + 0.1;
      const double y = pane.y0 + f * pane.height();
      canvas.Fill({pane.x0, y - 0.04, pane.x1, y}, 150.0);
      while (gx < pane.x1 - 0.25) {
        const double w = random.Uniform(0.1, 0.32);
        const double h = random.Uniform(0.15, 0.55);
        const double tone = random.Uniform(60.0, 235.0);
        if (random.Index(3) == 0) {
          canvas.FillDisc(gx + 0.5 * w, y + 0.5 * w, 0.5 * w, tone);
          canvas.FillDisc(gx + 0.5 * w, y + 0.5 * w, 0.2 * w, 0.4 * tone);
        } else {
          canvas.Fill({gx, y, gx + w, y + h}, tone);
          canvas.Fill({gx, y + 0.4 * h, gx + w, y + 0.6 * h}, 0.4 * tone);
        }
        gx += w + random.Uniform(0.03, 0.25);
      }
    }
    if (random.Index(2) == 0) PaintLabel(canvas, pane.Part(0.58, 0.55, 0.92, 0.9), random);
    canvas.FillConvex({{pane.x0 + 0.1 * pane.width(), pane.y0},
                       {pane.x0 + 0.3 * pane.width(), pane.y0},
                       {pane.x0 + 0.75 * pane.width(), pane.y1},
                       {pane.x0 + 0.55 * pane.width(), pane.y1}},
                      215.0, 0.22);
    canvas.Frame(pane, 0.05, std::min(235.0, 1.4 * grey + 30.0));
  }
  canvas.Shadow(area.center_x(), board.y0 - 0.05, 0.5 * area.width(), 0.02, 0.0, 0.25, 0.4);
}

void PaintCornice(Canvas& canvas, const Area& area, double trim) {
  canvas.Fill(area, trim);
  canvas.Fill(area.Part(0.0, 0.7, 1.0, 0.78), 0.5 * trim);
  for (double x = area.x0 + 0.05; x < area.x1 - 0.1; x += 0.34) {
    canvas.Fill({x, area.y0, x + 0.17, area.y0 + 0.55 * area.height()}, 0.55 * trim);
  }
  canvas.Shadow(area.center_x(), area.y0 - 0.03, 0.5 * area.width(), 0.02, 0.0, 0.3, 0.5);
}

// On the lane on the side of `s`: an arrow, a drain at the kerb, a manhole.
void PaintRoadMarks(Canvas& canvas, double x, double middle, double s, Random& random) {
  const double y = middle + 3.9 * s;
  canvas.Fill({x - 1.0, y - 0.08, x + 1.0, y + 0.08}, 214.0, 0.85);
  const double tip = x + 1.5 * s;
  if (s > 0.0) {
    canvas.FillConvex({{x + 0.8, y - 0.3}, {tip, y}, {x + 0.8, y + 0.3}}, 214.0, 0.85);
  } else {
    canvas.FillConvex({{x - 0.8, y + 0.3}, {tip, y}, {x - 0.8, y - 0.3}}, 214.0, 0.85);
  }
  const double gutter = middle + 6.9 * s;
  PaintGrating(canvas, {x + 3.0, gutter - 0.22, x + 3.5, gutter + 0.22}, random, 0.07);
  canvas.FillDisc(x - 4.0, y, 0.36, 44.0);
  canvas.FillRing(x - 4.0, y, 0.33, 0.05, 132.0);
  for (int k = -2; k <= 2; ++k) {
    canvas.Fill({x - 4.2, y + 0.1 * k - 0.02, x - 3.8, y + 0.1 * k + 0.02}, 128.0);
  }
}

}  // namespace

void PaintFacade(Canvas& canvas, const Area& area, Random& random, bool ground) {
  const Style style = DrawStyle(random);
  PaintWallMaterial(canvas, area, random, style);
  const double foot_height = ground ? random.Uniform(3.5, 4.1) : 0.4;
  const double top = area.y1 - 0.75;
  const int floors = std::max(1, static_cast<int>((top - foot_height) / random.Uniform(2.9, 3.3)));
  const double floor = (top - foot_height) / floors;
  const int bays = std::max(2, static_cast<int>(area.width() / random.Uniform(2.2, 3.0)));
  const double bay = area.width() / bays;
  const double width = std::min(random.Uniform(1.0, 1.35), style.shutters ? 0.42 * bay : 0.6 * bay);
  if (style.quoins) {
    for (double y = area.y0; y < top; y += 0.7) {
      for (const double s : {0.0, 0.35}) {
        const double w = s == 0.0 ? 0.55 : 0.35;
        const double tone = NearGrey(random, style.trim, 12.0);
        canvas.Fill({area.x0, y + s + 0.015, area.x0 + w, y + s + 0.335}, tone);
        canvas.Fill({area.x1 - w, y + s + 0.015, area.x1, y + s + 0.335}, tone);
      }
    }
  }
  for (int f = 0; f < floors; ++f) {
    const double y = foot_height + f * floor;
    if (f == 0 || random.Index(2) == 0) {
      canvas.Fill({area.x0, y, area.x1, y + 0.16}, style.trim);
      canvas.Fill({area.x0, y, area.x1, y + 0.04}, 0.5 * style.trim);
    }
    const bool balcony = style.balconies && f % 2 == 1;
    for (int b = 0; b < bays; ++b) {
      const double x = area.x0 + (b + 0.5) * bay;
      const double low = y + (balcony ? 0.35 : 0.85);
      const Area window{x - 0.5 * width, low, x + 0.5 * width,
                        std::min(y + 0.8 * floor, low + 2.1)};
      PaintFacadeWindow(canvas, window, random, style);
      if (balcony) PaintBalcony(canvas, window);
    }
  }
  PaintCornice(canvas, {area.x0, top, area.x1, area.y1}, style.trim);
  const Area foot{area.x0, area.y0, area.x1, area.y0 + foot_height};
  if (!ground) {
    PaintStones(canvas, foot, random, 0.8 * style.grey);
  } else if (random.Index(3) != 0) {
    PaintShop(canvas, foot, random);
  } else {
    PaintStones(canvas, {area.x0, area.y0, area.x1, area.y0 + 0.9}, random, 0.75 * style.grey);
    for (int b = 0; b < bays; ++b) {
      const double x = area.x0 + (b + 0.5) * bay;
      if (b == bays / 2) {
        PaintDoor(canvas, {x - 0.75, area.y0, x + 0.75, area.y0 + 2.6}, random,
                  random.Uniform(40.0, 110.0));
        PaintLabel(canvas, {x + 0.9, area.y0 + 1.4, x + 1.3, area.y0 + 1.75}, random);
      } else {
        PaintFacadeWindow(canvas, {x - 0.5 * width, area.y0 + 1.3, x + 0.5 * width, area.y0 + 2.9},
                          random, style);
      }
    }
  }
  const double pipe = random.Index(2) == 0 ? area.x0 + 0.15 : area.x1 - 0.28;
  PaintPipe(canvas, {pipe, area.y0, pipe + 0.13, top}, random, random.Uniform(60.0, 150.0));
  PaintWear(canvas, area, random, 0.2, 30);
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.5, 3.0, 4, 0.6), 0.16);  // rain streaks
}

void PaintPartyWall(Canvas& canvas, const Area& area, Random& random) {
  PaintBricks(canvas, area, random, 0.3, 0.12, random.Uniform(95.0, 150.0), 24.0);
  if (random.Index(2) == 0) PaintPoster(canvas, area.Part(0.1, 0.55, 0.5, 0.9), random);
  PaintWear(canvas, area, random, 0.3, 20);
}

void PaintRoofTiles(Canvas& canvas, const Area& area, Random& random) {
  PaintBricks(canvas, area, random, 0.3, 0.3, random.Uniform(70.0, 110.0), 18.0);
}

void PaintRoad(Canvas& canvas, const Area& area, Random& random) {
  canvas.Fill(area, 92.0);
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 3.1, 6, 0.6), 0.45);
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.07, 2, 0.9), [](float g, float n) {
    const float stone = std::clamp((n - 0.4f) * 5.0f, 0.0f, 1.0f);
    return g * (1.0f + 0.32f * n) + 40.0f * stone;
  });
  const double middle = area.center_y();
  for (int k = 0; k < static_cast<int>(area.width() / 3.0); ++k) {  // patches
    const double y = middle + (random.Index(2) == 0 ? 1.0 : -1.0) * random.Uniform(3.0, 6.6);
    const double x = random.Uniform(area.x0, area.x1);
    const double hx = random.Uniform(0.3, 1.6);
    const double hy = random.Uniform(0.2, 0.7);
    canvas.FillTurned(x, y, hx + 0.05, hy + 0.05, 0.0, 38.0, 0.8, 0.04);
    canvas.FillTurned(x, y, hx, hy, 0.0, random.Uniform(62.0, 130.0), 0.8, 0.04);
  }
  PaintCracks(canvas, area, random, static_cast<int>(4.0 * area.width()), 36.0);
  // The tramway: setts and rails.
  const Area tram{area.x0, middle - 2.4, area.x1, middle + 2.4};
  PaintBricks(canvas, tram, random, 0.22, 0.15, 128.0, 38.0);
  for (const double lane : {-1.25, 1.25}) {
    for (const double rail : {-0.72, 0.72}) {
      const double y = middle + lane + rail;
      canvas.Fill({area.x0, y - 0.09, area.x1, y + 0.09}, 58.0);
      canvas.Fill({area.x0, y - 0.045, area.x1, y + 0.01}, 196.0);
      canvas.Fill({area.x0, y + 0.01, area.x1, y + 0.035}, 14.0);
    }
  }
  for (const double s : {-1.0, 1.0}) {  // lines, worn by wheels
    PaintWornFill(canvas, {area.x0, middle + 2.5 * s - 0.06, area.x1, middle + 2.5 * s + 0.06},
                  random, 222.0, 0.35);
    for (double x = area.x0; x < area.x1; x += 3.0) {
      PaintWornFill(
          canvas,
          {x, middle + 5.15 * s - 0.06, std::min(area.x1, x + 1.4), middle + 5.15 * s + 0.06},
          random, 218.0, 0.4);
    }
    for (double x = area.x0 + 12.0; x < area.x1 - 5.0; x += random.Uniform(16.0, 30.0)) {
      PaintRoadMarks(canvas, x, middle, s, random);
    }
  }
  for (double x = area.x0 + 20.0; x < area.x1 - 10.0; x += random.Uniform(38.0, 55.0)) {
    for (double y = area.y0 + 0.4; y < area.y1 - 0.4; y += 1.0) {  // a crossing
      PaintWornFill(canvas, {x, y, x + 3.0, y + 0.5}, random, 226.0, 0.4);
    }
  }
  PaintWear(canvas, area, random, 0.25, static_cast<int>(5.0 * area.width()));
}

void PaintPavement(Canvas& canvas, const Area& area, Random& random) {
  PaintTiles(canvas, area, random, 0.5, 142.0, 156.0, 0.0);
  for (const double y : {area.y0, area.y1 - 0.3}) {
    PaintBricks(canvas, {area.x0, y, area.x1, y + 0.3}, random, 0.3, 0.1, 165.0, 26.0);
  }
  for (int k = 0; k < static_cast<int>(area.width() * area.height() * 3.0); ++k) {  // chewing gum
    canvas.FillDisc(random.Uniform(area.x0, area.x1), random.Uniform(area.y0, area.y1),
                    random.Uniform(0.012, 0.035), random.Index(3) == 0 ? 205.0 : 70.0, 0.7);
  }
  PaintWear(canvas, area, random, 0.3, static_cast<int>(area.width()));
}

void PaintGrass(Canvas& canvas, const Area& area, Random& random) {
  canvas.Fill(area, 92.0);
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 9.0, 7, 0.8), 0.8);
}

}  // namespace duet
