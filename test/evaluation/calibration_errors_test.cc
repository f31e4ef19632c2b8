// Errors of an estimated calibration over time and over runs, on cases worked out by hand.

#include "evaluation/calibration_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/support/random.h"

namespace duet {
namespace {

CalibrationPriors TimesEstimated() {
  CalibrationPriors priors;
  priors.t_d.estimated = priors.t_r.estimated = true;
  priors.t_d.sigma = 0.01;
  priors.t_r.sigma = 0.02;
  return priors;
}

// t_d and t_r of a rig without cameras.
RigCalibration Times(double t_d_s, double t_r_s) {
  RigCalibration rig;
  rig.t_d_s = t_d_s;
  rig.t_r_s = t_r_s;
  return rig;
}

Eigen::Matrix2d Diagonal(double sigma_t_d, double sigma_t_r) {
  return Eigen::Vector2d(sigma_t_d * sigma_t_d, sigma_t_r * sigma_t_r).asDiagonal();
}

CalibrationErrors Start() {
  const RigCalibration truth = Times(0.005, 0.02);
  return {CalibrationLayout(TimesEstimated(), truth), truth};
}

TEST(CalibrationErrors, KeepsASampleEveryIntervalAndTheNewest) {
  CalibrationErrors errors = Start();
  for (int i = 0; i <= 12; ++i) errors.Add(0.1 * i, Times(0, 0), Diagonal(1, 1));
  ASSERT_EQ(errors.samples().size(), 4u);  // 0, 0.5, 1.0 and the newest
  EXPECT_NEAR(errors.samples()[2].t_s, 1.0, 1e-12);
  EXPECT_NEAR(errors.samples()[3].t_s, 1.2, 1e-12);
}

TEST(CalibrationErrors, NormalizesByTheReportedCovariance) {
  CalibrationErrors errors = Start();
  errors.Add(0.0, Times(0.003, 0.021), Diagonal(1e-3, 2e-3));
  EXPECT_NEAR(errors.error()[0], 0.002, 1e-15);
  EXPECT_NEAR(errors.error()[1], -0.001, 1e-15);
  EXPECT_NEAR(errors.Nees().value(), 4.0 + 0.25, 1e-12);
  EXPECT_NEAR(errors.BlockNees(errors.layout().entries()[1]).value(), 0.25, 1e-12);
  errors.Add(1.0, Times(0, 0), Eigen::Matrix2d::Zero());
  EXPECT_FALSE(errors.Nees().has_value());
}

TEST(CalibrationErrors, ConvergesWhereTheErrorStaysSmall) {
  CalibrationErrors errors = Start();
  // t_d off by 5, 1, 5, 1, 1 ms: within a fifth of its prior (2 ms) for good from 3 s on.
  for (const double off_ms : {5.0, 1.0, 5.0, 1.0, 1.0}) {
    const double t_s = static_cast<double>(errors.samples().size());
    errors.Add(t_s, Times(0.005 + 1e-3 * off_ms, 0.02), Diagonal(1e-4, 1e-4));
  }
  EXPECT_NEAR(errors.ConvergenceTime(errors.layout().entries()[0]).value(), 3.0, 1e-12);
  EXPECT_NEAR(errors.ConvergenceTime(errors.layout().entries()[1]).value(), 0.0, 1e-12);
  errors.Add(9.0, Times(0.015, 0.02), Diagonal(1e-4, 1e-4));
  EXPECT_FALSE(errors.ConvergenceTime(errors.layout().entries()[0]).has_value());
}

TEST(CalibrationErrors, CountsWhatLeavesThePrior) {
  CalibrationErrors errors = Start();
  const RigCalibration told = Times(0.0, 0.0);
  errors.Add(0.0, Times(0.031, 0.0), Diagonal(1, 1));  // 3.1 sigma
  errors.Add(1.0, Times(0.029, 0.0), Diagonal(1, 1));
  EXPECT_NEAR(errors.ShareOutsidePrior(told, 3.0), 0.25, 1e-12);
  EXPECT_EQ(errors.CountOutsidePriorAtEnd(told, 3.0), 0);
  EXPECT_EQ(errors.CountOutsidePriorAtEnd(told, 2.8), 1);
}

// 200 runs whose errors have the reported covariance, then ones three times as large.
TEST(SummarizeCalibration, AcceptsWhatIsAsReportedAndRejectsWhatIsNot) {
  for (const double factor : {1.0, 3.0}) {
    Random random(11);
    std::vector<CalibrationErrors> runs;
    for (int i = 0; i < 200; ++i) {
      runs.push_back(Start());
      runs.back().Add(
          0.0,
          Times(0.005 - factor * 1e-3 * random.Normal(), 0.02 - factor * 2e-3 * random.Normal()),
          Diagonal(1e-3, 2e-3));
    }
    std::vector<const CalibrationErrors*> pointers;
    for (const CalibrationErrors& run : runs) pointers.push_back(&run);
    const std::vector<CalibrationBlockSummary> blocks =
        SummarizeCalibration(pointers, Eigen::Vector2d(2e-3, 2e-3));
    ASSERT_EQ(blocks.size(), 3u);
    EXPECT_EQ(blocks[0].name, "t_d");
    EXPECT_EQ(blocks[2].name, "calibration");
    EXPECT_EQ(blocks[2].dof, 2);
    for (const CalibrationBlockSummary& block : blocks) {
      EXPECT_EQ(block.rejected, factor != 1.0) << block.name << " at " << factor;
    }
    // 200 draws: a root mean square within 15 %, three standard deviations.
    EXPECT_NEAR(blocks[0].error_over_sigma, factor, 0.15 * factor);
    EXPECT_NEAR(blocks[0].error_over_predicted.value(), 0.5 * factor, 0.075 * factor);
    EXPECT_NEAR(blocks[1].rms_error, 2e-3 * factor, 3e-4 * factor);
    EXPECT_NEAR(blocks[1].rms_sigma, 2e-3, 1e-15);
  }
}

}  // namespace
}  // namespace duet
