#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "experiments/simulation/world/moving_bodies.h"
#include "experiments/simulation/world/object_texture.h"
#include "experiments/simulation/world/procedural_texture.h"
#include "experiments/simulation/world/world_builder.h"
#include "experiments/simulation/world/worlds.h"

namespace duet {
namespace {

using Eigen::Vector3d;
using Side = WorldBuilder::Side;

const Vector3d kLow(-13.0, -8.0, 0.0);
const Vector3d kHigh(13.0, 8.0, 8.0);

void PaintGate(Canvas& canvas, const Area& area, Random& random) {
  canvas.Fill(area.Inset(-0.2), 90.0);
  PaintHazardStripes(canvas, {area.x0 - 0.2, area.y0, area.x0, area.y1}, 0.4, 26.0, 210.0);
  PaintHazardStripes(canvas, {area.x1, area.y0, area.x1 + 0.2, area.y1}, 0.4, 26.0, 210.0);
  for (double y = area.y0; y < area.y1; y += 0.11) {
    const double tone = NearGrey(random, 142.0, 8.0);
    const double top = std::min(area.y1, y + 0.11);
    canvas.Fill({area.x0, y, area.x1, top}, tone);
    canvas.Fill({area.x0, y, area.x1, y + 0.02}, 0.45 * tone);
    canvas.Fill({area.x0, y + 0.06, area.x1, y + 0.085}, 1.3 * tone);
  }
  canvas.Text(area.x0 + 0.35 * area.width(), area.y0 + 0.6 * area.height(), 0.9,
              "G" + std::to_string(1 + random.Index(9)), 235.0, 0.16);
  PaintLabel(canvas, area.Part(0.1, 0.35, 0.3, 0.45), random);
  PaintLabel(canvas, area.Part(0.65, 0.3, 0.92, 0.42), random);
  PaintWear(canvas, area, random, 0.3, 60);
}

// Cable trays, pipes and boxes that run along a wall.
void PaintInstallations(Canvas& canvas, const Area& area, Random& random) {
  for (double y = area.y0; y < area.y1 - 0.1;) {
    const double size = random.Uniform(0.05, 0.16);
    PaintPipe(canvas, {area.x0, y, area.x1, y + size}, random, random.Uniform(60.0, 210.0));
    y += size + random.Uniform(0.06, 0.3);
  }
  const int boxes = static_cast<int>(area.width() / 2.2);
  for (int k = 0; k < boxes; ++k) {
    const double x = area.x0 + (k + random.Uniform(0.1, 0.7)) * area.width() / boxes;
    const double width = random.Uniform(0.35, 0.8);
    const double y = area.y0 + random.Uniform(-0.3, 0.2) * area.height();
    const Area cabinet{x, y, x + width, y + random.Uniform(0.5, 1.1)};
    canvas.Shadow(cabinet.center_x() + 0.05, cabinet.center_y() - 0.06, 0.5 * width,
                  0.5 * cabinet.height(), 0.0, 0.06, 0.5);
    PaintMachineSide(canvas, cabinet, random, random.Uniform(90.0, 190.0));
  }
}

void PaintSigns(Canvas& canvas, const Area& area, Random& random, double pitch) {
  for (double x = area.x0 + random.Uniform(0.0, 1.0); x < area.x1 - 1.5;
       x += pitch * random.Uniform(0.7, 1.4)) {
    const double width = random.Uniform(0.6, 1.4);
    const double y = area.y0 + random.Uniform(0.0, 0.4) * area.height();
    const Area sign{x, y, x + width, y + width * random.Uniform(0.45, 1.2)};
    if (random.Index(2) == 0) {
      PaintLabel(canvas, sign, random);
    } else {
      PaintPoster(canvas, sign, random);
    }
  }
}

void PaintWall(Canvas& canvas, Random& random, Side side) {
  const Area wall = canvas.area();
  const bool gable = side == Side::kLowX || side == Side::kHighX;
  const Area base{wall.x0, 0.0, wall.x1, 2.4};
  const Area metal{wall.x0, 2.4, wall.x1, wall.y1};
  PaintSheetMetal(canvas, metal, random, 0.32, side == Side::kHighY ? 128.0 : 148.0);
  if (gable) {
    PaintConcrete(canvas, base, random, 125.0, 1.2);
  } else {
    PaintBricks(canvas, base, random, 0.25, 0.082, side == Side::kLowY ? 104.0 : 140.0, 26.0);
  }
  canvas.Fill({wall.x0, 2.36, wall.x1, 2.46}, 66.0);
  PaintWornFill(canvas, {wall.x0, 1.05, wall.x1, 1.3}, random, 215.0, 0.45);
  PaintWornFill(canvas, {wall.x0, 0.0, wall.x1, 1.05}, random, 78.0, 0.5);
  // A band of windows.
  const double window = gable ? 2.4 : 2.9;
  for (double x = wall.x0 + 0.5; x + window < wall.x1; x += window + random.Uniform(0.35, 0.8)) {
    const Area place{x, 4.55, x + window, 6.5};
    canvas.Shadow(place.center_x(), place.center_y() - 0.03, 0.5 * window, 0.98, 0.0, 0.08, 0.5);
    PaintWindow(canvas, place, random, 4, 3, 96.0, 185.0);
  }
  PaintInstallations(canvas, {wall.x0, 2.55, wall.x1, 3.35}, random);
  PaintSigns(canvas, {wall.x0 + 0.4, 3.4, wall.x1 - 0.4, 3.9}, random, 2.6);
  PaintSigns(canvas, {wall.x0 + 0.4, 1.2, wall.x1 - 0.4, 1.7}, random, 2.2);
  PaintSigns(canvas, {wall.x0 + 0.4, 6.65, wall.x1 - 0.4, 6.9}, random, 4.0);
  if (side == Side::kHighX) PaintGate(canvas, {5.6, 0.0, 10.4, 4.4}, random);
  if (side == Side::kLowX) {
    PaintGate(canvas, {1.2, 0.0, 4.2, 3.6}, random);
    PaintDoor(canvas, {5.2, 0.0, 6.3, 2.2}, random, 74.0);
    canvas.Text(8.0, 6.7, 0.8, "HALL 4", 30.0, 0.16);
  }
  PaintWear(canvas, wall, random, 0.22, 160);
  PaintGrain(canvas, wall, random, 0.07);
}

void PaintFloor(Canvas& canvas, Random& random) {
  const Area floor = canvas.area();
  PaintConcrete(canvas, floor, random, 122.0, 3.1);
  PaintCracks(canvas, floor, random, 60, 48.0);
  for (int k = 0; k < 26; ++k) {  // repairs
    canvas.FillTurned(random.Uniform(1.0, 25.0), random.Uniform(1.0, 15.0),
                      random.Uniform(0.15, 0.7), random.Uniform(0.1, 0.4),
                      random.Index(2) * 0.5 * std::numbers::pi + random.Uniform(-0.05, 0.05),
                      random.Uniform(70.0, 175.0), 0.55, 0.03);
  }
  for (int k = 0; k < 16; ++k) {  // tyres
    const double x = random.Uniform(0.0, 22.0);
    const double y = random.Uniform(3.5, 12.5);
    const double bend = random.Uniform(-0.12, 0.12);
    double angle = random.Uniform(-0.5, 0.5);
    double px = x;
    double py = y;
    for (int s = 0; s < 12; ++s) {
      const double nx = px + 0.4 * std::cos(angle);
      const double ny = py + 0.4 * std::sin(angle);
      canvas.Line(px, py, nx, ny, 0.13, 40.0, 0.22);
      px = nx;
      py = ny;
      angle += bend;
    }
  }
  // Aisles and places, in paint that has seen traffic.
  const auto line = [&](const Area& area) { PaintWornFill(canvas, area, random, 212.0, 0.42); };
  for (const double y : {3.1, 12.8}) line({0.0, y, 26.0, y + 0.12});
  for (const double x : {4.2, 21.8}) line({x, 3.2, x + 0.12, 12.8});
  for (double x = 5.0; x < 21.0; x += 1.2) line({x, 7.95, x + 0.6, 8.07});
  for (int k = 0; k < 7; ++k) {
    const double x = 5.0 + 2.3 * k + random.Uniform(0.0, 0.6);
    const double y = k % 2 == 0 ? 4.0 : 10.6;
    const Area place{x, y, x + random.Uniform(1.2, 1.7), y + random.Uniform(1.0, 1.6)};
    line({place.x0, place.y0, place.x1, place.y0 + 0.09});
    line({place.x0, place.y1 - 0.09, place.x1, place.y1});
    line({place.x0, place.y0, place.x0 + 0.09, place.y1});
    line({place.x1 - 0.09, place.y0, place.x1, place.y1});
    canvas.Text(place.x0 + 0.25, place.center_y() - 0.2, 0.42, RandomCode(random).substr(0, 4),
                205.0, 0.15);
  }
  PaintHazardStripes(canvas, {9.6, 9.0, 12.6, 9.25}, 0.36, 30.0, 205.0);
  PaintHazardStripes(canvas, {14.8, 5.6, 18.3, 5.85}, 0.36, 30.0, 205.0);
  PaintGrating(canvas, {7.4, 5.2, 8.6, 7.2}, random, 0.09);
  PaintGrating(canvas, {17.5, 9.4, 20.5, 10.2}, random, 0.09);
  PaintGrating(canvas, {1.0, 7.0, 2.2, 10.0}, random, 0.1);
  for (const double x : {11.3, 15.7}) {  // manholes
    canvas.FillDisc(x, 7.0, 0.42, 60.0);
    canvas.FillRing(x, 7.0, 0.38, 0.03, 150.0);
    for (int k = -3; k <= 3; ++k) {
      for (int m = -3; m <= 3; ++m) {
        if (k * k + m * m < 11)
          canvas.FillTurned(x + 0.09 * k, 7.0 + 0.09 * m, 0.03, 0.012,
                            0.78 * ((k + m) % 2 == 0 ? 1 : -1), 145.0);
      }
    }
  }
  PaintWear(canvas, floor, random, 0.28, 700);
  canvas.MapNoise(floor, FractalNoise(random.Next(), 1.1, 5, 0.6), [](float g, float n) {
    const float oil = std::clamp((n - 0.36f) * 7.0f, 0.0f, 1.0f);  // dried puddles
    return g * (1.0f - 0.5f * oil);
  });
  PaintGrain(canvas, floor, random, 0.12);
}

void PaintRoof(Canvas& canvas, Random& random) {
  const Area roof = canvas.area();
  PaintSheetMetal(canvas, roof, random, 0.4, 112.0);
  for (double x = 2.0; x < 24.0; x += 6.0) {  // rooflights
    for (const double y : {3.0, 10.5})
      PaintWindow(canvas, {x, y, x + 2.6, y + 2.4}, random, 4, 2, 80.0, 205.0);
  }
  PaintGrain(canvas, roof, random, 0.1);
}

class Furnisher {
 public:
  explicit Furnisher(WorldBuilder& builder) : builder_(builder), random_(builder.random()) {}

