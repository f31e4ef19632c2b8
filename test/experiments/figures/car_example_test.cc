#include "experiments/figures/car_example.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

#include "evaluation/chi_squared.h"

namespace duet {
namespace {

// 3.24, 3.25: rank 1; the position is in the null space, the velocity is not.
TEST(CarExample, PositionIsUnobservable) {
  const Eigen::MatrixXd O = CarObservabilityMatrix({}, 50);
  EXPECT_EQ((O.transpose() * O).eval().fullPivHouseholderQr().rank(), 1);
  EXPECT_EQ(O.col(0).norm(), 0.0);
  EXPECT_TRUE((O.col(1).array() == 1.0).all());
}

TEST(CarExample, PositionsUncertaintyGrowsWithoutBoundVelocitysDoesNot) {
  const std::vector<CarState> states = DriveCar({});
  ASSERT_EQ(states.size(), 2001u);
  const auto variance = [&states](std::size_t i, int k) { return states[i].covariance(k, k); };
  // Once the velocity's variance is steady the position's grows by the same amount every step.
  EXPECT_NEAR(variance(2000, 1) / variance(500, 1), 1.0, 1e-9);
  const double first = variance(1000, 0) - variance(500, 0);
  EXPECT_NEAR((variance(2000, 0) - variance(1500, 0)) / first, 1.0, 1e-6);
  EXPECT_GT(first, 0.0);
}

// The filter is consistent: NEES over 400 seeds at the end within its 99.9 % band.
TEST(CarExample, ErrorsAreWhatTheFilterSays) {
  constexpr int kSeeds = 400;
  double sum = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const CarState last =
        DriveCar({.duration_s = 30.0, .seed = static_cast<std::uint64_t>(seed)}).back();
    const Eigen::Vector2d error = last.truth - last.estimate;
    sum += error.dot(last.covariance.ldlt().solve(error)) / kSeeds;
  }
  EXPECT_TRUE(MeanChiSquaredBand(2, kSeeds, 0.999).Contains(sum)) << sum;
}

// The truth is the sine: 10 m either way, to a step at full speed (0.31 m) and what Euler leaves.
TEST(CarExample, CarGoesForwardsAndBackwards) {
  double low = 0.0;
  double high = 0.0;
  for (const CarState& state : DriveCar({})) {
    low = std::min(low, state.truth[0]);
    high = std::max(high, state.truth[0]);
  }
  EXPECT_NEAR(high, 10.0, 0.4);
  EXPECT_NEAR(low, -10.0, 0.4);
}

}  // namespace
}  // namespace duet
