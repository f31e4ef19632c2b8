#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "experiments/simulation/world/facade_texture.h"
#include "experiments/simulation/world/moving_bodies.h"
#include "experiments/simulation/world/object_texture.h"
#include "experiments/simulation/world/procedural_texture.h"
#include "experiments/simulation/world/world_builder.h"
#include "experiments/simulation/world/worlds.h"

namespace duet {
namespace {

using Eigen::Vector3d;
using Side = WorldBuilder::Side;

constexpr double kEnd_m = 92.0;     // of the street, where the gates are
constexpr double kKerb_m = 7.2;     // from the middle
constexpr double kFront_m = 9.9;    // of the houses, some stand a little farther back
constexpr double kBack_m = 24.0;    // of the houses
constexpr double kGate_m = 6.8;     // half the width of the gates at both ends
constexpr double kTunnel_m = 14.0;  // behind the gates, where cars turn
constexpr double kPavement_m = 0.12;
const Vector3d kSkyLow(-190.0, -130.0, -0.03);
const Vector3d kSkyHigh(190.0, 130.0, 75.0);

double SmoothStep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// Grey of the sky in a direction: brighter at the horizon, soft clouds, and a far line of hills and
// trees.
double SkyGrey(const Vector3d& direction, std::uint64_t seed) {
  const double up = std::max(0.0, direction.z());
  const Vector3d p = 2.4 * direction / (0.35 + up);
  const double cloud = SmoothStep(-0.1, 0.4, FractalNoise3(seed, p.x(), p.y(), 0.5 * p.z(), 5));
  const double grey = 196.0 - 62.0 * std::sqrt(up) + 52.0 * cloud * SmoothStep(0.0, 0.25, up);
  const Vector3d around = Vector3d(direction.x(), direction.y(), 0.0).normalized();
  if (up > 0.25) return grey;  // above all land
  const double ridge =
      0.07 + 0.06 * FractalNoise3(seed + 1, 5.0 * around.x(), 5.0 * around.y(), 0.0, 5);
  const double tree =
      FractalNoise3(seed + 2, 70.0 * around.x(), 70.0 * around.y(), 70.0 * direction.z(), 3);
  const double land = SmoothStep(0.004, -0.004, direction.z() - ridge - 0.012 * tree);
  return grey + land * (104.0 + 40.0 * tree - grey);
}

void AddSky(WorldBuilder& builder, std::uint64_t seed) {
  const Vector3d eye(0.0, 0.0, 1.5);
  const Vector3d size = kSkyHigh - kSkyLow;
  const auto wall = [&](const Vector3d& corner, const Vector3d& u, const Vector3d& v) {
    builder.AddRectangle(corner, u, v, size.dot(u.cwiseAbs()), size.dot(v.cwiseAbs()),
                         {.texel_m = 0.4, .corner_density = 0.02, .light = 1.0},
                         [=](Canvas& c, Random&) {
                           c.Map(c.area(), [&](float, float x, float y) {
                             const Vector3d p = corner + x * u + y * v;
                             return static_cast<float>(SkyGrey((p - eye).normalized(), seed));
                           });
                         });
  };
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d z = Vector3d::UnitZ();
  wall({kSkyLow.x(), kSkyLow.y(), kSkyLow.z()}, y, z);
  wall({kSkyHigh.x(), kSkyHigh.y(), kSkyLow.z()}, -y, z);
  wall({kSkyHigh.x(), kSkyLow.y(), kSkyLow.z()}, -x, z);
  wall({kSkyLow.x(), kSkyHigh.y(), kSkyLow.z()}, x, z);
  wall({kSkyHigh.x(), kSkyLow.y(), kSkyHigh.z()}, -x, y);
  builder.AddRectangle(kSkyLow, x, y, size.x(), size.y(), {.texel_m = 0.12, .corner_density = 0.9},
                       [](Canvas& c, Random& r) { PaintGrass(c, c.area(), r); });
}

class Builder {
 public:
  explicit Builder(WorldBuilder& builder) : builder_(builder), random_(builder.random()) {}

  template <typename P>
  void Box(const Pose& pose, const Vector3d& size, const WorldBuilder::Look& look, P paint) {
    builder_.AddBox(pose, {-0.5 * size.x(), -0.5 * size.y(), 0.0},
                    {0.5 * size.x(), 0.5 * size.y(), size.z()}, look, paint);
  }

