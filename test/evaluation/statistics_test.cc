#include "evaluation/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/chi_squared.h"
#include "evaluation/holm.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

TEST(Statistics, QuantilesOfTenNumbersByHand) {
  // h = 9 p; numpy.quantile's default gives the same.
  const std::vector<double> v = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  EXPECT_DOUBLE_EQ(SortedQuantile(v, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(SortedQuantile(v, 0.05), 1.45);
  EXPECT_DOUBLE_EQ(SortedQuantile(v, 0.25), 3.25);
  EXPECT_DOUBLE_EQ(SortedQuantile(v, 0.5), 5.5);
  EXPECT_DOUBLE_EQ(SortedQuantile(v, 0.99), 9.91);
  EXPECT_DOUBLE_EQ(SortedQuantile(v, 1.0), 10.0);
  EXPECT_DOUBLE_EQ(SortedQuantile(std::vector<double>{7.0}, 0.99), 7.0);
}

TEST(Statistics, SummaryByHandAndOfAnyOrder) {
  const ErrorSummary s = Summarize({4.0, 3.0, 0.0, 5.0});
  EXPECT_EQ(s.count, 4);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(50.0 / 4.0));
  EXPECT_DOUBLE_EQ(s.mean, 3.0);
  EXPECT_DOUBLE_EQ(s.median, 3.5);
  EXPECT_DOUBLE_EQ(s.min, 0.0);
  EXPECT_DOUBLE_EQ(s.max, 5.0);
  const ErrorSummary shuffled = Summarize({0.1, 0.7, 0.3, 1e9, 0.2});
  EXPECT_EQ(shuffled.rmse, Summarize({1e9, 0.3, 0.2, 0.7, 0.1}).rmse);
}

TEST(Statistics, NothingHasNoNumbers) {
  const ErrorSummary s = Summarize({});
  EXPECT_EQ(s.count, 0);
  EXPECT_TRUE(std::isnan(s.rmse));
  EXPECT_TRUE(std::isnan(s.p99));
}

TEST(ChiSquared, BandsOfAHundredRunsAreThoseOfTheDesign) {
  const auto expect_band = [](double dof, double low, double high) {
    const Band band = MeanChiSquaredBand(dof, 100, 0.95);
    EXPECT_NEAR(band.low, low, 0.005) << dof;  // the design prints two digits
    EXPECT_NEAR(band.high, high, 0.005) << dof;
  };
  expect_band(3, 2.54, 3.50);
  expect_band(6, 5.34, 6.70);
  expect_band(15, 13.95, 16.09);
}

TEST(ChiSquared, QuantilesFromTables) {
  EXPECT_NEAR(ChiSquaredQuantile(0.95, 1), 3.841459, 1e-6);
  EXPECT_NEAR(ChiSquaredQuantile(0.95, 6), 12.591587, 1e-6);
  // Two degrees of freedom: an exponential distribution of mean 2.
  EXPECT_NEAR(ChiSquaredQuantile(0.7, 2), -2.0 * std::log(0.3), 1e-12);
}

TEST(ChiSquared, PValueIsFivePercentAtTheEndsOfTheBand) {
  const Band band = MeanChiSquaredBand(6, 20, 0.95);
  EXPECT_NEAR(MeanChiSquaredPValue(band.low, 6, 20), 0.05, 1e-9);
  EXPECT_NEAR(MeanChiSquaredPValue(band.high, 6, 20), 0.05, 1e-9);
  EXPECT_GT(MeanChiSquaredPValue(6.0, 6, 20), 0.9);
  EXPECT_EQ(MeanChiSquaredPValue(std::nan(""), 6, 20), 0.0);
}

TEST(ChiSquared, HolmStepsDownAndStopsAtTheFirstThatStands) {
  // Thresholds for four: 0.0125, 0.0167, 0.025, 0.05. The third smallest (0.03) stands, so that
  // the largest (0.04) does too, although it is below its own 0.05.
  EXPECT_EQ(HolmRejections({0.04, 0.01, 0.03, 0.005}, 0.05),
            (std::vector<bool>{false, true, false, true}));
  EXPECT_EQ(HolmRejections({0.049}, 0.05), std::vector<bool>{true});
  EXPECT_TRUE(HolmRejections({}, 0.05).empty());
}

TEST(TextTable, NumbersAreTheSameEverywhere) {
  EXPECT_EQ(Number(0.00674, 4), "0.0067");
  EXPECT_EQ(Number(-1e-9, 3), "0.000");
  EXPECT_EQ(Number(-0.5, 1), "-0.5");
  EXPECT_EQ(Number(10.0, 0), "10");
  EXPECT_EQ(Number(std::nan(""), 3), "-");
  EXPECT_EQ(Number(INFINITY, 3), "-");
}

TEST(TextTable, ColumnsAreAligned) {
  TextTable table({"", "msckf", "window"});
  table.AddSection("errors");
  table.AddRow({"  position [m]", "0.01", "12.3456"});
  table.AddRow({"  note", "", "x"});
  EXPECT_EQ(table.Text(),
            "                msckf   window\n"
            "------------------------------\n"
            "errors\n"
            "  position [m]   0.01  12.3456\n"
            "  note                       x\n");
}

}  // namespace
}  // namespace duet
