// Nothing in the measurements tells yaw: what an estimator reports of it can only get worse.

#include "test/backends/agreement/yaw_uncertainty.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace duet {
namespace {

class YawUncertaintyOf : public testing::TestWithParam<std::string> {};

TEST_P(YawUncertaintyOf, NeverFallsBelowTheStartWithFirstEstimates) {
  for (const bool first_estimates : {true, false}) {
    const test::YawUncertainty yaw =
        test::MeasureYaw(GetParam(), first_estimates, test::kTellingYawSigma_rad, 6.0);
    test::Print(GetParam(), first_estimates, yaw);
    ASSERT_EQ(yaw.failure, "");
    EXPECT_GT(yaw.at_rest, 20);
    EXPECT_EQ(yaw.lost, 0);
    if (first_estimates) {
      EXPECT_GT(yaw.smallest, 1.0 - 1e-6);
    } else {
      EXPECT_LT(yaw.smallest, 0.7);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, YawUncertaintyOf, testing::ValuesIn(EstimatorNames()),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace duet