  template <typename P>
  void Box(const Pose& pose, const Vector3d& size, P paint, double density = 0.9) {
    builder_.AddBox(pose, {-0.5 * size.x(), -0.5 * size.y(), 0.0},
                    {0.5 * size.x(), 0.5 * size.y(), size.z()}, {.corner_density = density}, paint);
  }

  void Machine(const Pose& pose, const Vector3d& size) {
    const double grey = random_.Uniform(75.0, 185.0);
    Box(pose, size, [grey](Canvas& c, Random& r, Side) { PaintMachineSide(c, c.area(), r, grey); });
  }
  void Crate(const Pose& pose, const Vector3d& size) {
    Box(pose, size, [](Canvas& c, Random& r, Side) { PaintCrateSide(c, c.area(), r); });
  }
  void Carton(const Pose& pose, const Vector3d& size) {
    Box(pose, size, [](Canvas& c, Random& r, Side) { PaintCardboard(c, c.area(), r); });
  }
  void Pipe(const Pose& pose, const Vector3d& size) {
    const double grey = random_.Uniform(70.0, 200.0);
    Box(
        pose, size, [grey](Canvas& c, Random& r, Side) { PaintPipe(c, c.area(), r, grey); }, 0.7);
  }
  void Beam(const Pose& pose, const Vector3d& size, double grey) {
    Box(
        pose, size, [grey](Canvas& c, Random& r, Side) { PaintBeam(c, c.area(), r, grey); }, 0.7);
  }
  // Boards on blocks; the gaps between them are dark.
  void Pallet(const Pose& pose) {
    Box(pose, {1.2, 0.8, 0.15}, [](Canvas& c, Random& r, Side side) {
      PaintBoards(c, c.area(), r, side != Side::kHighZ, side == Side::kHighZ ? 0.13 : 0.05, 150.0,
                  24.0);
      if (side == Side::kHighZ) return;
      for (const double f : {0.1, 0.58}) c.Fill(c.area().Part(f, 0.16, f + 0.32, 0.78), 24.0);
    });
  }
  // A pallet rack along x, the first post at (x, y).
  void Rack(double x, double y, int bays) {
    const double bay = 1.9;
    for (int k = 0; k <= bays; ++k) {
      for (const double d : {-0.5, 0.5}) {
        Beam(Upright(x + k * bay, y + d, 0.0, 0.0), {0.1, 0.1, 4.3}, 105.0);
      }
    }
    for (int level = 0; level < 3; ++level) {
      const double z = 0.25 + 1.35 * level;
      for (const double d : {-0.5, 0.5}) {
        Beam(Upright(x + 0.5 * bays * bay, y + d, z, 0.0), {bays * bay - 0.1, 0.06, 0.12}, 170.0);
      }
      for (int k = 0; k < bays; ++k) {
        const double middle = x + (k + 0.5) * bay;
        Pallet(Upright(middle, y, z + 0.12, 0.0));
        if (random_.Index(6) == 0) continue;
        const double turn = random_.Uniform(-0.06, 0.06);
        const double height = random_.Uniform(0.5, 0.9);
        if (random_.Index(2) == 0) {
          Crate(Upright(middle, y, z + 0.27, turn), {random_.Uniform(0.8, 1.1), 0.7, height});
        } else {
          Carton(Upright(middle - 0.3, y, z + 0.27, turn), {0.52, 0.62, height});
          Carton(Upright(middle + 0.3, y, z + 0.27, -turn), {0.5, 0.6, random_.Uniform(0.3, 0.9)});
        }
      }
    }
  }
  // A machine with plinth, body, head, cabinet and pipes up to the roof, about 4 m wide along x of
  // `place` and 1.9 m deep, its front at high y.
  void MachineGroup(const Pose& place) {
    const double width = random_.Uniform(2.4, 3.0);
    const double height = random_.Uniform(1.7, 2.6);
    const auto at = [&place](double x, double y, double z, double yaw) {
      return place * Upright(x, y, z, yaw);
    };
    Beam(place, {width + 0.3, 1.9, 0.18}, 92.0);
    Machine(at(0.0, 0.0, 0.18, 0.0), {width, 1.6, height});
    Machine(at(random_.Uniform(-0.2, 0.3) * width, 0.1, 0.18 + height, 0.0),
            {random_.Uniform(0.9, 1.6), 1.1, random_.Uniform(0.6, 1.3)});
    Pipe(at(-0.42 * width, -0.5, 0.18 + height, 0.0), {0.22, 0.22, 7.8 - height});
    if (random_.Index(2) == 0) {
      Pipe(at(-0.42 * width + 0.32, -0.5, 0.18 + height, 0.0), {0.16, 0.16, 7.8 - height});
    }
    Machine(at(0.5 * width + 0.55, 0.4, 0.0, random_.Uniform(-0.1, 0.1)),
            {0.62, 0.55, random_.Uniform(1.3, 1.9)});
  }

