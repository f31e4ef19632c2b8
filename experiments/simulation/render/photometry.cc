#include "experiments/simulation/render/photometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/simulation/simulator.h"

namespace duet {
namespace {

// Independent sequences of one seed.
constexpr std::uint64_t kGainStream = 0x6761696e;

}  // namespace

std::vector<float> VignettingTable(const CameraModel& model, double vignetting) {
  const int width = model.width_px();
  const int height = model.height_px();
  const Eigen::Vector2d center = model.parameters().segment<2>(2);
  double max_square = 0.0;
  for (const double u : {0.0, width - 1.0}) {
    for (const double v : {0.0, height - 1.0}) {
      max_square = std::max(max_square, (Eigen::Vector2d(u, v) - center).squaredNorm());
    }
  }
  std::vector<float> table;
  table.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const double square = (Eigen::Vector2d(u, v) - center).squaredNorm();
      table.push_back(static_cast<float>(1.0 - vignetting * square / max_square));
    }
  }
  return table;
}

GainControl::GainControl(const PhotometryOptions& options, const TrueCamera* camera, int seed)
    : options_(options), camera_(camera), seed_(seed) {
  if (!options_.auto_exposure) return;
  for (const Surface& surface : camera_->world().surfaces()) {
    const Texture& texture = camera_->world().textures()[static_cast<std::size_t>(surface.texture)];
    surface_light_.push_back(surface.brightness * texture.levels().back().texels.front());
  }
}

double GainControl::MeanLight(int camera, Timestamp stamp) const {
  constexpr int kColumns = 8;
  constexpr int kRows = 6;
  const CameraModel& model = camera_->model(camera);
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d uv((column + 0.5) / kColumns * model.width_px() - 0.5,
                               (row + 0.5) / kRows * model.height_px() - 0.5);
      const auto point = camera_->PointAt(camera, stamp, uv);
      if (!point) continue;
      sum += surface_light_[static_cast<std::size_t>(point->surface)];
      ++count;
    }
  }
  return count > 0 ? options_.light * sum / count : 0.0;
}

double GainControl::GainAt(int camera, Timestamp stamp) const {
  double gain = options_.gain;
  if (options_.auto_exposure) {
    constexpr int kLooks = 5;
    double sum = 0.0;
    double weights = 0.0;
    for (int i = 0; i < kLooks; ++i) {
      const double share = (i + 0.5) / kLooks;
      const Timestamp before = ToNanoseconds(2.0 * share * options_.auto_exposure_lag_s);
      const double weight = std::exp(-2.0 * share);
      // Before the first frame it looked as it did then; the trajectory covers no more.
      const Timestamp first = camera_->start() + ToNanoseconds(kImuMargin_s);
      const Timestamp at = std::max(stamp - before, std::min(stamp, first));
      sum += weight * MeanLight(camera, at);
      weights += weight;
    }
    const double wanted = options_.auto_exposure_grey * weights / std::max(sum, 1e-9);
    gain =
        std::clamp(wanted, 1.0 / options_.auto_exposure_max_gain, options_.auto_exposure_max_gain);
  }
  if (options_.gain_change > 0.0) {
    Random random = Random(static_cast<std::uint64_t>(seed_), kGainStream)
                        .Fork(static_cast<std::uint64_t>(camera));
    const double t_s = SecondsBetween(camera_->start(), stamp);
    double change = 0.0;
    for (int i = 1; i <= 3; ++i) {
      const double phase = random.Uniform(0.0, 2.0 * std::numbers::pi);
      const double rate = 2.0 * std::numbers::pi * i / options_.gain_period_s;
      change += std::sin(rate * random.Uniform(0.9, 1.1) * t_s + phase) / i;
    }
    gain *= std::exp(options_.gain_change * change / 1.5);
  }
  return gain;
}

void QuantizeRow(const PhotometryOptions& options, double gain, const float* light, int count,
                 Random* random, std::uint8_t* grey) {
  const auto scale = static_cast<float>(gain);
  const auto per_grey = static_cast<float>(gain * options.noise_per_grey);
  const auto floor = static_cast<float>(gain * gain * options.noise_floor);
  const bool noisy = per_grey > 0.0F || floor > 0.0F;
  for (int i = 0; i < count; ++i) {
    float value = scale * light[i];
    if (noisy) {
      value += std::sqrt(per_grey * value + floor) * static_cast<float>(random->Normal());
    }
    grey[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
  }
}

}  // namespace duet
