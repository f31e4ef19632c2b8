#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/support/logging.h"

namespace duet {

/// One step of splitmix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014): advances *state and returns the next number.
[[nodiscard]] inline std::uint64_t SplitMix64(std::uint64_t* state) {
  std::uint64_t z = (*state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Seeded random numbers that are the same with every standard library: xoshiro256++ (Blackman and
/// Vigna, "Scrambled linear pseudorandom number generators", 2019), seeded by splitmix64.
class Random {
 public:
  /// `stream` separates independent sequences of one seed: Random(seed).Fork(stream) for any but 0.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : seed_(stream == 0 ? seed : ForkedSeed(seed, stream)) {
    std::uint64_t state = seed_;
    for (std::uint64_t& word : state_) word = SplitMix64(&state);
  }

  /// Starts from the generator's raw state (not all zero); for checking published vectors.
  static Random FromState(const std::array<std::uint64_t, 4>& state) {
    Random random(0);
    random.state_ = state;
    return random;
  }

  /// 64 uniform bits.
  std::uint64_t Next() {
    const std::uint64_t result = RotateLeft(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = RotateLeft(state_[3], 45);
    return result;
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }

  /// Uniform in [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  /// Standard normal, by Marsaglia's polar method; the pair's second number is kept for the next
  /// call.
  double Normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double x = 0.0;
    double y = 0.0;
    double s = 0.0;
    do {
      x = 2.0 * Uniform() - 1.0;
      y = 2.0 * Uniform() - 1.0;
      s = x * x + y * y;
    } while (s >= 1.0 || s == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = y * factor;
    has_spare_ = true;
    return x * factor;
  }

  /// Uniform in 0 ... n - 1 without bias; n > 0.
  int UniformInt(int n) {
    CHECK_GT(n, 0);
    const auto range = static_cast<std::uint64_t>(n);
    const std::uint64_t limit = UINT64_MAX - UINT64_MAX % range;
    std::uint64_t bits = Next();
    while (bits >= limit) bits = Next();
    return static_cast<int>(bits % range);
  }

  /// The same as UniformInt: an index into `count` things.
  int Index(int count) { return UniformInt(count); }

  /// Standard normals.
  template <int N>
  Eigen::Matrix<double, N, 1> NormalVector() {
    Eigen::Matrix<double, N, 1> v;
    for (int i = 0; i < N; ++i) v[i] = Normal();
    return v;
  }
  Eigen::VectorXd NormalVector(int size) {
    Eigen::VectorXd v(size);
    for (int i = 0; i < size; ++i) v[i] = Normal();
    return v;
  }

  /// A generator of its own for the stream of that number. It depends on this one's seed and on
  /// `stream` only, not on what has been drawn, so that adding a consumer changes no other's
  /// numbers.
  [[nodiscard]] Random Fork(std::uint64_t stream) const {
    return Random(ForkedSeed(seed_, stream));
  }

 private:
  static std::uint64_t ForkedSeed(std::uint64_t seed, std::uint64_t stream) {
    std::uint64_t a = seed;
    std::uint64_t b = SplitMix64(&a) ^ stream;
    return SplitMix64(&b);
  }
  static std::uint64_t RotateLeft(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

  std::uint64_t seed_;
  std::array<std::uint64_t, 4> state_{};
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace duet