  // A house of which one sees the front (towards the street at y = 0), the flanks and a little of
  // the roof.
  void House(double x0, double x1, double front, double back, double height, double sign) {
    const double y0 = std::min(sign * front, sign * back);
    const double y1 = std::max(sign * front, sign * back);
    const Side street = sign > 0.0 ? Side::kLowY : Side::kHighY;
    AddBlock({x0, y0, 0.0}, {x1, y1, height}, street);
    // A cornice stands out; some have a bay, an awning or a sign.
    Box(Upright(0.5 * (x0 + x1), sign * (front - 0.18), height - 0.55, 0.0), {x1 - x0, 0.36, 0.28},
        {.texel_m = 0.016, .corner_density = 0.7}, [](Canvas& c, Random& r, Side) {
          c.Fill(c.area(), NearGrey(r, 170.0, 30.0));
          for (double x = c.area().x0; x < c.area().x1; x += 0.4) {
            c.Fill({x, c.area().y0, x + 0.18, c.area().y1}, 95.0);
          }
          PaintGrain(c, c.area(), r, 0.15);
        });
    const int extra = random_.Index(4);
    const double middle = x0 + random_.Uniform(0.35, 0.65) * (x1 - x0);
    if (extra == 0 && height > 9.0) {
      const double tone = random_.Uniform(110.0, 190.0);
      Box(Upright(middle, sign * (front - 0.4), 4.3, 0.0), {2.4, 0.8, height - 6.0},
          {.texel_m = 0.012, .corner_density = 0.9}, [tone](Canvas& c, Random& r, Side side) {
            PaintBricks(c, c.area(), r, 0.3, 0.12, tone, 20.0);
            if (side == Side::kLowZ || side == Side::kHighZ) return;
            const double margin = std::min(0.3, 0.15 * c.area().width());
            for (double y = 0.5; y + 1.7 < c.area().height(); y += 2.6) {
              PaintWindow(c, {margin, y, c.area().width() - margin, y + 1.7}, r,
                          c.area().width() > 1.0 ? 3 : 1, 2, 215.0, 55.0);
            }
          });
    } else if (extra == 1) {
      const double width = random_.Uniform(2.5, 0.8 * (x1 - x0));
      const double pitch = random_.Uniform(0.25, 0.4);
      Box(Upright(middle, sign * (front - 0.6), 2.85, 0.0), {width, 1.2, 0.3},
          {.texel_m = 0.012, .corner_density = 0.8}, [pitch](Canvas& c, Random& r, Side) {
            c.Fill(c.area(), 60.0);
            for (double x = 0.0; x < c.area().width(); x += pitch) {
              c.Fill({x, c.area().y0, x + 0.5 * pitch, c.area().y1}, 222.0);
            }
            PaintGrain(c, c.area(), r, 0.15);
          });
    }
    for (int k = 0; k < 2; ++k) {  // signs that hang out
      Box(Upright(x0 + random_.Uniform(0.15, 0.85) * (x1 - x0), sign * (front - 0.45),
                  random_.Uniform(3.0, 3.6), 0.0),
          {0.1, 0.9, random_.Uniform(0.5, 1.1)}, {.texel_m = 0.008, .corner_density = 1.0},
          [](Canvas& c, Random& r, Side) {
            if (c.area().width() > 0.3) {
              PaintLabel(c, c.area(), r);
            } else {
              c.Fill(c.area(), 40.0);
            }
          });
    }
  }

  // A house's body. Only the street side is rich; the roof and what is behind are coarse.
  void AddBlock(const Vector3d& low, const Vector3d& high, Side front) {
    const auto face = [&](Side side, const Vector3d& corner, const Vector3d& u, const Vector3d& v,
                          double width, double height) {
      const bool rich = side == front;
      const bool flank = side != front && side != Side::kHighZ;
      builder_.AddRectangle(corner, u, v, width, height,
                            {.texel_m = rich    ? 0.012
                                        : flank ? 0.025
                                                : 0.08,
                             .corner_density = rich ? 0.85 : 0.8},
                            [rich, flank, ground = low.z() == 0.0](Canvas& c, Random& r) {
                              if (rich) {
                                PaintFacade(c, c.area(), r, ground);
                              } else if (flank) {
                                PaintPartyWall(c, c.area(), r);
                              } else {
                                PaintRoofTiles(c, c.area(), r);
                              }
                            });
    };
    const Vector3d x = Vector3d::UnitX();
    const Vector3d y = Vector3d::UnitY();
    const Vector3d z = Vector3d::UnitZ();
    const Vector3d size = high - low;
    face(Side::kLowX, {low.x(), high.y(), low.z()}, -y, z, size.y(), size.z());
    face(Side::kHighX, {high.x(), low.y(), low.z()}, y, z, size.y(), size.z());
    face(Side::kLowY, low, x, z, size.x(), size.z());
    face(Side::kHighY, {high.x(), high.y(), low.z()}, -x, z, size.x(), size.z());
    face(Side::kHighZ, {low.x(), low.y(), high.z()}, x, y, size.x(), size.y());
    if (low.z() > 0.0) face(Side::kLowZ, {high.x(), low.y(), low.z()}, -x, y, size.x(), size.y());
    builder_.world().AddSolid(0, {}, low, high);
    builder_.illumination().AddBlocker({}, low, high);
  }

