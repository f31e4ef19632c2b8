// Nothing in the measurements tells yaw: what an estimator reports of it can only get worse.

#include "test/backends/agreement/yaw_uncertainty.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace duet {
namespace {

class YawUncertaintyOf : public testing::TestWithParam<std::string> {};

constexpr double kDuration_s = 6.0;

void ExpectNoGain(const std::string& estimator, const BackendOptions& backends) {
  const test::YawUncertainty yaw =
      test::MeasureYaw(estimator, backends, test::kTellingYawSigma_rad, kDuration_s);
  test::Print(estimator + " with first estimates", yaw);
  ASSERT_EQ(yaw.failure, "");
  EXPECT_GT(yaw.at_rest, 20);
  EXPECT_EQ(yaw.lost, 0);
  EXPECT_GT(yaw.smallest, 1.0 - 1e-6);
}

TEST_P(YawUncertaintyOf, NeverFallsBelowTheStartWithFirstEstimates) {
  ExpectNoGain(GetParam(), test::WithFirstEstimates(true));
}

TEST_P(YawUncertaintyOf, FallsBelowTheStartWithout) {
  const test::YawUncertainty yaw = test::MeasureYaw(GetParam(), test::WithFirstEstimates(false),
                                                    test::kTellingYawSigma_rad, kDuration_s);
  test::Print(GetParam() + " without first estimates", yaw);
  EXPECT_LT(yaw.smallest, 0.7);
}

TEST(YawUncertainty, NeverFallsBelowTheStartWithTheFiltersFirstEstimatesKept) {
  BackendOptions backends;
  backends.msckf.rebase_first_estimates = false;
  ExpectNoGain("msckf", backends);
}

INSTANTIATE_TEST_SUITE_P(All, YawUncertaintyOf, testing::ValuesIn(EstimatorNames()),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace duet
