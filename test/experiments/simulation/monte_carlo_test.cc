// What the estimators promise, on simulated recordings: the quick part.

#include "experiments/simulation/monte_carlo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "test/experiments/simulation/consistency_study.h"

namespace duet {
namespace {

class EstimatorByName : public testing::TestWithParam<std::string> {};

TEST_P(EstimatorByName, PoseErrorsAreAsLargeAsItsCovarianceSays) {
  MonteCarloOptions options;
  options.runs = 20;
  const MonteCarloResult result = RunStudy(GetParam(), options);
  std::puts(MonteCarloText(GetParam(), result).c_str());
  EXPECT_EQ(result.consistency.failed, 0);
  EXPECT_EQ(result.consistency.not_computed, 0);
  // The chi-squared band of a mean over 20 runs is [4.58, 7.61] at 95 % and [4.2, 8.2] at 99.3 %.
  const BlockConsistency& pose = result.Block(NeesBlock::kPose);
  EXPECT_GE(pose.mean, 4.2);
  EXPECT_LE(pose.mean, 8.2);
}

// Start errors, IMU and pixel noise become smaller together, the random numbers stay the same: what
// is left when they vanish would be an error of the models or of the arithmetic. With the IMU at
// 2 kHz that floor lies below 1e-6 m: readings are interpolated linearly (at 200 Hz: 8e-6 m, and
// 100 times less at ten times the rate), and pixels are floats (2e-5 px).
TEST_P(EstimatorByName, ErrorsFollowTheNoiseOverThreeDecades) {
  MonteCarloOptions options;
  options.runs = 2;
  options.simulation.duration_s = 8.0;
  options.simulation.imu_rate_hz = 2000.0;
  const std::vector<double> scales = {1.0, 0.1, 0.01, 0.001};
  std::vector<double> position_m;
  std::vector<double> orientation_deg;
  for (const double scale : scales) {
    options.noise_scale = scale;
    const MonteCarloResult result = RunStudy(GetParam(), options);
    ASSERT_EQ(result.consistency.failed, 0);
    double p = 0.0;
    double theta = 0.0;
    for (const MonteCarloRun& run : result.runs) {
      p += run.position_rms_m * run.position_rms_m / options.runs;
      theta += run.orientation_rms_deg * run.orientation_rms_deg / options.runs;
    }
    position_m.push_back(std::sqrt(p));
    orientation_deg.push_back(std::sqrt(theta));
    std::printf("%s, noise x %g: %.3g m, %.3g deg\n", GetParam().c_str(), scale, position_m.back(),
                orientation_deg.back());
  }
  const double position_slope = LogLogSlope(scales, position_m);
  const double orientation_slope = LogLogSlope(scales, orientation_deg);
  std::printf("%s: slopes %.3f (position), %.3f (orientation)\n", GetParam().c_str(),
              position_slope, orientation_slope);
  EXPECT_NEAR(position_slope, 1.0, 0.1);
  EXPECT_NEAR(orientation_slope, 1.0, 0.1);
}

TEST_P(EstimatorByName, ThreadsDoNotChangeAStudy) {
  MonteCarloOptions options;
  options.simulation.duration_s = 3.0;
  options.runs = 3;
  options.settle_s = 0.5;
  options.threads = 1;
  const MonteCarloResult one = RunStudy(GetParam(), options);
  options.threads = 3;
  const MonteCarloResult three = RunStudy(GetParam(), options);
  for (std::size_t i = 0; i < one.runs.size(); ++i) {
    EXPECT_EQ(one.runs[i].seed, three.runs[i].seed);
    EXPECT_EQ(one.runs[i].position_rms_m, three.runs[i].position_rms_m);
    EXPECT_EQ(one.runs[i].orientation_rms_deg, three.runs[i].orientation_rms_deg);
  }
  EXPECT_EQ(one.Block(NeesBlock::kState).mean, three.Block(NeesBlock::kState).mean);
}

INSTANTIATE_TEST_SUITE_P(All, EstimatorByName, testing::ValuesIn(EstimatorNames()));

TEST(LogLogSlope, IsTheExponentOfAPowerLaw) {
  EXPECT_NEAR(LogLogSlope({1.0, 0.1, 0.001}, {5.0, 0.5, 0.005}), 1.0, 1e-12);
  EXPECT_NEAR(LogLogSlope({1.0, 2.0, 8.0}, {3.0, 12.0, 192.0}), 2.0, 1e-12);
}

}  // namespace
}  // namespace duet