  void Tree(double x, double y) {
    const WorldBuilder::Look bark{.texel_m = 0.01, .corner_density = 0.8};
    const WorldBuilder::Look leaves{.texel_m = 0.02, .corner_density = 1.0};
    const double trunk = random_.Uniform(2.9, 3.4);
    const double grey = random_.Uniform(105.0, 145.0);
    const double thick = random_.Uniform(0.24, 0.34);
    Box(Upright(x, y, kPavement_m, random_.Uniform(0.0, 1.5)), {thick, thick, trunk}, bark,
        [](Canvas& c, Random& r, Side) { PaintBark(c, c.area(), r); });
    for (int k = 0; k < 9; ++k) {  // a crown of twigs that lie about a ball
      const double half = random_.Uniform(0.38, 0.62);
      const double angle = 2.4 * k + random_.Uniform(0.0, 0.6);
      const double up = -0.75 + 0.2 * k;
      const double out = 1.05 * std::sqrt(std::max(0.0, 1.0 - 0.8 * up * up));
      const Pose pose{
          Eigen::Quaterniond(random_.Uniform(0.4, 1.0), random_.Uniform(-0.6, 0.6),
                             random_.Uniform(-0.6, 0.6), random_.Uniform(-0.8, 0.8))
              .normalized(),
          Vector3d(x + out * std::cos(angle), y + out * std::sin(angle), trunk + 1.25 + 1.15 * up)};
      builder_.AddBox(pose, Vector3d::Constant(-half), Vector3d::Constant(half), leaves,
                      [grey](Canvas& c, Random& r, Side) { PaintFoliage(c, c.area(), r, grey); });
    }
  }

  void Lamp(double x, double sign) {
    const WorldBuilder::Look look{.texel_m = 0.01, .corner_density = 0.5};
    const auto metal = [](Canvas& c, Random& r, Side) { PaintPipe(c, c.area(), r, 92.0); };
    Box(Upright(x, sign * 7.55, kPavement_m, 0.0), {0.3, 0.3, 0.7}, look,
        [](Canvas& c, Random& r, Side) { PaintMachineSide(c, c.area(), r, 90.0); });
    Box(Upright(x, sign * 7.55, kPavement_m + 0.7, 0.0), {0.13, 0.13, 5.9}, look, metal);
    Box(Upright(x, sign * 6.9, 6.6, 0.0), {0.09, 1.5, 0.09}, look, metal);
    Box(Upright(x, sign * 6.1, 6.5, 0.0), {0.3, 0.7, 0.14}, look,
        [](Canvas& c, Random& r, Side side) {
          c.Fill(c.area(), side == Side::kLowZ ? 235.0 : 80.0);
          PaintGrain(c, c.area(), r, 0.1);
        });
  }

  void Sign(double x, double sign) {
    const WorldBuilder::Look look{.texel_m = 0.008, .corner_density = 0.9};
    Box(Upright(x, sign * 7.5, kPavement_m, 0.0), {0.07, 0.07, 2.4}, look,
        [](Canvas& c, Random& r, Side) { PaintPipe(c, c.area(), r, 150.0); });
    const int kind = random_.Index(3);
    Box(Upright(x, sign * 7.5, kPavement_m + 2.4, random_.Uniform(-0.2, 0.2)), {0.04, 0.62, 0.62},
        look, [kind](Canvas& c, Random& r, Side side) {
          const Area a = c.area();
          c.Fill(a, 150.0);
          if (side != Side::kLowX && side != Side::kHighX) return;
          c.Fill(a.Inset(0.015), kind == 0 ? 40.0 : 226.0);
          c.FillRing(a.center_x(), a.center_y(), 0.28, 0.07, kind == 0 ? 226.0 : 50.0);
          if (kind == 1)
            c.Text(a.x0 + 0.16, a.y0 + 0.22, 0.2, std::to_string(3 + r.Index(3)) + "0", 25.0, 0.2);
          if (kind == 2) c.FillTurned(a.center_x(), a.center_y(), 0.25, 0.035, 0.78, 50.0);
        });
  }

