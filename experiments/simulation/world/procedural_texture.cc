#include "experiments/simulation/world/procedural_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace duet {
namespace {

// Calls f(cell, i, j) for the cells of a grid that starts at the area's low corner.
template <typename F>
void ForCells(const Area& area, double width, double height, F f) {
  const int columns = static_cast<int>(std::ceil(area.width() / width - 1e-6));
  const int rows = static_cast<int>(std::ceil(area.height() / height - 1e-6));
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double x = area.x0 + j * width;
      const double y = area.y0 + i * height;
      f(Area{x, y, std::min(x + width, area.x1), std::min(y + height, area.y1)}, i, j);
    }
  }
}

}  // namespace

double NearGrey(Random& random, double grey, double spread) {
  return std::clamp(grey + random.Uniform(-spread, spread), 12.0, 245.0);
}

std::string RandomWord(Random& random) {
  static constexpr std::array<const char*, 28> kWords = {
      "EXIT",   "CAUTION", "HIGH VOLTAGE", "LAB",      "STORE", "TOOLS",      "FRAGILE",
      "DANGER", "PRESS",   "GATE",         "NORTH",    "PUMP",  "FILTER",     "WINDOW",
      "STATE",  "MOTOR",   "VALVE",        "NO ENTRY", "OIL",   "KEEP CLEAR", "MAINS",
      "LIFT",   "STOP",    "PANEL",        "RELAY",    "SPARE", "NOTICE",     "SERVICE"};
  return kWords[random.Index(static_cast<int>(kWords.size()))];
}

std::string RandomCode(Random& random) {
  std::string code;
  code += static_cast<char>('A' + random.Index(26));
  if (random.Index(2) == 0) code += static_cast<char>('A' + random.Index(26));
  code += '-';
  const int digits = 2 + random.Index(3);
  for (int k = 0; k < digits; ++k) code += static_cast<char>('0' + random.Index(10));
  return code;
}

void PaintGrain(Canvas& canvas, const Area& area, Random& random, double amplitude) {
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.06, 4, 0.8), amplitude);
}

void PaintWear(Canvas& canvas, const Area& area, Random& random, double strength, int count) {
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 1.7, 5, 0.6), strength);
  for (int k = 0; k < count; ++k) {
    const double size = 0.04 * std::exp(random.Uniform(0.0, 1.8));
    canvas.Shadow(random.Uniform(area.x0, area.x1), random.Uniform(area.y0, area.y1), 0.3 * size,
                  0.2 * size * random.Uniform(0.5, 1.5), random.Uniform(0.0, std::numbers::pi),
                  size, random.Uniform(-0.5, 1.0) * strength);
  }
  for (int k = 0; k < count; ++k) {
    const double x = random.Uniform(area.x0, area.x1);
    const double y = random.Uniform(area.y0, area.y1);
    const double angle = random.Uniform(0.0, std::numbers::pi);
    const double length = random.Uniform(0.04, 0.35);
    canvas.Line(x, y, x + length * std::cos(angle), y + length * std::sin(angle),
                random.Uniform(0.002, 0.006), random.Index(2) == 0 ? 40.0 : 220.0, strength);
  }
}

void PaintCracks(Canvas& canvas, const Area& area, Random& random, int count, double grey) {
  for (int k = 0; k < count; ++k) {
    double x = random.Uniform(area.x0, area.x1);
    double y = random.Uniform(area.y0, area.y1);
    double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const int steps = 6 + random.Index(20);
    for (int s = 0; s < steps; ++s) {
      angle += random.Uniform(-0.7, 0.7);
      const double length = random.Uniform(0.03, 0.12);
      const double nx = x + length * std::cos(angle);
      const double ny = y + length * std::sin(angle);
      canvas.Line(x, y, nx, ny, random.Uniform(0.003, 0.008), grey, 0.8);
      x = nx;
      y = ny;
    }
  }
}

void PaintPlaster(Canvas& canvas, const Area& area, Random& random, double grey) {
  canvas.Fill(area, grey);
  canvas.AddNoise(area, FractalNoise(random.Next(), 1.3, 4), 0.11 * grey);
  canvas.AddNoise(area, FractalNoise(random.Next(), 0.05, 3, 0.8), 0.05 * grey);
}

