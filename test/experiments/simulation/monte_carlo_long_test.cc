// What the estimators promise, on 100 simulated recordings: ./test.sh --all.

#include <gtest/gtest.h>

#include <cstdio>

#include "experiments/simulation/monte_carlo.h"
#include "test/experiments/simulation/consistency_study.h"

namespace duet {
namespace {

class EstimatorByName : public testing::TestWithParam<std::string> {};

TEST_P(EstimatorByName, PoseErrorsAreAsLargeAsItsCovarianceSays) {
  MonteCarloOptions options;
  options.runs = 100;
  const MonteCarloResult result = RunStudy(GetParam(), options);
  std::puts(MonteCarloText(GetParam(), result).c_str());
  EXPECT_EQ(result.consistency.failed, 0);
  EXPECT_EQ(result.consistency.not_computed, 0);
  const BlockConsistency& pose = result.Block(NeesBlock::kPose);
  EXPECT_GE(pose.mean, 5.0);
  EXPECT_LE(pose.mean, 7.0);
  // The 95 % band of a mean of 100 chi-squared variables with six degrees of freedom.
  EXPECT_NEAR(pose.band.low, 5.34, 0.01);
  EXPECT_NEAR(pose.band.high, 6.70, 0.01);
  EXPECT_GE(pose.median_instant, pose.band.low);
  EXPECT_LE(pose.median_instant, pose.band.high);
}

INSTANTIATE_TEST_SUITE_P(All, EstimatorByName, testing::ValuesIn(EstimatorNames()));

}  // namespace
}  // namespace duet
