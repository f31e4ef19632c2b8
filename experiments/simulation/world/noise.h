#pragma once

#include <cstdint>
#include <vector>

namespace duet {

/// A uniform number in [-1, 1) that belongs to a lattice point: the same with every compiler.
[[nodiscard]] inline float LatticeValue(std::uint32_t seed, int i, int j, int k = 0) {
  std::uint32_t h = seed + 0x9e3779b9u * static_cast<std::uint32_t>(i);
  h = (h ^ (h >> 16)) * 0x85ebca6bu + 0xc2b2ae35u * static_cast<std::uint32_t>(j);
  h = (h ^ (h >> 13)) * 0x27d4eb2fu + 0x165667b1u * static_cast<std::uint32_t>(k);
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h ^= h >> 16;
  return static_cast<float>(static_cast<std::int32_t>(h)) * 0x1.0p-31f;
}

/// Smooth noise in the plane: octaves of interpolated lattice values, each with half the cell of
/// the one before and `gain` times its weight; the sum of the weights is 1. Evaluated by rows.
class FractalNoise {
 public:
  /// `cell_x_m`, `cell_y_m`: the first octave's; unequal ones make grain and streaks.
  FractalNoise(std::uint64_t seed, double cell_x_m, double cell_y_m, int octaves,
               double gain = 0.5);
  FractalNoise(std::uint64_t seed, double cell_m, int octaves, double gain = 0.5)
      : FractalNoise(seed, cell_m, cell_m, octaves, gain) {}

  /// Prepares rows of `count` places x0 + j step. Octaves whose cells are smaller than two steps
  /// are left out: they would not be band-limited.
  void SetColumns(double x0, double step, int count);
  /// The row at y, in [-1, 1]; rows that follow one another share their work.
  [[nodiscard]] const std::vector<float>& Row(double y);

 private:
  struct Octave {
    std::uint32_t seed;
    double cell_x, cell_y;
    float weight;
    int first_column = 0;
    int row = 0;
    bool has_row = false;
    std::vector<float> low, high, between;
    std::vector<int> starts;  ///< of each cell the first place, and at last the end
    std::vector<float> fraction;
  };
  static void FillLattice(const Octave& octave, int row, std::vector<float>* values);

  std::vector<Octave> octaves_;
  std::vector<Octave> active_;
  std::vector<float> sum_;
};

/// The same in space, one point at a time (for skies).
[[nodiscard]] float FractalNoise3(std::uint64_t seed, double x, double y, double z, int octaves);

}  // namespace duet