void PaintConcrete(Canvas& canvas, const Area& area, Random& random, double grey,
                   double joint_pitch_m) {
  canvas.Fill(area, grey);
  canvas.AddNoise(area, FractalNoise(random.Next(), 2.6, 6, 0.65), 0.3 * grey);
  const auto dark = static_cast<float>(0.55 * grey);
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.09, 3, 0.8), [dark](float g, float n) {
    // Pores: where the noise is deepest.
    const float pore = std::clamp((-n - 0.42f) * 6.0f, 0.0f, 1.0f);
    return g + pore * (dark - g) + 9.0f * n;
  });
  if (joint_pitch_m <= 0.0) return;
  ForCells(area, joint_pitch_m, joint_pitch_m, [&](const Area& cell, int, int) {
    canvas.Map(cell, [t = static_cast<float>(random.Uniform(0.9, 1.1))](float g, float, float) {
      return g * t;
    });
    canvas.Fill({cell.x0 - 0.006, cell.y0, cell.x0 + 0.006, cell.y1}, 0.3 * grey, 0.85);
    canvas.Fill({cell.x0, cell.y0 - 0.006, cell.x1, cell.y0 + 0.006}, 0.3 * grey, 0.85);
  });
}

void PaintBricks(Canvas& canvas, const Area& area, Random& random, double brick_width_m,
                 double brick_height_m, double grey, double spread) {
  const double mortar = grey > 120.0 ? 0.55 * grey : std::min(230.0, 1.55 * grey + 20.0);
  canvas.Fill(area, mortar);
  canvas.AddNoise(area, FractalNoise(random.Next(), 0.06, 3, 0.8), 18.0);
  const double joint = 0.14 * brick_height_m;
  const int rows = static_cast<int>(std::ceil(area.height() / brick_height_m));
  const int columns = static_cast<int>(std::ceil(area.width() / brick_width_m)) + 1;
  for (int i = 0; i < rows; ++i) {
    const double y = area.y0 + i * brick_height_m;
    const double shift = (i % 2 == 0 ? 0.0 : -0.5) * brick_width_m;
    for (int j = 0; j < columns; ++j) {
      const double x = area.x0 + j * brick_width_m + shift;
      double tone = NearGrey(random, grey, spread);
      if (random.Index(13) == 0) tone = NearGrey(random, 0.55 * grey, spread);
      canvas.Fill({std::max(area.x0, x), y, std::min(area.x1, x + brick_width_m - joint),
                   std::min(area.y1, y + brick_height_m - joint)},
                  tone);
    }
  }
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.08, 4, 0.8), 0.16);
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 2.2, 4), 0.22);
}

void PaintBoards(Canvas& canvas, const Area& area, Random& random, bool along_x,
                 double board_width_m, double grey, double spread) {
  const double span = along_x ? area.height() : area.width();
  const double length = along_x ? area.width() : area.height();
  const int boards = std::max(1, static_cast<int>(std::lround(span / board_width_m)));
  const double pitch = span / boards;
  const auto place = [&](double along0, double across0, double along1, double across1) {
    return along_x ? Area{area.x0 + along0, area.y0 + across0, area.x0 + along1, area.y0 + across1}
                   : Area{area.x0 + across0, area.y0 + along0, area.x0 + across1, area.y0 + along1};
  };
  for (int b = 0; b < boards; ++b) {
    double start = length > 2.5 ? -random.Uniform(0.0, 1.5) : 0.0;
    while (start < length) {
      const double end = length > 2.5 ? start + random.Uniform(1.4, 2.6) : length;
      const Area board =
          place(std::max(0.0, start), b * pitch, std::min(end, length), (b + 1) * pitch);
      canvas.Fill(board, NearGrey(random, grey, spread));
      const double fine = 0.16 * pitch;
      const FractalNoise grain = along_x ? FractalNoise(random.Next(), 0.9, fine, 3, 0.7)
                                         : FractalNoise(random.Next(), fine, 0.9, 3, 0.7);
      canvas.ScaleNoise(board, grain, 0.34);
      if (random.Index(3) != 0) {
        const double x = random.Uniform(board.x0, board.x1);
        const double y = random.Uniform(board.y0, board.y1);
        const double knot = std::min(0.2 * pitch, 0.018) * random.Uniform(0.6, 1.2);
        canvas.FillDisc(x, y, knot, 0.45 * grey, 0.8);
        canvas.FillRing(x, y, 2.1 * knot, 0.4 * knot, 0.6 * grey, 0.7);
      }
      canvas.Frame(board, 0.004, 0.25 * grey, 0.9);
      const Area nails = board.Inset(std::min(0.03, 0.2 * pitch));
      for (const double x : {nails.x0, nails.x1}) {
        for (const double y : {nails.y0, nails.y1}) canvas.FillDisc(x, y, 0.005, 40.0, 0.9);
      }
      start = end;
    }
  }
}