 private:
  WorldBuilder& builder_;
  Random& random_;
};

void AddMachinery(WorldBuilder& builder) {
  Furnisher put(builder);
  for (const double x : {-10.6, -6.4, -2.0}) put.MachineGroup(Upright(x, -6.8, 0.0, 0.0));
  for (const double x : {4.6, 8.8}) put.MachineGroup(Upright(x, 6.8, 0.0, std::numbers::pi));
  put.Rack(1.4, -6.9, 4);
  put.Rack(-8.6, 6.95, 5);
  put.MachineGroup(Upright(-11.6, 3.4, 0.0, -0.5 * std::numbers::pi));
  put.MachineGroup(Upright(-11.6, -2.2, 0.0, -0.5 * std::numbers::pi));
  put.Machine(Upright(11.2, -3.6, 0.0, 0.0), {1.6, 2.4, 2.8});
  put.Machine(Upright(11.4, -3.6, 2.8, 0.0), {0.9, 1.4, 1.1});
  put.Pipe(Upright(11.4, -3.6, 3.9, 0.0), {0.4, 0.4, 4.1});
  put.Machine(Upright(10.6, 4.2, 0.0, 0.3), {1.3, 0.9, 1.6});
  put.Crate(Upright(10.5, -7.1, 0.0, 0.08), {0.9, 0.8, 0.8});
  put.Crate(Upright(11.6, -7.1, 0.0, -0.05), {1.0, 0.8, 0.8});
  put.Crate(Upright(11.1, -7.1, 0.8, 0.03), {1.1, 0.7, 0.7});
  put.Crate(Upright(11.9, 1.0, 0.0, 0.2), {1.1, 0.9, 0.9});
  put.Crate(Upright(11.8, 1.0, 0.9, -0.1), {0.8, 0.7, 0.6});
  put.Crate(Upright(12.1, 2.3, 0.0, -0.2), {0.9, 0.9, 1.0});
  for (int k = 0; k < 5; ++k) put.Pallet(Upright(11.5, -1.0 + 0.02 * k, 0.15 * k, 0.05 * (k % 3)));
  // Low things under the flights.
  const std::array<std::array<double, 3>, 9> places = {{{-7.0, -3.6, 0.3},
                                                        {-4.6, 3.4, -0.4},
                                                        {-1.2, -1.6, 0.9},
                                                        {1.2, 3.0, 0.1},
                                                        {3.4, -3.2, -0.7},
                                                        {5.9, 1.0, 0.4},
                                                        {7.9, -3.9, 1.2},
                                                        {-8.2, 1.0, 0.0},
                                                        {7.6, 3.9, 0.6}}};
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& [x, y, yaw] = places[k];
    put.Pallet(Upright(x, y, 0.0, yaw));
    if (k % 3 == 0) put.Carton(Upright(x + 0.2, y, 0.15, yaw + 0.2), {0.5, 0.4, 0.28});
    if (k % 3 == 1) put.Crate(Upright(x - 0.1, y, 0.15, yaw - 0.1), {0.8, 0.6, 0.3});
  }
  put.Pipe(Upright(-2.5, 4.6, 0.0, 0.0), {4.2, 0.2, 0.2});
  put.Pipe(Upright(4.0, -4.8, 0.0, 0.02), {3.6, 0.16, 0.16});
  put.Beam(Upright(-5.0, -4.9, 0.0, 0.0), {3.0, 0.24, 0.24}, 120.0);
  put.Beam(Upright(-4.7, -4.55, 0.0, 0.08), {3.2, 0.24, 0.24}, 140.0);
}

void AddStructure(WorldBuilder& builder) {
  Furnisher put(builder);
  for (const double x : {-12.4, -7.8, -4.0, 0.4, 6.7, 12.4}) {
    for (const double s : {-1.0, 1.0}) {
      put.Beam(Upright(x, 5.55 * s, 0.0, 0.0), {0.34, 0.34, 8.0}, 118.0);
    }
  }
  // Trusses: chords and the lattice between them.
  for (const double x : {-10.0, -5.0, 0.0, 5.0, 10.0}) {
    put.Beam(Upright(x, 0.0, 5.95, 0.5 * std::numbers::pi), {16.0, 0.18, 0.18}, 98.0);
    put.Beam(Upright(x, 0.0, 7.7, 0.5 * std::numbers::pi), {16.0, 0.16, 0.16}, 98.0);
    for (int k = 0; k < 8; ++k) {
      const double y = -7.0 + 2.0 * k;
      const double slope = (k % 2 == 0 ? 1.0 : -1.0) * std::atan2(1.57, 2.0);
      const Pose pose{
          Eigen::Quaterniond(Eigen::AngleAxisd(slope, Vector3d::UnitX()) *
                             Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ())),
          Vector3d(x + (k % 2 == 0 ? 0.012 : -0.012), y, 6.91)};  // they lie side by side
      builder.AddBox(pose, {-1.25, -0.05, -0.05}, {1.25, 0.05, 0.05}, {.corner_density = 0.6},
                     [](Canvas& c, Random& r, Side) { PaintBeam(c, c.area(), r, 110.0); });
    }
  }
  // The crane: rails on the pillars, a bridge, a trolley with its hook.
  for (const double s : {-1.0, 1.0}) {
    put.Beam(Upright(0.0, 5.55 * s, 5.3, 0.0), {26.0, 0.3, 0.3}, 88.0);
  }
  put.Box(Upright(3.0, 0.0, 5.2, 0.5 * std::numbers::pi), {10.6, 0.5, 0.6},
          [](Canvas& c, Random& r, Side) {
            c.Fill(c.area(), 176.0);
            if (c.area().width() > 3.0) {
              PaintHazardStripes(c, c.area().Part(0.0, 0.0, 1.0, 0.3), 0.5, 28.0, 205.0);
              c.Text(c.area().x0 + 4.0, c.area().y0 + 0.26, 0.28, "MAX 5000 KG", 30.0, 0.16);
              PaintLabel(c, c.area().Part(0.7, 0.4, 0.76, 0.9), r);
            }
            PaintWear(c, c.area(), r, 0.25, 20);
          });
  put.Machine(Upright(3.0, 1.6, 4.84, 0.0), {0.9, 0.8, 0.36});
  // Ducts along the hall.
  const auto duct = [](Canvas& c, Random& r, Side) {
    PaintWallPanels(c, c.area(), r, 1.3, 2.0, 165.0, 20.0);
    PaintWear(c, c.area(), r, 0.2, 10);
  };
  put.Box(Upright(0.0, -3.6, 6.25, 0.0), {24.0, 0.7, 0.6}, duct, 0.6);
  put.Box(Upright(-1.0, 4.0, 6.3, 0.0), {23.0, 0.5, 0.5}, duct, 0.6);
  // Lamps below the trusses.
  for (const double x : {-9.4, -3.2, 2.2, 8.6}) {
    for (const double y : {-2.4, 2.6}) {
      builder.AddBox(Upright(x, y, 5.6, 0.0), {-0.5, -0.2, 0.0}, {0.5, 0.2, 0.14},
                     {.corner_density = 0.3, .light = 1.0}, [](Canvas& c, Random& r, Side side) {
                       c.Fill(c.area(), side == Side::kLowZ ? 250.0 : 90.0);
                       c.Frame(c.area(), 0.03, 70.0);
                       PaintGrain(c, c.area(), r, 0.03);
                     });
      builder.illumination().AddLamp({x, y, 5.5}, 0.5, 0.55, 5.5);
    }
  }
}

}  // namespace

std::shared_ptr<const World> MakeHallWorld(const std::string& name, const WorldOptions& options) {
  WorldBuilder builder(name, options, 0.0055, 0.16);
  builder.world().SetBounds(kLow, kHigh);
  builder.illumination().SetInside(kLow, kHigh);
  builder.illumination().SetAmbient(0.5, 0.45);
  builder.illumination().SetOcclusionReach(1.1);
  builder.AddInside(kLow, kHigh, {.corner_density = 0.8},
                    [](Canvas& canvas, Random& random, Side side) {
                      if (side == Side::kLowZ) {
                        PaintFloor(canvas, random);
                      } else if (side == Side::kHighZ) {
                        PaintRoof(canvas, random);
                      } else {
                        PaintWall(canvas, random, side);
                      }
                    });
  AddStructure(builder);
  AddMachinery(builder);
  if (options.moving_bodies) {
    AddWalker(builder, {{9.9, -1.9}, {9.9, 2.6}, 9.0, 0.2}, 1.8);
    AddWalker(builder, {{-9.75, 2.0}, {-9.75, -1.6}, 8.0, 0.6}, 1.72);
  }
  return builder.Build();
}

}  // namespace duet
