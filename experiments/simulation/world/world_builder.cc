#include "experiments/simulation/world/world_builder.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "common/support/logging.h"

namespace duet {
namespace {

using Side = WorldBuilder::Side;

struct BoxFace {
  Side side;
  Eigen::Vector3d outward, up;
};

const std::array<BoxFace, 6>& BoxFaces() {
  static const std::array<BoxFace, 6> faces = {
      {{Side::kLowX, -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
       {Side::kHighX, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
       {Side::kLowY, -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()},
       {Side::kHighY, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()},
       {Side::kLowZ, -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()},
       {Side::kHighZ, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()}}};
  return faces;
}

// The face of a box that looks along `normal`, with v along `up`.
Surface FaceOf(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
               const Eigen::Vector3d& place, const Eigen::Vector3d& normal,
               const Eigen::Vector3d& up) {
  const Eigen::Vector3d center = 0.5 * (low + high);
  const Eigen::Vector3d size = high - low;
  Surface surface;
  surface.u_axis = up.cross(normal);
  surface.v_axis = up;
  surface.width_m = size.dot(surface.u_axis.cwiseAbs());
  surface.height_m = size.dot(up.cwiseAbs());
  surface.corner = center + 0.5 * size.cwiseProduct(place) -
                   0.5 * surface.width_m * surface.u_axis - 0.5 * surface.height_m * up;
  return surface;
}

// Light on a moving body: the same wherever it is.
double BodyLight(const Eigen::Vector3d& normal) {
  return 0.78 + 0.22 * normal.z() + 0.1 * normal.x() - 0.06 * normal.y();
}

}  // namespace

Pose Upright(double x, double y, double z, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, y, z}};
}

WorldBuilder::WorldBuilder(const std::string& name, const WorldOptions& options, double texel_m,
                           double light_cell_m)
    : options_(options),
      texel_m_(texel_m),
      texel_scale_(options.texel_m > 0.0 ? options.texel_m / texel_m : 1.0),
      light_cell_m_(light_cell_m),
      random_(options.seed, 1),
      world_(std::make_shared<World>(name)) {}

void WorldBuilder::AddRectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u_axis,
                                const Eigen::Vector3d& v_axis, double width_m, double height_m,
                                const Look& look, Painter paint, int body) {
  Surface surface;
  surface.corner = corner;
  surface.u_axis = u_axis.normalized();
  surface.v_axis = v_axis.normalized();
  surface.width_m = width_m;
  surface.height_m = height_m;
  surface.two_sided = look.two_sided;
  surface.body = body;
  surface.texture = static_cast<int>(jobs_.size());
  surface.corner_density = look.corner_density;
  const int index = world_->AddSurface(surface);
  jobs_.push_back({index, look, std::move(paint)});
}

void WorldBuilder::AddInside(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                             const Look& look, const SidePainter& paint) {
  for (const BoxFace& face : BoxFaces()) {
    const Surface s = FaceOf(low, high, face.outward, -face.outward, face.up);
    AddRectangle(s.corner, s.u_axis, s.v_axis, s.width_m, s.height_m, look,
                 [paint, side = face.side](Canvas& c, Random& r) { paint(c, r, side); });
  }
}

void WorldBuilder::AddBox(const Pose& pose, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                          const Look& look, const SidePainter& paint, int body) {
  for (const BoxFace& face : BoxFaces()) {
    const Surface s = FaceOf(low, high, face.outward, face.outward, face.up);
    if (body == 0 && face.side == Side::kLowZ && (pose * s.corner).z() < 1e-6) continue;
    Look side_look = look;
    if (body != 0 && look.light == 0.0) side_look.light = BodyLight(pose.R * face.outward);
    AddRectangle(
        pose * s.corner, pose.R * s.u_axis, pose.R * s.v_axis, s.width_m, s.height_m, side_look,
        [paint, side = face.side](Canvas& c, Random& r) { paint(c, r, side); }, body);
  }
  world_->AddSolid(body, pose, low, high);
  if (body == 0 && look.light == 0.0) illumination_.AddBlocker(pose, low, high);
}

Texture WorldBuilder::Bake(const Surface& surface, const Job& job, std::uint64_t number) const {
  const double texel = (job.look.texel_m > 0.0 ? job.look.texel_m : texel_m_) * texel_scale_;
  Canvas canvas({0.0, 0.0, surface.width_m, surface.height_m}, texel, 128.0);
  Random random = Random(options_.seed, 2).Fork(number);
  job.paint(canvas, random);
  // A whole number of cells over the canvas, which is up to a texel larger than the surface.
  const auto cells = [&](double size) {
    if (job.look.light > 0.0) return 1;
    const double cell = std::max(light_cell_m_, 16.0 * texel);  // coarse with the texture
    return std::max(3, static_cast<int>(std::ceil(size / cell)));
  };
  const int columns = cells(surface.width_m);
  const int rows = cells(surface.height_m);
  std::vector<float> light(static_cast<std::size_t>(columns) * rows,
                           static_cast<float>(job.look.light));
  if (job.look.light == 0.0) {
    const Eigen::Vector3d x_step = canvas.width() * texel / columns * surface.u_axis;
    const Eigen::Vector3d y_step = canvas.height() * texel / rows * surface.v_axis;
    light = illumination_.Map(
        {surface.corner + 0.5 * x_step + 0.5 * y_step, x_step, y_step, columns, rows},
        surface.u_axis.cross(surface.v_axis));
  }
  canvas.Shade(light, columns, rows);
  return canvas.ToTexture();
}

std::shared_ptr<const World> WorldBuilder::Build() {
  const std::size_t count = jobs_.size();
  if (!options_.textures) {
    for (std::size_t k = 0; k < count; ++k) world_->AddTexture(Texture(1, 1, 1.0, {128}));
    return world_;
  }
  CHECK_GE(options_.threads, 1);
  std::vector<std::optional<Texture>> textures(count);
  // The largest first, so that no thread is left with one at the end.
  std::vector<std::size_t> order(count);
  for (std::size_t k = 0; k < count; ++k) order[k] = k;
  const auto texels = [this](std::size_t k) {
    const Surface& s = world_->surfaces()[jobs_[k].surface];
    const double texel = jobs_[k].look.texel_m > 0.0 ? jobs_[k].look.texel_m : texel_m_;
    return s.width_m * s.height_m / (texel * texel);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return texels(a) > texels(b); });
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t n = next++; n < count; n = next++) {
      const std::size_t k = order[n];
      textures[k] = Bake(world_->surfaces()[jobs_[k].surface], jobs_[k], k);
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < options_.threads; ++t) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  for (std::optional<Texture>& texture : textures) world_->AddTexture(std::move(*texture));
  return world_;
}

}  // namespace duet