void PaintTiles(Canvas& canvas, const Area& area, Random& random, double size_m, double grey_a,
                double grey_b, double ornament_share) {
  canvas.Fill(area, 0.45 * std::min(grey_a, grey_b));
  ForCells(area, size_m, size_m, [&](const Area& cell, int i, int j) {
    const double base = (i + j) % 2 == 0 ? grey_a : grey_b;
    const double tone = NearGrey(random, base, 14.0);
    canvas.Fill(cell.Inset(0.012 * size_m + 0.001), tone);
    if (random.Uniform() >= ornament_share) return;
    const double ink = tone > 120.0 ? tone - 85.0 : tone + 85.0;
    const double x = cell.center_x();
    const double y = cell.center_y();
    const int kind = random.Index(3);
    if (kind == 0) {
      canvas.FillTurned(x, y, 0.26 * size_m, 0.26 * size_m, std::numbers::pi / 4, ink);
      canvas.FillTurned(x, y, 0.12 * size_m, 0.12 * size_m, std::numbers::pi / 4, tone);
    } else if (kind == 1) {
      canvas.FillRing(x, y, 0.36 * size_m, 0.08 * size_m, ink);
      canvas.FillDisc(x, y, 0.12 * size_m, ink);
    } else {
      canvas.Line(cell.x0 + 0.2 * size_m, cell.y0 + 0.2 * size_m, cell.x1 - 0.2 * size_m,
                  cell.y1 - 0.2 * size_m, 0.1 * size_m, ink);
      canvas.Line(cell.x0 + 0.2 * size_m, cell.y1 - 0.2 * size_m, cell.x1 - 0.2 * size_m,
                  cell.y0 + 0.2 * size_m, 0.1 * size_m, ink);
    }
  });
  PaintGrain(canvas, area, random, 0.12);
}

void PaintPuzzleMats(Canvas& canvas, const Area& area, Random& random, double size_m) {
  ForCells(area, size_m, size_m, [&](const Area& cell, int i, int j) {
    const double tone = ((i + j) % 2 == 0 ? 78.0 : 132.0) + random.Uniform(-16.0, 16.0);
    canvas.Fill(cell, tone);
  });
  // Tongues across the joints, alternately to either side.
  ForCells(area, size_m, size_m, [&](const Area& cell, int i, int j) {
    const int tongues = 6;
    for (int k = 0; k < tongues; ++k) {
      const double along = (k + 0.5) / tongues * size_m;
      const double out = k % 2 == 0 ? 0.02 : -0.02;
      const double tone = (((i + j) % 2 == 0) == (k % 2 == 0) ? 80.0 : 130.0);
      canvas.FillTurned(cell.x0 + along, cell.y0 + out, 0.032, 0.022, 0.0, tone, 0.9, 0.008);
      canvas.FillTurned(cell.x0 + out, cell.y0 + along, 0.022, 0.032, 0.0, tone, 0.9, 0.008);
    }
    canvas.Fill({cell.x0 - 0.002, cell.y0, cell.x0 + 0.002, cell.y1}, 30.0, 0.5);
    canvas.Fill({cell.x0, cell.y0 - 0.002, cell.x1, cell.y0 + 0.002}, 30.0, 0.5);
  });
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.035, 2, 0.8), [](float g, float n) {
    const float fleck = std::clamp((n - 0.38f) * 6.0f, 0.0f, 1.0f);
    return g * (1.0f + 0.16f * n) + fleck * 42.0f;
  });
}