  // Bins, benches, pillars with posters, planters, cabinets, bollards.
  void Furniture(double x, double sign) {
    const WorldBuilder::Look look{.texel_m = 0.008, .corner_density = 0.9};
    const double y = sign * 8.0;
    switch (random_.Index(5)) {
      case 0:
        Box(Upright(x, y, kPavement_m, 0.0), {0.9, 0.9, 2.6}, look,
            [](Canvas& c, Random& r, Side side) {
              c.Fill(c.area(), 70.0);
              if (side == Side::kLowZ || side == Side::kHighZ) return;
              PaintPoster(c, c.area().Part(0.05, 0.1, 0.95, 0.52), r);
              PaintPoster(c, c.area().Part(0.05, 0.55, 0.95, 0.95), r);
            });
        break;
      case 1:
        Box(Upright(x, y, kPavement_m, 0.0), {1.7, 0.5, 0.45}, look,
            [](Canvas& c, Random& r, Side side) {
              PaintBoards(c, c.area(), r, true, 0.1, 130.0, 20.0);
              if (side != Side::kHighZ) c.Fill(c.area().Part(0.1, 0.0, 0.9, 0.75), 26.0);
            });
        break;
      case 2:
        Box(Upright(x, y, kPavement_m, 0.0), {1.8, 0.6, 0.5}, look, [](Canvas& c, Random& r, Side) {
          PaintBricks(c, c.area(), r, 0.22, 0.07, 120.0, 24.0);
        });
        Box(Upright(x, y, kPavement_m + 0.5, 0.0), {1.7, 0.5, 0.45}, look,
            [](Canvas& c, Random& r, Side) { PaintFoliage(c, c.area(), r, 95.0); });
        break;
      case 3:
        Box(Upright(x, y, kPavement_m, 0.0), {1.1, 0.4, 1.3}, look,
            [](Canvas& c, Random& r, Side) { PaintMachineSide(c, c.area(), r, 140.0); });
        break;
      default:
        for (int k = -1; k <= 1; ++k) {
          Box(Upright(x + 0.8 * k, sign * 7.5, kPavement_m, 0.0), {0.16, 0.16, 0.9}, look,
              [](Canvas& c, Random& r, Side) {
                c.Fill(c.area(), 60.0);
                c.Fill(c.area().Part(0.0, 0.7, 1.0, 0.85), 226.0);
                PaintGrain(c, c.area(), r, 0.1);
              });
        }
    }
  }

