#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace duet {

/// Random numbers that are the project's own to define (std::normal_distribution differs between
/// libraries): xoshiro256++ of Blackman and Vigna, seeded by splitmix64; normals by Marsaglia's
/// polar method. `stream` separates independent sequences of one seed.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) {
    std::uint64_t x = seed ^ (0x9e3779b97f4a7c15ULL * (2 * stream + 1));
    for (std::uint64_t& word : state_) {
      x += 0x9e3779b97f4a7c15ULL;
      std::uint64_t z = x;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
      word = z ^ (z >> 31);
    }
  }

  [[nodiscard]] std::uint64_t NextBits() {
    const std::uint64_t result = Rotate(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = Rotate(state_[3], 45);
    return result;
  }

  /// Uniform in [0, 1), 53 bits.
  [[nodiscard]] double Uniform() { return static_cast<double>(NextBits() >> 11) * 0x1.0p-53; }
  /// Uniform in [low, high).
  [[nodiscard]] double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Uniform in 0 .. count - 1; count > 0.
  [[nodiscard]] int Index(int count) {
    return static_cast<int>(Uniform() * static_cast<double>(count));
  }

  /// Standard normal.
  [[nodiscard]] double Normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double r2 = 0.0;
    do {
      u = Uniform(-1.0, 1.0);
      v = Uniform(-1.0, 1.0);
      r2 = u * u + v * v;
    } while (r2 >= 1.0 || r2 == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(r2) / r2);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

  /// Standard normals.
  template <int N>
  [[nodiscard]] Eigen::Matrix<double, N, 1> NormalVector() {
    Eigen::Matrix<double, N, 1> v;
    for (int i = 0; i < N; ++i) v[i] = Normal();
    return v;
  }
  [[nodiscard]] Eigen::VectorXd NormalVector(int size) {
    Eigen::VectorXd v(size);
    for (int i = 0; i < size; ++i) v[i] = Normal();
    return v;
  }

 private:
  static std::uint64_t Rotate(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

  std::uint64_t state_[4];
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace duet