void PaintRug(Canvas& canvas, const Area& area, Random& random) {
  const double dark = random.Uniform(30.0, 60.0);
  const double bright = random.Uniform(175.0, 215.0);
  const double middle = random.Uniform(95.0, 130.0);
  canvas.Fill(area, dark);
  canvas.Frame(area.Inset(0.05), 0.03, bright);
  canvas.Frame(area.Inset(0.14), 0.16, middle);
  canvas.Frame(area.Inset(0.34), 0.02, bright);
  const Area border = area.Inset(0.22);
  for (double s = 0.12; s < border.width() - 0.05; s += 0.17) {
    for (const double y : {border.y0, border.y1}) {
      canvas.FillTurned(border.x0 + s, y, 0.042, 0.042, std::numbers::pi / 4, bright);
      canvas.FillTurned(border.x0 + s, y, 0.018, 0.018, std::numbers::pi / 4, dark);
    }
  }
  for (double s = 0.12; s < border.height() - 0.05; s += 0.17) {
    for (const double x : {border.x0, border.x1}) {
      canvas.FillTurned(x, border.y0 + s, 0.042, 0.042, std::numbers::pi / 4, bright);
      canvas.FillTurned(x, border.y0 + s, 0.018, 0.018, std::numbers::pi / 4, dark);
    }
  }
  // Medallions of irregular make over the middle.
  const Area inner = area.Inset(0.45);
  const int columns = std::max(1, static_cast<int>(inner.width() / 0.42));
  const int rows = std::max(1, static_cast<int>(inner.height() / 0.42));
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double x = inner.x0 + (j + 0.5) * inner.width() / columns;
      const double y = inner.y0 + (i + 0.5) * inner.height() / rows;
      const double size = random.Uniform(0.09, 0.17);
      const double tone = random.Index(2) == 0 ? bright : middle;
      if (random.Index(2) == 0) {
        canvas.FillTurned(x, y, size, size, std::numbers::pi / 4 + random.Uniform(-0.1, 0.1), tone);
        canvas.FillTurned(x, y, 0.6 * size, 0.6 * size, std::numbers::pi / 4, dark);
      } else {
        canvas.FillDisc(x, y, size, tone);
        canvas.FillDisc(x, y, 0.65 * size, dark);
      }
      for (int k = 0; k < 6; ++k) {
        const double angle = k * std::numbers::pi / 3 + random.Uniform(0.0, 0.6);
        canvas.FillDisc(x + 0.4 * size * std::cos(angle), y + 0.4 * size * std::sin(angle),
                        0.15 * size, bright);
      }
      canvas.FillTurned(x + 0.21, y + 0.2, 0.03, 0.03, random.Uniform(0.0, std::numbers::pi),
                        middle);
    }
  }
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.03, 2, 0.8), 0.22);
}

void PaintCeilingBoards(Canvas& canvas, const Area& area, Random& random, double size_m) {
  canvas.Fill(area, 178.0);
  ForCells(area, size_m, size_m, [&](const Area& cell, int, int) {
    canvas.Fill(cell, NearGrey(random, 176.0, 14.0));
    if (random.Index(9) == 0) {  // a water stain
      canvas.Shadow(random.Uniform(cell.x0, cell.x1), random.Uniform(cell.y0, cell.y1), 0.06, 0.04,
                    random.Uniform(0.0, std::numbers::pi), 0.18, 0.35);
    }
  });
  // Fissures and pinholes, as mineral boards have.
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.045, 0.03, 2, 0.8), [](float g, float n) {
    const float hole = std::clamp((-n - 0.36f) * 7.0f, 0.0f, 1.0f);
    return g * (1.0f - 0.55f * hole);
  });
  ForCells(area, size_m, size_m, [&](const Area& cell, int, int) {
    canvas.Fill({cell.x0 - 0.012, cell.y0, cell.x0 + 0.012, cell.y1}, 222.0);
    canvas.Fill({cell.x0, cell.y0 - 0.012, cell.x1, cell.y0 + 0.012}, 222.0);
    canvas.Fill({cell.x0 + 0.012, cell.y0, cell.x0 + 0.018, cell.y1}, 70.0, 0.8);
    canvas.Fill({cell.x0, cell.y0 + 0.012, cell.x1, cell.y0 + 0.018}, 70.0, 0.8);
  });
}