 private:
  WorldBuilder& builder_;
  Random& random_;
};

void AddGround(WorldBuilder& builder) {
  builder.AddRectangle({-kEnd_m, -kKerb_m, 0.0}, Vector3d::UnitX(), Vector3d::UnitY(), 2.0 * kEnd_m,
                       2.0 * kKerb_m, {.texel_m = 0.012, .corner_density = 0.9},
                       [](Canvas& c, Random& r) { PaintRoad(c, c.area(), r); });
  for (const double s : {-1.0, 1.0}) {
    const Vector3d half(kEnd_m, 0.5 * (kFront_m + 1.0 - kKerb_m), 0.0);
    builder.AddBox(Upright(0.0, s * (kKerb_m + half.y()), 0.0, 0.0), -half,
                   half + Vector3d(0.0, 0.0, kPavement_m),
                   {.texel_m = 0.013, .corner_density = 0.7}, [](Canvas& c, Random& r, Side) {
                     if (c.area().height() > 1.0) {
                       PaintPavement(c, c.area(), r);
                     } else {
                       PaintBricks(c, c.area(), r, 0.9, 0.2, 150.0, 16.0);
                     }
                   });
  }
  for (const double s : {-1.0, 1.0}) {
    builder.AddRectangle({s > 0.0 ? kEnd_m : -kEnd_m - kTunnel_m, -kKerb_m, 0.0}, Vector3d::UnitX(),
                         Vector3d::UnitY(), kTunnel_m, 2.0 * kKerb_m,
                         {.texel_m = 0.03, .corner_density = 0.15}, [](Canvas& c, Random& r) {
                           c.Fill(c.area(), 80.0);
                           PaintWear(c, c.area(), r, 0.3, 40);
                         });
  }
}

// Both ends: a house across the street with a gate, and a dark yard behind it.
void AddEnds(WorldBuilder& builder, Builder& put) {
  for (const double s : {-1.0, 1.0}) {
    const Side front = s > 0.0 ? Side::kLowX : Side::kHighX;
    const double x0 = s > 0.0 ? kEnd_m : -kEnd_m - kTunnel_m;
    const double x1 = x0 + kTunnel_m;
    put.AddBlock({x0, -20.0, 0.0}, {x1, -kGate_m, 17.0}, front);
    put.AddBlock({x0, kGate_m, 0.0}, {x1, 20.0, 15.5}, front);
    put.AddBlock({x0, -kGate_m, 5.6}, {x1, kGate_m, 19.0}, front);
    // The end of the yard, seen through the gate.
    const double end = s > 0.0 ? x1 : x0;
    builder.AddRectangle(
        {end, s * kGate_m, 0.0}, Vector3d(0.0, -s, 0.0), Vector3d::UnitZ(), 2.0 * kGate_m, 5.6,
        {.texel_m = 0.02, .corner_density = 0.1, .light = 0.3},
        [](Canvas& c, Random& r) { PaintBricks(c, c.area(), r, 0.3, 0.1, 120.0, 20.0); });
    // Farther off something tall.
    put.AddBlock({s > 0.0 ? x1 + 12.0 : x0 - 34.0, -14.0 + 9.0 * s, 0.0},
                 {s > 0.0 ? x1 + 34.0 : x0 - 12.0, 8.0 + 9.0 * s, 34.0}, front);
  }
}

}  // namespace

std::shared_ptr<const World> MakeStreetWorld(const std::string& name, const WorldOptions& options) {
  WorldBuilder builder(name, options, 0.012, 0.22);
  builder.world().SetBounds({-kEnd_m, -9.0, 0.0}, {kEnd_m, 9.0, 60.0});
  builder.illumination().SetAmbient(0.86, 0.72);
  builder.illumination().SetOcclusionReach(2.2);
  builder.illumination().SetSun({0.38, -0.5, 0.78}, 0.62);
  AddSky(builder, options.seed);
  AddGround(builder);
  Builder put(builder);
  Random& random = builder.random();
  AddEnds(builder, put);
  for (const double s : {-1.0, 1.0}) {
    double x = -kEnd_m;
    while (x < kEnd_m - 6.0) {
      double end = x + random.Uniform(8.5, 15.0);
      if (end > kEnd_m - 7.0) end = kEnd_m;
      put.House(x, end, kFront_m + random.Uniform(0.0, 0.7), kBack_m, random.Uniform(8.5, 16.5), s);
      x = end;
      if (random.Index(4) == 0) x += random.Uniform(2.0, 3.5);  // an alley
    }
    // What stands on the pavement, each at its own place.
    std::vector<double> taken;
    const auto place = [&taken](double t) {
      for (const double other : taken) {
        if (std::abs(other - t) < 1.8) return false;
      }
      taken.push_back(t);
      return true;
    };
    for (double t = -80.0 + 4.0 * s; t < 82.0; t += random.Uniform(12.0, 17.0)) {
      if (place(t)) put.Tree(t, s * 8.1);
    }
    for (double t = -76.0 - 5.0 * s; t < 85.0; t += 22.0) {
      if (place(t)) put.Lamp(t, s);
    }
    for (double t = -70.0 + 7.0 * s; t < 80.0; t += random.Uniform(15.0, 26.0)) {
      if (place(t)) put.Sign(t, s);
    }
    for (double t = -83.0; t < 84.0; t += random.Uniform(4.0, 7.0)) {
      if (place(t)) put.Furniture(t, s);
    }
    for (double t = -78.0 + random.Uniform(0.0, 4.0); t < 80.0; t += random.Uniform(4.9, 6.5)) {
      if (random.Index(3) == 0) continue;
      AddParkedCar(builder,
                   Upright(t, s * 6.2 + random.Uniform(-0.08, 0.08), 0.0,
                           (s > 0.0 ? 3.14159265358979 : 0.0) + random.Uniform(-0.02, 0.02)));
    }
  }
  if (options.moving_bodies) {
    for (int k = 0; k < 4; ++k) {
      AddMovingCar(builder, {96.0, 3.92, 7.5, 98.0 * k + 20.0 * (k % 2)});
    }
    for (int k = 0; k < 6; ++k) {
      const double s = k % 2 == 0 ? 1.0 : -1.0;
      const double x = -60.0 + 22.0 * k;
      AddWalker(builder, {{x, 9.2 * s}, {x + 16.0, 9.2 * s}, 30.0, 0.17 * k},
                random.Uniform(1.6, 1.85));
    }
  }
  return builder.Build();
}

}  // namespace duet
