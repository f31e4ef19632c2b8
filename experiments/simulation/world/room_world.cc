#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/simulation/world/moving_bodies.h"
#include "experiments/simulation/world/object_texture.h"
#include "experiments/simulation/world/procedural_texture.h"
#include "experiments/simulation/world/world_builder.h"
#include "experiments/simulation/world/worlds.h"

namespace duet {
namespace {

using Eigen::Vector3d;
using Side = WorldBuilder::Side;

const Vector3d kLow(-4.5, -4.0, 0.0);
const Vector3d kHigh(4.5, 4.0, 3.2);

// Posters side by side, some one above the other, over all of an area.
void CoverWithPosters(Canvas& canvas, const Area& area, Random& random) {
  double x = area.x0 + random.Uniform(0.05, 0.2);
  int design = random.Index(kPosterDesigns);
  while (x < area.x1 - 0.45) {
    const double width = std::min(random.Uniform(0.5, 0.95), area.x1 - x);
    const double middle = area.y0 + random.Uniform(0.42, 0.58) * area.height();
    const double gap = random.Uniform(0.03, 0.08);
    const bool two = random.Index(3) != 0 && area.height() > 1.0;
    const double top = area.y1 - random.Uniform(0.0, 0.12);
    const double bottom = area.y0 + random.Uniform(0.0, 0.12);
    design += 1 + random.Index(3);
    if (two) {
      PaintPoster(canvas, {x, bottom, x + width, middle - gap}, random, design % kPosterDesigns);
      design += 1 + random.Index(3);
      PaintPoster(canvas, {x, middle + gap, x + width, top}, random, design % kPosterDesigns);
    } else {
      PaintPoster(canvas, {x, bottom, x + width, top}, random, design % kPosterDesigns);
    }
    x += width + random.Uniform(0.08, 0.22);
  }
}

void PaintSocket(Canvas& canvas, double x, double y) {
  canvas.Shadow(x, y - 0.006, 0.04, 0.04, 0.0, 0.012, 0.3);
  canvas.FillTurned(x, y, 0.04, 0.04, 0.0, 228.0, 1.0, 0.008);
  canvas.FillRing(x, y, 0.027, 0.004, 140.0);
  canvas.FillDisc(x - 0.01, y, 0.004, 40.0);
  canvas.FillDisc(x + 0.01, y, 0.004, 40.0);
}

void PaintSkirting(Canvas& canvas, const Area& area, Random& random, double grey) {
  const Area skirting{area.x0, area.y0, area.x1, area.y0 + 0.11};
  canvas.Fill(skirting, grey);
  canvas.Fill({area.x0, skirting.y1 - 0.012, area.x1, skirting.y1}, std::min(240.0, 1.3 * grey));
  canvas.Fill({area.x0, skirting.y1 - 0.02, area.x1, skirting.y1 - 0.012}, 0.4 * grey);
  canvas.ScaleNoise(skirting, FractalNoise(random.Next(), 0.4, 0.05, 4), 0.2);
}

// Written on by hand: boxes, arrows, curves, words.
void PaintWhiteboard(Canvas& canvas, const Area& area, Random& random) {
  canvas.Shadow(area.center_x(), area.center_y() - 0.02, 0.5 * area.width(), 0.5 * area.height(),
                0.0, 0.05, 0.4);
  canvas.Fill(area, 110.0);
  const Area board = area.Inset(0.03);
  canvas.Fill(board, 222.0);
  canvas.AddNoise(board, FractalNoise(random.Next(), 0.7, 4), 22.0);
  for (int k = 0; k < 27; ++k) {
    const double x = random.Uniform(board.x0 + 0.1, board.x1 - 0.5);
    const double y = random.Uniform(board.y0 + 0.1, board.y1 - 0.25);
    const double ink = random.Uniform(25.0, 110.0);
    const Area box{x, y, x + random.Uniform(0.15, 0.4), y + random.Uniform(0.1, 0.22)};
    if (k % 3 == 0) {
      canvas.Frame(box, 0.009, ink);
      canvas.Line(box.x1, box.center_y(), box.x1 + 0.14, box.center_y() + 0.03, 0.009, ink);
      canvas.Line(box.x1 + 0.14, box.center_y() + 0.03, box.x1 + 0.1, box.center_y() + 0.06, 0.009,
                  ink);
      canvas.Text(box.x0 + 0.02, box.y0 + 0.03, 0.05, RandomCode(random), ink, 0.15);
    } else if (k % 3 == 1) {
      canvas.Text(x, y, random.Uniform(0.05, 0.09), RandomWord(random), ink, 0.14);
    } else {
      double last = y;
      for (int s = 1; s < 12; ++s) {
        const double next = y + 0.12 * std::sin(0.7 * s + x) * std::exp(-0.1 * s);
        canvas.Line(x + 0.035 * (s - 1), last, x + 0.035 * s, next, 0.008, ink);
        last = next;
      }
      canvas.Line(x, y - 0.12, x, y + 0.14, 0.006, ink);
      canvas.Line(x, y, x + 0.42, y, 0.006, ink);
    }
  }
  for (int k = 0; k < 4; ++k) {  // sheets that magnets hold
    const double x = board.x0 + (0.04 + 0.25 * k + random.Uniform(0.0, 0.1)) * board.width();
    const double y = random.Uniform(board.y0 + 0.05, board.y1 - 0.42);
    PaintPoster(canvas, {x, y, x + 0.26, y + 0.36}, random);
    canvas.FillDisc(x + 0.13, y + 0.34, 0.016, 30.0);
  }
  canvas.Fill({area.x0 + 0.3, area.y0 - 0.03, area.x1 - 0.3, area.y0}, 170.0);
}

void PaintWindowWithCurtains(Canvas& canvas, const Area& area, Random& random) {
  PaintWindow(canvas, area, random, 3, 2, 215.0, 165.0);
  const double width = random.Uniform(0.5, 0.7);
  Random cloth = random.Fork(1);  // both of the same make
  Random same = cloth;
  PaintCurtain(canvas, {area.x0 - width, area.y0 - 0.35, area.x0 + 0.12, area.y1 + 0.2}, cloth);
  PaintCurtain(canvas, {area.x1 - 0.12, area.y0 - 0.35, area.x1 + width, area.y1 + 0.2}, same);
}

// The walls of the furnished room. Along each, x runs to the right as one looks at it.
void PaintWall(Canvas& canvas, Random& random, Side side) {
  const Area wall = canvas.area();
  const Area lower{wall.x0, 0.0, wall.x1, 1.15};
  if (side == Side::kLowX) {
    PaintPlaster(canvas, wall, random, 150.0);
    PaintBoards(canvas, lower, random, false, 0.14, 112.0, 22.0);
    canvas.Fill({wall.x0, 1.13, wall.x1, 1.19}, 70.0);
    CoverWithPosters(canvas, {wall.x0 + 0.2, 1.3, wall.x0 + 2.35, 2.85}, random);
    PaintWindowWithCurtains(canvas, {3.1, 1.3, 5.1, 2.65}, random);
    CoverWithPosters(canvas, {5.9, 1.3, wall.x1 - 0.3, 2.85}, random);
  } else if (side == Side::kHighX) {
    PaintWallPanels(canvas, wall, random, 1.12, 0.92, 138.0, 24.0);
    PaintDoor(canvas, {1.0, 0.0, 2.0, 2.15}, random, 92.0);
    PaintLabel(canvas, {1.2, 2.25, 1.8, 2.45}, random);
    PaintWhiteboard(canvas, {2.5, 0.95, 4.9, 2.25}, random);
    CoverWithPosters(canvas, {2.4, 2.4, 7.8, 2.95}, random);
    CoverWithPosters(canvas, {5.1, 0.8, 7.8, 2.3}, random);
    for (double x = 2.5; x < 4.6; x += random.Uniform(0.45, 0.7)) {
      const double width = random.Uniform(0.22, 0.36);
      PaintLabel(canvas, {x, 0.35, x + width, 0.35 + random.Uniform(0.18, 0.45)}, random);
    }
    PaintLabel(canvas, {2.08, 1.45, 2.4, 1.85}, random);
    PaintSocket(canvas, 2.2, 1.15);
    PaintSocket(canvas, 2.3, 1.15);
  } else if (side == Side::kLowY) {
    PaintPlaster(canvas, wall, random, 118.0);
    double x = wall.x0 + 0.25;
    for (int k = 0; k < 4; ++k) {  // mattresses lean at the wall
      const double width = random.Uniform(0.95, 1.3);
      PaintMattress(canvas, {x, 0.1, x + width, random.Uniform(1.85, 2.1)}, random);
      x += width + random.Uniform(0.05, 0.15);
    }
    CoverWithPosters(canvas, {wall.x0 + 0.2, 2.2, x - 0.1, 2.95}, random);
    PaintCurtain(canvas, {x + 0.1, 0.12, x + 2.1, 2.9}, random);
    CoverWithPosters(canvas, {x + 2.2, 0.5, wall.x1 - 0.1, 2.8}, random);
  } else {
    PaintBricks(canvas, wall, random, 0.25, 0.082, 132.0, 30.0);
    CoverWithPosters(canvas, {2.6, 0.7, 4.8, 2.75}, random);
    CoverWithPosters(canvas, {7.1, 1.2, wall.x1 - 0.2, 2.8}, random);
    CoverWithPosters(canvas, {0.4, 2.3, 2.4, 3.0}, random);
    for (double y : {0.35, 0.45}) PaintSocket(canvas, 2.45, y);
  }
  PaintSkirting(canvas, wall, random, side == Side::kHighY ? 60.0 : 88.0);
  PaintWear(canvas, wall, random, 0.14, 30);
  PaintGrain(canvas, wall, random, 0.05);
}

void PaintBareWall(Canvas& canvas, Random& random, Side side) {
  const Area wall = canvas.area();
  canvas.Fill(wall, 168.0);
  canvas.AddNoise(wall, FractalNoise(random.Next(), 1.9, 4, 0.4), 9.0);
  if (side == Side::kHighX) PaintDoor(canvas, {1.0, 0.0, 2.0, 2.15}, random, 150.0);
  if (side == Side::kLowX) PaintWindow(canvas, {3.1, 1.1, 5.1, 2.5}, random, 2, 1, 215.0, 170.0);
  PaintSocket(canvas, wall.x0 + 2.3, 0.35);
  PaintSocket(canvas, wall.x1 - 1.4, 0.35);
  PaintSkirting(canvas, wall, random, 140.0);
}

void PaintFloor(Canvas& canvas, Random& random) {
  const Area floor = canvas.area();
  PaintPuzzleMats(canvas, floor, random, 0.62);
  PaintRug(canvas, {3.4, 2.5, 6.4, 4.6}, random);
  // Marks of tape where vehicles start and land.
  for (int k = 0; k < 7; ++k) {
    const double x = random.Uniform(1.2, 7.8);
    const double y = random.Uniform(1.2, 6.8);
    const double angle = random.Uniform(0.0, 3.0);
    const double tone = random.Index(2) == 0 ? 225.0 : 28.0;
    canvas.FillTurned(x, y, 0.3, 0.024, angle, tone);
    if (k % 2 == 0) canvas.FillTurned(x, y, 0.024, 0.3, angle, tone);
  }
  PaintPoster(canvas, {1.3, 5.4, 2.2, 6.6}, random, 2);
  PaintPoster(canvas, {7.0, 1.3, 7.9, 2.4}, random, 2);
  PaintWear(canvas, floor, random, 0.2, 120);
  PaintGrain(canvas, floor, random, 0.07);
}

void PaintBareFloor(Canvas& canvas, Random& random) {
  const Area floor = canvas.area();
  canvas.Fill(floor, 118.0);
  canvas.AddNoise(floor, FractalNoise(random.Next(), 1.5, 5, 0.5), 14.0);
  for (double x = floor.x0 + 1.5; x < floor.x1; x += 1.5) {
    canvas.Fill({x, floor.y0, x + 0.004, floor.y1}, 84.0);
  }
  PaintWear(canvas, floor, random, 0.12, 14);
}

void AddFurniture(WorldBuilder& builder, bool bare) {
  Random& random = builder.random();
  const WorldBuilder::Look look{.corner_density = bare ? 0.3 : 0.9};
  const auto box = [&](const Pose& pose, const Vector3d& size, auto paint) {
    builder.AddBox(pose, {-0.5 * size.x(), -0.5 * size.y(), 0.0},
                   {0.5 * size.x(), 0.5 * size.y(), size.z()}, look,
                   [paint](Canvas& c, Random& r, Side side) { paint(c, r, side); });
  };
  const auto crate = [](Canvas& c, Random& r, Side) { PaintCrateSide(c, c.area(), r); };
  const auto carton = [](Canvas& c, Random& r, Side) { PaintCardboard(c, c.area(), r); };
  // Shelves stand with their backs at high y; the front is their low y side.
  const auto shelf = [](Canvas& c, Random& r, Side side) {
    if (side == Side::kLowY) {
      PaintShelf(c, c.area(), r);
    } else {
      PaintBoards(c, c.area(), r, false, 0.2, 150.0, 12.0);
    }
  };
  const auto rack = [](Canvas& c, Random& r, Side) { PaintMachineSide(c, c.area(), r, 105.0); };
  const auto pad = [](Canvas& c, Random& r, Side) { PaintMattress(c, c.area(), r); };
  const auto boards = [](Canvas& c, Random& r, Side side) {
    PaintBoards(c, c.area(), r, side != Side::kLowX && side != Side::kHighX, 0.12, 140.0, 20.0);
    PaintWear(c, c.area(), r, 0.2, 3);
  };

  if (bare) {
    box(Upright(3.9, 3.4, 0.0, 0.1), {0.8, 0.6, 0.7}, carton);
    box(Upright(-4.05, -3.5, 0.0, 0.2), {0.5, 0.5, 0.45}, carton);
    box(Upright(-1.0, 3.75, 0.0, 0.0), {1.6, 0.45, 0.75}, boards);
    return;
  }
  box(Upright(-3.4, 3.78, 0.0, 0.0), {2.0, 0.42, 2.05}, shelf);
  box(Upright(1.35, 3.78, 0.0, 0.0), {1.9, 0.42, 2.3}, shelf);
  box(Upright(-3.9, 3.76, 2.05, 0.08), {0.55, 0.36, 0.36}, carton);
  box(Upright(-3.1, 3.77, 2.05, -0.1), {0.45, 0.34, 0.28}, carton);
  box(Upright(1.0, 3.77, 2.3, 0.05), {0.6, 0.36, 0.32}, carton);
  box(Upright(1.8, 3.77, 2.3, -0.04), {0.5, 0.36, 0.25}, carton);

  box(Upright(3.98, 3.42, 0.0, 0.12), {0.7, 0.7, 0.68}, crate);
  box(Upright(4.0, 3.45, 0.68, -0.2), {0.5, 0.55, 0.48}, crate);
  box(Upright(3.3, 3.6, 0.0, -0.15), {0.55, 0.5, 0.5}, carton);
  box(Upright(-4.05, -3.55, 0.0, 0.1), {0.62, 0.62, 0.6}, crate);
  box(Upright(-4.08, -3.55, 0.6, 0.4), {0.42, 0.4, 0.36}, carton);
  box(Upright(-4.1, -2.75, 0.0, -0.1), {0.5, 0.6, 0.42}, carton);
  box(Upright(4.05, -3.5, 0.0, 0.1), {0.6, 0.7, 0.9}, crate);

  box(Upright(4.15, -1.85, 0.0, 0.0), {0.62, 0.62, 1.95}, rack);
  box(Upright(4.15, -1.15, 0.0, 0.0), {0.62, 0.62, 1.5}, rack);
  box(Upright(4.14, -1.15, 1.5, 0.1), {0.45, 0.4, 0.3}, carton);
  box(Upright(4.2, -2.7, 0.0, 0.0), {0.5, 0.8, 0.75}, boards);

  // A table with two screens and a carton.
  box(Upright(-4.08, 0.3, 0.70, 0.0), {0.76, 2.2, 0.05}, boards);
  for (const double x : {-4.38, -3.78}) {
    for (const double y : {-0.72, 1.32}) box(Upright(x, y, 0.0, 0.0), {0.06, 0.06, 0.70}, boards);
  }
  const auto screen = [](Canvas& c, Random& r, Side side) {
    c.Fill(c.area(), 34.0);
    if (side == Side::kHighX) PaintPoster(c, c.area().Inset(0.03), r, 4 + r.Index(2));
    PaintGrain(c, c.area(), r, 0.2);
  };
  box(Upright(-4.15, -0.2, 0.75, 0.15), {0.06, 0.6, 0.4}, screen);
  box(Upright(-4.15, 0.55, 0.75, -0.1), {0.06, 0.55, 0.36}, screen);
  box(Upright(-4.05, 1.1, 0.75, 0.3), {0.3, 0.35, 0.24}, carton);
  box(Upright(-4.1, 0.6, 0.0, 0.1), {0.4, 0.5, 0.5}, carton);
  box(Upright(-4.3, 2.4, 0.0, 0.0), {0.34, 0.9, 1.1}, boards);
  box(Upright(-4.28, 2.4, 1.1, 0.2), {0.26, 0.4, 0.3}, carton);

  // On the floor below the flights.
  box(Upright(-1.9, -1.9, 0.0, 0.35), {1.2, 0.8, 0.14}, boards);
  box(Upright(-1.9, -1.9, 0.14, 0.5), {0.45, 0.35, 0.14}, carton);
  box(Upright(2.2, 1.7, 0.0, -0.25), {1.9, 0.9, 0.16}, pad);
  box(Upright(2.6, -1.9, 0.0, 0.6), {0.5, 0.4, 0.26}, carton);
  box(Upright(-2.6, 1.9, 0.0, -0.4), {0.6, 0.5, 0.27}, crate);
  box(Upright(0.2, -2.6, 0.0, 0.1), {0.9, 0.3, 0.2}, boards);
  for (int k = 0; k < 5; ++k) {
    box(Upright(random.Uniform(-3.0, 3.0), random.Uniform(2.3, 2.9), 0.0, random.Uniform(0.0, 3.0)),
        {random.Uniform(0.12, 0.25), random.Uniform(0.12, 0.25), random.Uniform(0.08, 0.2)},
        carton);
  }
}

void AddCeilingAndLamps(WorldBuilder& builder, bool bare) {
  const auto beam = [bare](Canvas& c, Random& r, Side) {
    if (bare) {
      c.Fill(c.area(), 150.0);
    } else {
      PaintBoards(c, c.area(), r, c.area().width() > c.area().height(), 0.2, 88.0, 8.0);
    }
  };
  const WorldBuilder::Look look{.corner_density = bare ? 0.03 : 0.06};
  for (const double x : {-2.9, 0.0, 2.9}) {
    builder.AddBox(Upright(x, 0.0, 2.98, 0.0), {-0.09, -4.0, 0.0}, {0.09, 4.0, 0.22}, look, beam);
  }
  const auto lamp = [](Canvas& c, Random& r, Side side) {
    c.Fill(c.area(), side == Side::kLowZ ? 205.0 : 120.0);
    if (side != Side::kLowZ) return;
    const bool along_x = c.area().width() > c.area().height();
    for (const double f : {0.3, 0.7}) {
      c.Fill(along_x ? c.area().Part(0.04, f - 0.1, 0.96, f + 0.1)
                     : c.area().Part(f - 0.1, 0.04, f + 0.1, 0.96),
             250.0);
    }
    c.Frame(c.area(), 0.025, 90.0);
    PaintGrain(c, c.area(), r, 0.02);
  };
  for (const double x : {-1.45, 1.45}) {
    for (const double y : {-1.9, 1.9}) {
      builder.AddBox(Upright(x, y, 3.1, 0.0), {-0.16, -0.65, 0.0}, {0.16, 0.65, 0.06},
                     {.corner_density = 0.3, .light = 1.0}, lamp);
      builder.illumination().AddLamp({x, y, 3.05}, 0.45, 0.8, 2.6);
    }
  }
  if (bare) return;
  // The motion capture's rail around the room, with its cameras.
  const auto rail = [](Canvas& c, Random& r, Side) { PaintBeam(c, c.area(), r, 150.0); };
  const WorldBuilder::Look rail_look{.corner_density = 1.0};
  for (const double s : {-1.0, 1.0}) {
    builder.AddBox(Upright(4.32 * s, 0.0, 2.84, 0.0), {-0.03, -3.9, 0.0}, {0.03, 3.9, 0.06},
                   rail_look, rail);
    builder.AddBox(Upright(0.0, 3.86 * s, 2.84, 0.0), {-4.28, -0.03, 0.0}, {4.28, 0.03, 0.06},
                   rail_look, rail);
  }
  const auto camera = [](Canvas& c, Random& r, Side) {
    c.Fill(c.area(), 30.0);
    const Area a = c.area();
    const double radius = 0.45 * std::min(a.width(), a.height());
    c.FillRing(a.center_x(), a.center_y(), radius, 0.3 * radius, 190.0);
    c.FillDisc(a.center_x(), a.center_y(), 0.3 * radius, 90.0);
    PaintGrain(c, a, r, 0.1);
  };
  for (const double x : {-4.2, -2.0, 2.2, 4.2}) {
    for (const double s : {-1.0, 1.0}) {
      builder.AddBox(Upright(x, 3.8 * s, 2.7, 0.7 * s), {-0.07, -0.07, 0.0}, {0.07, 0.07, 0.14},
                     rail_look, camera);
    }
  }
}

}  // namespace

std::shared_ptr<const World> MakeRoomWorld(const std::string& name, const WorldOptions& options,
                                           bool bare) {
  WorldBuilder builder(name, options, 0.0035, 0.08);
  builder.world().SetBounds(kLow, kHigh);
  builder.illumination().SetInside(kLow, kHigh);
  builder.illumination().SetAmbient(0.58, 0.5);
  builder.illumination().SetOcclusionReach(0.6);
  builder.AddInside(kLow, kHigh, {.corner_density = bare ? 0.02 : 0.75},
                    [bare](Canvas& canvas, Random& random, Side side) {
                      if (side == Side::kLowZ) {
                        bare ? PaintBareFloor(canvas, random) : PaintFloor(canvas, random);
                      } else if (side == Side::kHighZ) {
                        if (bare) {
                          canvas.Fill(canvas.area(), 190.0);
                        } else {
                          PaintCeilingBoards(canvas, canvas.area(), random, 0.6);
                        }
                      } else {
                        bare ? PaintBareWall(canvas, random, side)
                             : PaintWall(canvas, random, side);
                      }
                    });
  AddFurniture(builder, bare);
  AddCeilingAndLamps(builder, bare);
  if (options.moving_bodies) {
    AddWalker(builder, {{-2.9, -3.55}, {2.9, -3.55}, 14.0, 0.1}, 1.76);
  }
  return builder.Build();
}

}  // namespace duet