void PaintWallPanels(Canvas& canvas, const Area& area, Random& random, double pitch_x_m,
                     double pitch_y_m, double grey, double spread) {
  ForCells(area, pitch_x_m, pitch_y_m, [&](const Area& cell, int, int) {
    canvas.Fill(cell, NearGrey(random, grey, spread));
    canvas.Fill({cell.x0, cell.y0, cell.x0 + 0.008, cell.y1}, 0.3 * grey);
    canvas.Fill({cell.x0, cell.y0, cell.x1, cell.y0 + 0.008}, 0.3 * grey);
    canvas.Fill({cell.x0 + 0.008, cell.y0 + 0.008, cell.x0 + 0.014, cell.y1},
                std::min(240.0, 1.25 * grey));
    const Area screws = cell.Inset(0.05);
    for (const double x : {screws.x0, screws.x1}) {
      for (const double y : {screws.y0, screws.y1}) {
        canvas.FillDisc(x, y, 0.012, 0.4 * grey);
        canvas.FillDisc(x, y, 0.007, std::min(240.0, 1.3 * grey));
      }
    }
  });
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.9, 4), 0.12);
  PaintGrain(canvas, area, random, 0.05);
}

void PaintSheetMetal(Canvas& canvas, const Area& area, Random& random, double rib_pitch_m,
                     double grey) {
  canvas.Fill(area, grey);
  const int ribs = static_cast<int>(area.width() / rib_pitch_m) + 1;
  for (int k = 0; k < ribs; ++k) {
    const double x = area.x0 + k * rib_pitch_m;
    canvas.Fill({x, area.y0, std::min(area.x1, x + 0.18 * rib_pitch_m), area.y1},
                std::min(240.0, 1.3 * grey));
    canvas.Fill(
        {x + 0.5 * rib_pitch_m, area.y0, std::min(area.x1, x + 0.68 * rib_pitch_m), area.y1},
        0.62 * grey);
  }
  // Sheets overlap and are screwed down where they do.
  for (double y = area.y0 + random.Uniform(0.8, 1.6); y < area.y1; y += random.Uniform(1.3, 2.1)) {
    canvas.Fill({area.x0, y, area.x1, y + 0.02}, 0.45 * grey, 0.9);
    for (int k = 0; k < ribs; k += 2) {
      canvas.FillDisc(area.x0 + (k + 0.35) * rib_pitch_m, y + 0.06, 0.018, 0.35 * grey);
    }
  }
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.8, 2.4, 5, 0.65), 0.3);
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.5, 1.2, 5, 0.7), [](float g, float n) {
    const float rust = std::clamp((n - 0.28f) * 5.0f, 0.0f, 1.0f);
    return g * (1.0f - 0.45f * rust);
  });
}

void PaintWindow(Canvas& canvas, const Area& area, Random& random, int columns, int rows,
                 double frame_grey, double glass_grey) {
  const double frame = std::clamp(0.05 * std::min(area.width(), area.height()), 0.03, 0.09);
  canvas.Fill(area, frame_grey);
  canvas.Frame(area, 0.35 * frame, 0.45 * frame_grey);
  const Area inner = area.Inset(frame);
  const double bar = 0.6 * frame;
  const double pane_width = (inner.width() - (columns - 1) * bar) / columns;
  const double pane_height = (inner.height() - (rows - 1) * bar) / rows;
  const bool blind = random.Index(3) == 0;
  const double blind_end = random.Uniform(0.25, 0.85);
  const double inside = glass_grey * random.Uniform(0.55, 1.35);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double x = inner.x0 + j * (pane_width + bar);
      const double y = inner.y0 + i * (pane_height + bar);
      const Area pane{x, y, x + pane_width, y + pane_height};
      canvas.Fill(pane, inside);
      canvas.FillGradient(pane, inside, inside + random.Uniform(0.25, 0.6) * glass_grey + 10.0);
      // A slanted reflection, kept within the pane.
      const double s = random.Uniform(0.1, 0.5) * pane_width;
      canvas.FillConvex({{pane.x0 + s, pane.y0},
                         {pane.x0 + s + 0.25 * pane_width, pane.y0},
                         {pane.x1, pane.y1},
                         {pane.x1 - 0.3 * pane_width, pane.y1}},
                        205.0, 0.35);
    }
  }
  if (blind) {
    const double y_end = inner.y1 - blind_end * inner.height();
    for (double y = inner.y1; y > y_end; y -= 0.05) {
      canvas.Fill({inner.x0, std::max(y - 0.034, y_end), inner.x1, y}, 198.0, 0.85);
    }
  } else if (random.Index(2) == 0) {
    const double w = random.Uniform(0.12, 0.3) * inner.width();
    for (double x = 0.0; x < w; x += 0.06) {
      const double tone = random.Uniform(120.0, 215.0);
      canvas.Fill({inner.x0 + x, inner.y0, inner.x0 + x + 0.06, inner.y1}, tone, 0.85);
      canvas.Fill({inner.x1 - x - 0.06, inner.y0, inner.x1 - x, inner.y1}, tone, 0.85);
    }
  }
  canvas.MapNoise(inner, FractalNoise(random.Next(), 0.5, 4, 0.6),
                  [](float g, float n) { return g * (1.0f + 0.3f * n); });
}

