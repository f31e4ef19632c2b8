// What a run says of each estimated number: found, not found, or off its prior.

#include "experiments/calibration_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/support/input_error.h"

namespace duet {
namespace {

EstimatorOutput OutputAt(double t_s, double t_d_s, double sigma_t_d, double sigma_t_r) {
  EstimatorOutput output;
  output.state.instant = ToNanoseconds(t_s);
  output.rig.t_d_s = t_d_s;
  output.covariance = Eigen::MatrixXd::Identity(17, 17);
  output.covariance(15, 15) = sigma_t_d * sigma_t_d;
  output.covariance(16, 16) = sigma_t_r * sigma_t_r;
  return output;
}

CalibrationWatch WatchTimes() {
  CalibrationPriors priors;
  priors.t_d.estimated = priors.t_r.estimated = true;
  priors.t_d.sigma = 0.01;
  priors.t_r.sigma = 0.02;
  return {CalibrationLayout(priors, RigCalibration()), RigCalibration()};
}

TEST(CalibrationWatch, TellsWhatWasObserved) {
  CalibrationWatch watch = WatchTimes();
  EXPECT_TRUE(watch.Numbers().empty());
  watch.Add(OutputAt(10.0, 0.0, 0.01, 0.02));
  watch.Add(OutputAt(12.0, 0.004, 0.001, 0.019));
  const std::vector<CalibrationWatch::Number> numbers = watch.Numbers();
  ASSERT_EQ(numbers.size(), 2u);
  EXPECT_EQ(numbers[0].name, "t_d");
  EXPECT_TRUE(numbers[0].observed);
  EXPECT_FALSE(numbers[1].observed);  // 0.019 is more than 0.9 of 0.02
  EXPECT_TRUE(CalibrationWarnings(numbers).empty());
  EXPECT_THAT(CalibrationWatchText(numbers), testing::HasSubstr("not observed on this recording"));
}

TEST(CalibrationWatch, WarnsWithTheTimeWhereAnEstimateLeavesItsPrior) {
  CalibrationWatch watch = WatchTimes();
  watch.Add(OutputAt(10.0, 0.0, 0.01, 0.02));
  watch.Add(OutputAt(11.5, 0.051, 0.001, 0.02));  // 5.1 sigma
  watch.Add(OutputAt(12.0, 0.002, 0.001, 0.02));  // back again: said all the same
  const std::vector<std::string> warnings = CalibrationWarnings(watch.Numbers());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::AllOf(testing::HasSubstr("t_d left its prior"),
                                          testing::HasSubstr("after 1.50 s, up to 5.1")));
}

TEST(CalibrationWatch, SaysWhereAnEstimateIsHeldAtItsBound) {
  CalibrationPriors priors;
  priors.t_d.estimated = priors.t_r.estimated = true;
  priors.t_d.sigma = 0.02;
  CalibrationWatch watch(CalibrationLayout(priors, RigCalibration()), RigCalibration(),
                         {.max_abs_t_d_s = 0.05, .max_abs_t_r_s = 0.05});
  watch.Add(OutputAt(10.0, 0.049, 0.01, 0.001));
  EXPECT_TRUE(CalibrationWarnings(watch.Numbers()).empty());
  watch.Add(OutputAt(10.5, 0.05, 0.001, 0.001));
  const std::vector<std::string> warnings = CalibrationWarnings(watch.Numbers());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::HasSubstr("t_d was held at its bound (shared.max_abs_t_d_s) "
                                              "after 0.50 s"));
  EXPECT_THAT(CalibrationWatchText(watch.Numbers()), testing::HasSubstr("HELD AT ITS BOUND"));
}

TEST(CalibrationWatch, DoesNotCallUnobservedWhatWasPushedFromItsPrior) {
  CalibrationWatch watch = WatchTimes();
  watch.Add(OutputAt(10.0, 0.04, 0.0095, 0.02));  // 4 sigma of the prior, sigma 0.95 of it
  EXPECT_THAT(CalibrationWatchText(watch.Numbers()), testing::HasSubstr("at odds with its prior"));
}

TEST(CalibrationWatch, ItsFileReadsBackAndBadOnesAreRefused) {
  CalibrationWatch watch = WatchTimes();
  watch.Add(OutputAt(1.0, 0.06, 0.001, 0.02));
  const std::vector<CalibrationWatch::Number> numbers = watch.Numbers();
  const std::string csv = CalibrationCsv(numbers);
  const std::vector<CalibrationWatch::Number> read = ReadCalibrationCsv(csv, "calibration.csv");
  ASSERT_EQ(read.size(), numbers.size());
  EXPECT_EQ(CalibrationCsv(read), csv);
  EXPECT_THROW((void)ReadCalibrationCsv("#x\n1,2,3\n", "calibration.csv"), InputError);
  EXPECT_THROW((void)ReadCalibrationCsv("#x\n1,2,3,4,1,nan,0,-1,t_d\n", "calibration.csv"),
               InputError);
}

}  // namespace
}  // namespace duet
