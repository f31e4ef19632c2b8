#include "experiments/simulation/world/moving_bodies.h"

#include <cmath>
#include <numbers>

#include "experiments/simulation/world/object_texture.h"

namespace duet {
namespace {

using Side = WorldBuilder::Side;

void PaintClothes(Canvas& canvas, Random& random, double grey) {
  const Area all = canvas.area();
  PaintPlaid(canvas, all, random, grey);
  canvas.Frame(all, 0.012, 0.4 * grey);
}

void PaintTrousers(Canvas& canvas, Random& random) {
  const Area all = canvas.area();
  canvas.Fill(all, 74.0);
  canvas.ScaleNoise(all, FractalNoise(random.Next(), 0.09, 0.3, 4, 0.75), 0.7);
  canvas.Fill(all.Part(0.0, 0.0, 1.0, 0.1), 24.0);  // shoes
  canvas.Fill(all.Part(0.0, 0.0, 1.0, 0.025), 200.0);
  canvas.Fill(all.Part(0.44, 0.1, 0.5, 1.0), 40.0, 0.8);
  canvas.Frame(all.Part(0.2, 0.7, 0.8, 0.85), 0.008, 150.0);
}

void PaintWalkerHead(Canvas& canvas, Random& random, Side side) {
  const Area all = canvas.area();
  canvas.Fill(all, 158.0);
  if (side == Side::kHighX) {  // the face
    for (const double f : {0.3, 0.7}) {
      canvas.FillDisc(all.x0 + f * all.width(), all.y0 + 0.6 * all.height(), 0.02, 225.0);
      canvas.FillDisc(all.x0 + f * all.width(), all.y0 + 0.6 * all.height(), 0.011, 20.0);
    }
    canvas.Fill(all.Part(0.46, 0.38, 0.54, 0.55), 120.0);
    canvas.Fill(all.Part(0.3, 0.22, 0.7, 0.27), 70.0);
    canvas.Fill(all.Part(0.0, 0.78, 1.0, 1.0), 42.0);
  } else {
    canvas.Fill(all.Part(0.0, side == Side::kHighZ ? 0.0 : 0.3, 1.0, 1.0), 42.0);
  }
  canvas.ScaleNoise(all, FractalNoise(random.Next(), 0.06, 4, 0.8), 0.4);
}

void PaintWheel(Canvas& canvas, double x, double y, double radius) {
  canvas.FillDisc(x, y, 1.15 * radius, 18.0);
  canvas.FillDisc(x, y, radius, 38.0);
  canvas.FillDisc(x, y, 0.66 * radius, 185.0);
  for (int k = 0; k < 5; ++k) {
    const double a = 2.0 * std::numbers::pi * k / 5.0 + 0.3;
    canvas.FillDisc(x + 0.4 * radius * std::cos(a), y + 0.4 * radius * std::sin(a), 0.16 * radius,
                    40.0);
  }
  canvas.FillDisc(x, y, 0.12 * radius, 60.0);
}

// The lower part of a car, 4.2 x 1.76 x 0.9 m, wheels painted on its flanks.
void PaintCarBody(Canvas& canvas, Random& random, Side side, double grey) {
  const Area all = canvas.area();
  canvas.Fill(all, grey);
  if (side == Side::kHighZ) {
    canvas.Line(all.x0 + 0.05, all.y0 + 0.25, all.x1 - 0.05, all.y0 + 0.25, 0.015, 0.4 * grey);
    canvas.Line(all.x0 + 0.05, all.y1 - 0.25, all.x1 - 0.05, all.y1 - 0.25, 0.015, 0.4 * grey);
    canvas.Line(all.x0 + 0.75 * all.width(), all.y0, all.x0 + 0.75 * all.width(), all.y1, 0.015,
                0.4 * grey);
    canvas.ScaleNoise(all, FractalNoise(random.Next(), 0.7, 4), 0.35);
    return;
  }
  canvas.FillGradient(all.Part(0.0, 0.22, 1.0, 1.0), 0.7 * grey, std::min(235.0, 1.25 * grey));
  canvas.Fill(all.Part(0.0, 0.0, 1.0, 0.2), 16.0);
  if (side == Side::kLowY || side == Side::kHighY) {
    canvas.Fill(all.Part(0.0, 0.52, 1.0, 0.56), 0.35 * grey);
    canvas.Fill(all.Part(0.0, 0.56, 1.0, 0.58), std::min(240.0, 1.5 * grey));
    for (const double f : {0.32, 0.52, 0.74}) {
      canvas.Line(all.x0 + f * all.width(), all.y0 + 0.2, all.x0 + f * all.width(), all.y1, 0.014,
                  0.25 * grey);
    }
    for (const double f : {0.36, 0.56}) {
      canvas.FillTurned(all.x0 + f * all.width(), all.y0 + 0.72, 0.08, 0.018, 0.0, 20.0);
    }
    for (const double f : {0.19, 0.81}) {
      PaintWheel(canvas, all.x0 + f * all.width(), all.y0 + 0.31, 0.3);
    }
  } else {
    for (const double f : {0.14, 0.86}) {
      canvas.FillTurned(all.x0 + f * all.width(), all.y0 + 0.68, 0.2, 0.09, 0.0, 30.0);
      canvas.FillTurned(all.x0 + f * all.width(), all.y0 + 0.68, 0.17, 0.065, 0.0,
                        side == Side::kHighX ? 240.0 : 130.0);
    }
    canvas.Fill(all.Part(0.3, 0.56, 0.7, 0.76), 28.0);
    for (int k = 0; k < 4; ++k) {
      canvas.Fill(all.Part(0.31, 0.585 + 0.045 * k, 0.69, 0.6 + 0.045 * k), 160.0);
    }
    const Area plate = all.Part(0.34, 0.3, 0.66, 0.43);
    canvas.Fill(plate, 228.0);
    canvas.Text(plate.x0 + 0.04, plate.y0 + 0.03, 0.075, RandomCode(random), 20.0);
  }
  PaintGrain(canvas, all, random, 0.05);
}

void PaintCarCabin(Canvas& canvas, Random& random, Side side, double grey) {
  const Area all = canvas.area();
  canvas.Fill(all, grey);
  if (side == Side::kHighZ) {
    canvas.ScaleNoise(all, FractalNoise(random.Next(), 0.8, 4), 0.3);
    canvas.Frame(all, 0.05, 0.6 * grey);
    return;
  }
  const bool flank = side == Side::kLowY || side == Side::kHighY;
  for (int k = 0; k < (flank ? 2 : 1); ++k) {
    const Area glass = flank ? all.Part(0.05 + 0.48 * k, 0.14, 0.47 + 0.48 * k, 0.86)
                             : all.Part(0.07, 0.1, 0.93, 0.9);
    canvas.FillGradient(glass, 34.0, 70.0);
    canvas.FillConvex({{glass.x0 + 0.1, glass.y0},
                       {glass.x0 + 0.35, glass.y0},
                       {glass.x0 + 0.6, glass.y1},
                       {glass.x0 + 0.35, glass.y1}},
                      170.0, 0.5);
    canvas.ScaleNoise(glass, FractalNoise(random.Next(), 0.3, 4, 0.7), 0.5);
    canvas.Frame(glass, 0.014, 15.0);
  }
}

void AddCarBoxes(WorldBuilder& builder, const Pose& pose, int body) {
  const double grey = builder.random().Uniform(60.0, 215.0);
  const WorldBuilder::Look look{.texel_m = 0.008, .corner_density = 0.35};
  builder.AddBox(
      pose, {-2.1, -0.88, 0.0}, {2.1, 0.88, 0.9}, look,
      [grey](Canvas& c, Random& r, Side side) { PaintCarBody(c, r, side, grey); }, body);
  builder.AddBox(
      pose, {-1.55, -0.78, 0.9}, {0.75, 0.78, 1.45}, look,
      [grey](Canvas& c, Random& r, Side side) { PaintCarCabin(c, r, side, grey); }, body);
}

}  // namespace

Pose ShuttleWay::At(double t_s) const {
  const double angle = 2.0 * std::numbers::pi * (t_s / period_s + phase);
  const double s = 0.5 - 0.5 * std::cos(angle);
  const Eigen::Vector2d p = a + s * (b - a);
  // Heads along the way and turns round while it is slow.
  const double turned = 0.5 - 0.5 * std::tanh(3.0 * std::sin(angle)) / std::tanh(3.0);
  const double heading = std::atan2(b.y() - a.y(), b.x() - a.x());
  return Upright(p.x(), p.y(), 0.0, heading + std::numbers::pi * turned);
}

double ShuttleWay::Speed(double t_s) const {
  const double angle = 2.0 * std::numbers::pi * (t_s / period_s + phase);
  return std::numbers::pi / period_s * (b - a).norm() * std::abs(std::sin(angle));
}

Pose LoopWay::At(double t_s) const {
  const double straight = 2.0 * half_length_m;
  const double arc = std::numbers::pi * half_width_m;
  const double length = 2.0 * (straight + arc);
  double s = start_m + speed_m_s * t_s;
  s -= length * std::floor(s / length);
  const bool second = s >= straight + arc;
  if (second) s -= straight + arc;
  const double sign = second ? -1.0 : 1.0;
  const double yaw = second ? std::numbers::pi : 0.0;
  if (s <= straight) {
    return Upright(sign * (s - half_length_m), -sign * half_width_m, 0.0, yaw);
  }
  const double a = (s - straight) / half_width_m;
  return Upright(sign * (half_length_m + half_width_m * std::sin(a)),
                 -sign * half_width_m * std::cos(a), 0.0, yaw + a);
}

void AddWalker(WorldBuilder& builder, const ShuttleWay& way, double height_m) {
  const double h = height_m;
  const double hip = 0.47 * h;
  const double shoulder = 0.8 * h;
  const double grey = builder.random().Uniform(90.0, 170.0);
  const WorldBuilder::Look look{.texel_m = 0.004, .corner_density = 1.0};
  World& world = builder.world();
  const int body = world.AddBody([way](double t_s) { return way.At(t_s); });
  const auto clothes = [grey](Canvas& c, Random& r, Side) { PaintClothes(c, r, grey); };
  builder.AddBox({}, {-0.12, -0.2, hip - 0.02}, {0.12, 0.2, shoulder + 0.04}, look, clothes, body);
  builder.AddBox(
      {}, {-0.05, -0.055, shoulder + 0.04}, {0.05, 0.055, 0.86 * h}, look,
      [](Canvas& c, Random& r, Side) {
        c.Fill(c.area(), 140.0);
        PaintGrain(c, c.area(), r, 0.2);
      },
      body);
  builder.AddBox({}, {-0.1, -0.08, 0.86 * h}, {0.1, 0.08, h}, look, PaintWalkerHead, body);
  // Limbs swing about hips and shoulders, as far as the walker is fast; the phase advances with the
  // distance walked along the way, so that feet do not slide much.
  const auto limb = [&](double y, double joint, double sign, double reach) {
    return world.AddBody([way, y, joint, sign, reach](double t_s) {
      const Pose T_G_walker = way.At(t_s);
      const double gone = (T_G_walker.p.head<2>() - way.a).norm();
      const double swing = sign * reach * std::min(1.0, way.Speed(t_s)) *
                           std::sin(2.0 * std::numbers::pi * gone / 1.3);
      const Pose T_walker_limb{
          Eigen::Quaterniond(Eigen::AngleAxisd(swing, Eigen::Vector3d::UnitY())),
          Eigen::Vector3d(0.0, y, joint)};
      return T_G_walker * T_walker_limb;
    });
  };
  for (const double sign : {-1.0, 1.0}) {
    const int leg = limb(0.1 * sign, hip, sign, 0.42);
    builder.AddBox(
        {}, {-0.085, -0.08, -hip + 0.005}, {0.085, 0.08, 0.03}, look,
        [](Canvas& c, Random& r, Side) { PaintTrousers(c, r); }, leg);
    const int arm = limb(0.25 * sign, shoulder, -sign, 0.35);
    builder.AddBox({}, {-0.05, -0.045, -0.36 * h}, {0.05, 0.045, 0.03}, look, clothes, arm);
  }
}

void AddMovingCar(WorldBuilder& builder, const LoopWay& way) {
  AddCarBoxes(builder, {}, builder.world().AddBody([way](double t_s) { return way.At(t_s); }));
}

void AddParkedCar(WorldBuilder& builder, const Pose& pose) { AddCarBoxes(builder, pose, 0); }

}  // namespace duet