void PaintDoor(Canvas& canvas, const Area& area, Random& random, double grey) {
  canvas.Fill(area, std::min(235.0, 1.5 * grey + 40.0));
  const double edge = std::min(0.07, 0.1 * area.width());
  const Area leaf{area.x0 + edge, area.y0, area.x1 - edge, area.y1 - edge};
  canvas.Fill(leaf, grey);
  canvas.ScaleNoise(leaf, FractalNoise(random.Next(), 0.05, 0.8, 4, 0.7), 0.2);
  canvas.Frame(leaf, 0.008, 0.3 * grey);
  for (const auto& [y0, y1] : {std::pair(0.06, 0.42), std::pair(0.52, 0.93)}) {
    const Area panel = leaf.Part(0.14, y0, 0.86, y1);
    canvas.Frame(panel, 0.02, 0.5 * grey);
    canvas.Frame(panel.Inset(0.02), 0.012, std::min(235.0, 1.5 * grey));
  }
  const Area plate = leaf.Part(0.3, 0.72, 0.7, 0.8);
  canvas.Fill(plate, 220.0);
  const std::string code = RandomCode(random);
  const double height = 0.5 * plate.height();
  canvas.Text(plate.center_x() - 0.5 * Canvas::TextWidth(height, code),
              plate.y0 + 0.25 * plate.height(), height, code, 30.0);
  canvas.FillTurned(leaf.x1 - 0.08, leaf.y0 + 0.46 * leaf.height(), 0.02, 0.08, 0.0, 200.0);
  canvas.FillDisc(leaf.x1 - 0.08, leaf.y0 + 0.48 * leaf.height(), 0.025, 40.0);
  canvas.Fill(leaf.Part(0.0, 0.0, 1.0, 0.05), 150.0, 0.8);
  PaintGrain(canvas, area, random, 0.06);
}

void PaintGrating(Canvas& canvas, const Area& area, Random& random, double pitch_m) {
  canvas.Fill(area, 34.0);
  canvas.ScaleNoise(area, FractalNoise(random.Next(), 0.3, 3), 0.4);
  for (double x = area.x0; x < area.x1; x += pitch_m) {
    canvas.Fill({x, area.y0, x + 0.35 * pitch_m, area.y1}, NearGrey(random, 160.0, 20.0));
  }
  for (double y = area.y0; y < area.y1; y += 2.6 * pitch_m) {
    canvas.Fill({area.x0, y, area.x1, y + 0.35 * pitch_m}, NearGrey(random, 140.0, 20.0));
  }
  canvas.Frame(area, 0.05, 120.0);
  canvas.Frame(area, 0.012, 40.0);
}

void PaintHazardStripes(Canvas& canvas, const Area& area, double pitch_m, double dark,
                        double bright) {
  const double edge = Canvas::kEdgeTexels * canvas.texel_m();
  canvas.Map(area, [=](float, float x, float y) {
    const double phase = (x + y) * 0.70710678 / pitch_m;
    const double from_middle = std::abs(phase - std::floor(phase) - 0.5) * pitch_m;
    const double a = std::clamp(0.5 - (from_middle - 0.25 * pitch_m) / edge, 0.0, 1.0);
    return static_cast<float>(dark + a * (bright - dark));
  });
}

void PaintWornFill(Canvas& canvas, const Area& area, Random& random, double grey, double worn) {
  const auto paint = static_cast<float>(grey);
  const auto lost = static_cast<float>(worn);
  canvas.MapNoise(area, FractalNoise(random.Next(), 0.12, 3, 0.7), [=](float g, float n) {
    const float a = std::clamp(0.5f + (n + 0.75f - lost) * 5.0f, 0.0f, 1.0f);
    return g + 0.9f * a * (paint - g);
  });
}

}  // namespace duet
