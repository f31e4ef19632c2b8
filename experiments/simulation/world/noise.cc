#include "experiments/simulation/world/noise.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/support/random.h"

namespace duet {
namespace {

// A seed of 32 bits for one octave.
std::uint32_t OctaveSeed(std::uint64_t seed, int octave) {
  std::uint64_t state = seed + 0x632be59bd9b4e019ULL * static_cast<std::uint64_t>(octave);
  return static_cast<std::uint32_t>(SplitMix64(&state) >> 32);
}

float Smooth(float t) { return t * t * (3.0f - 2.0f * t); }

}  // namespace

FractalNoise::FractalNoise(std::uint64_t seed, double cell_x_m, double cell_y_m, int octaves,
                           double gain) {
  double weight = 1.0;
  double sum = 0.0;
  for (int o = 0; o < octaves; ++o) {
    Octave octave;
    octave.seed = OctaveSeed(seed, o);
    octave.cell_x = std::ldexp(cell_x_m, -o);
    octave.cell_y = std::ldexp(cell_y_m, -o);
    octave.weight = static_cast<float>(weight);
    octaves_.push_back(octave);
    sum += weight;
    weight *= gain;
  }
  for (Octave& octave : octaves_) octave.weight /= static_cast<float>(sum);
}

void FractalNoise::SetColumns(double x0, double step, int count) {
  active_.clear();
  sum_.resize(static_cast<std::size_t>(count));
  for (const Octave& source : octaves_) {
    if (source.cell_x < 2.0 * step || source.cell_y < 2.0 * step) continue;
    Octave octave = source;
    octave.fraction.resize(sum_.size());
    octave.first_column = static_cast<int>(std::floor(x0 / octave.cell_x));
    for (int j = 0; j < count; ++j) {
      const double x = (x0 + j * step) / octave.cell_x;
      const double cell = std::floor(x);
      const auto number = static_cast<std::size_t>(static_cast<int>(cell) - octave.first_column);
      while (octave.starts.size() <= number) octave.starts.push_back(j);
      octave.fraction[j] = Smooth(static_cast<float>(x - cell));
    }
    octave.starts.push_back(count);
    const std::size_t columns = octave.starts.size();
    octave.low.resize(columns);
    octave.high.resize(columns);
    octave.between.resize(columns);
    active_.push_back(std::move(octave));
  }
}

void FractalNoise::FillLattice(const Octave& octave, int row, std::vector<float>* values) {
  for (std::size_t k = 0; k < values->size(); ++k) {
    (*values)[k] = LatticeValue(octave.seed, octave.first_column + static_cast<int>(k), row);
  }
}

const std::vector<float>& FractalNoise::Row(double y) {
  std::fill(sum_.begin(), sum_.end(), 0.0f);
  for (Octave& octave : active_) {
    const double place = y / octave.cell_y;
    const int row = static_cast<int>(std::floor(place));
    if (octave.has_row && row == octave.row + 1) {
      std::swap(octave.low, octave.high);
      FillLattice(octave, row + 1, &octave.high);
    } else if (!octave.has_row || row != octave.row) {
      FillLattice(octave, row, &octave.low);
      FillLattice(octave, row + 1, &octave.high);
    }
    octave.row = row;
    octave.has_row = true;
    const float up = Smooth(static_cast<float>(place - row));
    for (std::size_t k = 0; k < octave.low.size(); ++k) {
      octave.between[k] = octave.weight * (octave.low[k] + (octave.high[k] - octave.low[k]) * up);
    }
    const float* between = octave.between.data();
    const float* fraction = octave.fraction.data();
    float* sum = sum_.data();
    for (std::size_t k = 0; k + 1 < octave.starts.size(); ++k) {
      const float base = between[k];
      const float rise = between[k + 1] - base;
      const int begin = octave.starts[k];
      const int size = octave.starts[k + 1] - begin;
      if (size >= 12) {  // by packets; long cells are most of the work
        Eigen::Map<Eigen::ArrayXf>(sum + begin, size) +=
            base + rise * Eigen::Map<const Eigen::ArrayXf>(fraction + begin, size);
        continue;
      }
      for (int j = begin; j < begin + size; ++j) sum[j] += base + rise * fraction[j];
    }
  }
  return sum_;
}

float FractalNoise3(std::uint64_t seed, double x, double y, double z, int octaves) {
  float sum = 0.0f;
  float weight = 0.5f;
  for (int o = 0; o < octaves; ++o) {
    const std::uint32_t octave_seed = OctaveSeed(seed, o);
    const int i = static_cast<int>(std::floor(x));
    const int j = static_cast<int>(std::floor(y));
    const int k = static_cast<int>(std::floor(z));
    const float u = Smooth(static_cast<float>(x - i));
    const float v = Smooth(static_cast<float>(y - j));
    const float w = Smooth(static_cast<float>(z - k));
    float value = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
      const int di = corner & 1;
      const int dj = (corner >> 1) & 1;
      const int dk = corner >> 2;
      value += (di ? u : 1.0f - u) * (dj ? v : 1.0f - v) * (dk ? w : 1.0f - w) *
               LatticeValue(octave_seed, i + di, j + dj, k + dk);
    }
    sum += weight * value;
    weight *= 0.5f;
    x *= 2.0;
    y *= 2.0;
    z *= 2.0;
  }
  return sum;
}

}  // namespace duet
