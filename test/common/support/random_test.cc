#include "common/support/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace duet {
namespace {

TEST(Random, SplitMix64GivesItsPublishedNumbers) {
  // Reference implementation (Vigna, splitmix64.c), seeds 0 and 1234567.
  std::uint64_t state = 0;
  EXPECT_EQ(SplitMix64(&state), 0xE220A8397B1DCDAFULL);
  EXPECT_EQ(SplitMix64(&state), 0x6E789E6AA1B965F4ULL);
  EXPECT_EQ(SplitMix64(&state), 0x06C45D188009454FULL);
  state = 1234567;
  EXPECT_EQ(SplitMix64(&state), 6457827717110365317ULL);
  EXPECT_EQ(SplitMix64(&state), 3203168211198807973ULL);
}

TEST(Random, GeneratorGivesItsPublishedNumbers) {
  // xoshiro256++ from the state 1, 2, 3, 4 (reference implementation, as in Rust's rand_xoshiro).
  Random random = Random::FromState({1, 2, 3, 4});
  const std::vector<std::uint64_t> expected = {41943041ULL,
                                               58720359ULL,
                                               3588806011781223ULL,
                                               3591011842654386ULL,
                                               9228616714210784205ULL,
                                               9973669472204895162ULL,
                                               14011001112246962877ULL,
                                               12406186145184390807ULL,
                                               15849039046786891736ULL,
                                               10450023813501588000ULL};
  for (const std::uint64_t number : expected) EXPECT_EQ(random.Next(), number);
}

TEST(Random, UniformIsInRangeWithTheRightMoments) {
  Random random(1);
  constexpr int kCount = 200000;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.Uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    sum_of_squares += u * u;
  }
  // Five standard deviations of the estimates: sqrt(1/12/n), sqrt(4/45/n).
  EXPECT_NEAR(sum / kCount, 0.5, 5 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(sum_of_squares / kCount, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kCount));
}

TEST(Random, NormalHasTheMomentsAndTailsOfTheStandardNormal) {
  Random random(2);
  constexpr int kCount = 400000;
  double m1 = 0.0, m2 = 0.0, m3 = 0.0, m4 = 0.0, pairs = 0.0, previous = 0.0;
  int beyond_2 = 0, beyond_3 = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Normal();
    m1 += x;
    m2 += x * x;
    m3 += x * x * x;
    m4 += x * x * x * x;
    pairs += x * previous;
    previous = x;
    if (std::abs(x) > 2) ++beyond_2;
    if (std::abs(x) > 3) ++beyond_3;
  }
  const double n = kCount;
  // Five standard deviations; the variances of x, x^2, x^3, x^4 are 1, 2, 15, 96.
  EXPECT_NEAR(m1 / n, 0.0, 5 * std::sqrt(1 / n));
  EXPECT_NEAR(m2 / n, 1.0, 5 * std::sqrt(2 / n));
  EXPECT_NEAR(m3 / n, 0.0, 5 * std::sqrt(15 / n));
  EXPECT_NEAR(m4 / n, 3.0, 5 * std::sqrt(96 / n));
  EXPECT_NEAR(pairs / n, 0.0, 5 * std::sqrt(1 / n));
  const double p2 = std::erfc(2 / std::sqrt(2.0)), p3 = std::erfc(3 / std::sqrt(2.0));
  EXPECT_NEAR(beyond_2 / n, p2, 5 * std::sqrt(p2 / n));
  EXPECT_NEAR(beyond_3 / n, p3, 5 * std::sqrt(p3 / n));
}

TEST(Random, UniformIntCoversItsRangeEvenly) {
  Random random(3);
  constexpr int kCount = 70000;
  std::vector<int> histogram(7, 0);
  for (int i = 0; i < kCount; ++i) ++histogram.at(static_cast<std::size_t>(random.UniformInt(7)));
  // Five standard deviations of a count of 10000.
  for (const int count : histogram) EXPECT_NEAR(count, kCount / 7.0, 5 * std::sqrt(kCount / 7.0));
  EXPECT_EQ(random.UniformInt(1), 0);
}

TEST(Random, ForksDependOnSeedAndStreamOnly) {
  Random random(4);
  Random before = random.Fork(7);
  for (int i = 0; i < 10; ++i) (void)random.Next();
  Random after = random.Fork(7);
  Random same(4, 7);
  Random other = random.Fork(8);
  Random other_seed = Random(5).Fork(7);
  for (int i = 0; i < 10; ++i) {
    const std::uint64_t number = before.Next();
    EXPECT_EQ(after.Next(), number);
    EXPECT_EQ(same.Next(), number);
    EXPECT_NE(other.Next(), number);
    EXPECT_NE(other_seed.Next(), number);
  }
}

TEST(Random, ForkedStreamsAreUncorrelated) {
  const Random root(6);
  constexpr int kCount = 100000;
  Random a = root.Fork(0);
  Random b = root.Fork(1);
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) sum += a.Normal() * b.Normal();
  EXPECT_NEAR(sum / kCount, 0.0, 5 / std::sqrt(kCount));
}

}  // namespace
}  // namespace duet
