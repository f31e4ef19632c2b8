// Yaw over a minute with everything estimated: ./test.sh --all.

#include <gtest/gtest.h>

#include "test/backends/agreement/yaw_uncertainty.h"

namespace duet {
namespace {

class YawOverAMinute : public testing::TestWithParam<std::string> {};

TEST_P(YawOverAMinute, NeverFallsBelowTheStartWithFirstEstimates) {
  // The default, and one that is large enough to show what is gained falsely.
  for (const double sigma_rad : {1e-4, test::kTellingYawSigma_rad}) {
    const test::YawUncertainty yaw =
        test::MeasureYaw(GetParam(), test::WithFirstEstimates(true), sigma_rad, 60.0);
    test::Print(GetParam() + " with first estimates", yaw);
    ASSERT_EQ(yaw.failure, "");
    EXPECT_EQ(yaw.lost, 0);
    EXPECT_GT(yaw.smallest, 1.0 - 1e-6) << sigma_rad;
  }
  const test::YawUncertainty without = test::MeasureYaw(GetParam(), test::WithFirstEstimates(false),
                                                        test::kTellingYawSigma_rad, 60.0);
  test::Print(GetParam() + " without first estimates", without);
  EXPECT_LT(without.smallest, 0.5);
}

INSTANTIATE_TEST_SUITE_P(All, YawOverAMinute, testing::ValuesIn(EstimatorNames()),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace duet
