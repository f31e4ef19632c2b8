#include "test/experiments/simulation/render/small_world.h"

#include <cmath>

#include "common/support/random.h"

namespace duet {
namespace {

// Noise between random values `period` texels apart, by smooth steps.
class ValueNoise {
 public:
  ValueNoise(int width, int height, double period, Random* random)
      : period_(period), columns_(static_cast<int>(width / period) + 2) {
    const int rows = static_cast<int>(height / period) + 2;
    for (int i = 0; i < columns_ * rows; ++i) values_.push_back(random->Uniform(-1.0, 1.0));
  }
  [[nodiscard]] double At(double x, double y) const {
    const double u = x / period_;
    const double v = y / period_;
    const int i = static_cast<int>(u);
    const int j = static_cast<int>(v);
    const double a = Smooth(u - i);
    const double b = Smooth(v - j);
    const double* low = values_.data() + j * columns_ + i;
    const double* high = low + columns_;
    return (1 - b) * ((1 - a) * low[0] + a * low[1]) + b * ((1 - a) * high[0] + a * high[1]);
  }

 private:
  static double Smooth(double x) { return x * x * (3.0 - 2.0 * x); }
  double period_;
  int columns_;
  std::vector<double> values_;
};

}  // namespace

Texture NoiseTexture(int width, int height, double texel_m, std::uint64_t seed) {
  Random random(seed);
  std::vector<ValueNoise> octaves;
  std::vector<double> amplitudes;
  for (double period = 7.0; period < 0.5 * width; period *= 2.3) {
    octaves.emplace_back(width, height, period, &random);
    amplitudes.push_back(period < 100.0 ? 45.0 : 20.0);
  }
  std::vector<std::uint8_t> texels;
  texels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double value = 125.0;
      for (std::size_t i = 0; i < octaves.size(); ++i) {
        value += amplitudes[i] * octaves[i].At(x, y);
      }
      texels.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(value, 5.0, 250.0))));
    }
  }
  return {width, height, texel_m, std::move(texels)};
}

Texture StepTexture(double width_m, double height_m, double texel_m, double edge_m,
                    std::uint8_t low, std::uint8_t high) {
  const int width = static_cast<int>(std::lround(width_m / texel_m));
  const int height = static_cast<int>(std::lround(height_m / texel_m));
  const int edge = static_cast<int>(std::lround(edge_m / texel_m));
  std::vector<std::uint8_t> texels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) texels.push_back(x < edge ? low : high);
  }
  return {width, height, texel_m, std::move(texels)};
}

std::shared_ptr<const World> NoisyRoom(bool boxes, double texel_m) {
  auto world = std::make_shared<World>("noisy_room");
  const int size = static_cast<int>(6.0 / texel_m);
  for (std::uint64_t i = 0; i < 6; ++i) {
    world->AddTexture(NoiseTexture(size, size, texel_m, 100 + i));
  }
  using Eigen::Vector3d;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const auto wall = [&](const Vector3d& corner, const Vector3d& u, const Vector3d& v, double height,
                        int texture) {
    Surface surface;
    surface.corner = corner;
    surface.u_axis = u;
    surface.v_axis = v;
    surface.width_m = 6.0;
    surface.height_m = height;
    surface.texture = texture;
    world->AddSurface(surface);
  };
  wall({-3, -3, 0}, x, y, 6.0, 0);  // floor, looks up
  wall({-3, 3, 3}, x, -y, 6.0, 1);  // ceiling
  wall({3, 3, 0}, -y, z, 3.0, 2);   // x = 3, looks along -x
  wall({-3, -3, 0}, y, z, 3.0, 3);  // x = -3
  wall({-3, 3, 0}, x, z, 3.0, 4);   // y = 3
  wall({3, -3, 0}, -x, z, 3.0, 5);  // y = -3
  if (boxes) {
    Surface side;
    side.brightness = 1.2;
    const Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, z)), {1.6, 1.2, 0.0}};
    world->AddBox(turned, {-0.3, -0.2, 0.0}, {0.3, 0.2, 1.1}, side);
    world->AddBox(Pose{}, {1.2, -1.5, 0.0}, {1.7, -1.0, 0.7}, side);
    world->AddBox(Pose{}, {2.2, -0.6, 0.8}, {2.5, 0.1, 1.9}, side);
    side.body = world->AddBody([](double t_s) {
      return Pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * t_s, Vector3d::UnitZ())),
                  {1.0, 0.5 * std::sin(2.0 * t_s), 1.3}};
    });
    world->AddBox(Pose{}, {-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}, side);
  }
  world->SetBounds({-3, -3, 0}, {3, 3, 3});
  return world;
}

std::shared_ptr<World> Wall(double distance_m, double half_extent_m, Texture texture) {
  auto world = std::make_shared<World>("wall");
  Surface surface;
  surface.corner = {distance_m, half_extent_m, half_extent_m};
  surface.u_axis = -Eigen::Vector3d::UnitY();
  surface.v_axis = -Eigen::Vector3d::UnitZ();
  surface.width_m = 2.0 * half_extent_m;
  surface.height_m = 2.0 * half_extent_m;
  surface.two_sided = true;
  surface.texture = world->AddTexture(std::move(texture));
  world->AddSurface(surface);
  return world;
}

CameraModel QuarterCamera(DistortionModel model) {
  if (model == DistortionModel::kRadialTangential) {
    CameraModel::Parameters parameters(9);
    parameters << 114.7, 114.3, 91.5, 61.8, -0.283, 0.0740, 1.9e-4, 1.8e-5, 0.0;
    return {model, 188, 120, parameters};
  }
  CameraModel::Parameters parameters(8);
  parameters << 95.2, 94.9, 93.1, 60.4, 0.0034, 0.0007, -0.0021, 0.0003;
  return {model, 188, 120, parameters};
}

RigCalibration ForwardRig(const CameraModel& model) {
  RigCalibration rig;
  Eigen::Matrix3d R_CB;
  R_CB << 0, -1, 0,  //
      0, 0, -1,      //
      1, 0, 0;
  rig.cameras.push_back({.model = model, .R_CB = Eigen::Quaterniond(R_CB), .p_CB = {0, 0, 0}});
  return rig;
}

Kinematics SteadyMotion::At(double t_s) const {
  Kinematics k;
  k.T_GB.R = ExpQuaternion(t_s * omega_);
  k.T_GB.p = p_ + t_s * v_;
  k.v_GB = v_;
  k.omega_B = omega_;
  return k;
}

}  // namespace duet
