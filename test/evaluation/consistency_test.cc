#include "evaluation/consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "test/evaluation/test_trajectories.h"

namespace duet {
namespace {

std::size_t Index(NeesBlock block) { return static_cast<std::size_t>(block); }

/// A covariance of 15 with correlations everywhere and scales six decades apart.
Matrix15d SomeCovariance(Random* random) {
  Matrix15d A;
  for (int i = 0; i < 15; ++i) A.col(i) = random->NormalVector<15>();
  Vector15d scale = Vector15d::Constant(0.01);
  scale.segment<3>(3).setConstant(1.0);
  scale.segment<3>(9).setConstant(1e-6);
  return scale.asDiagonal() * (A * A.transpose() + Matrix15d::Identity()) * scale.asDiagonal();
}

TEST(Nees, ByHand) {
  const Eigen::Vector2d error(2.0, 3.0);
  const Eigen::Matrix2d diagonal = Eigen::Vector2d(4.0, 1.0).asDiagonal();
  EXPECT_NEAR(Nees(error, diagonal).value(), 1.0 + 9.0, 1e-12);
  Eigen::Matrix2d correlated;
  correlated << 2.0, 1.0, 1.0, 2.0;  // inverse: [2 -1; -1 2] / 3
  EXPECT_NEAR(Nees(error, correlated).value(), (8.0 - 12.0 + 18.0) / 3.0, 1e-12);
}

TEST(Nees, CovariancesThatAreNoneGiveNothing) {
  const Eigen::Vector2d error(1.0, 1.0);
  Eigen::Matrix2d P;
  P << 1.0, 2.0, 2.0, 1.0;
  EXPECT_FALSE(Nees(error, P));
  P << 1.0, 0.0, 0.0, 0.0;
  EXPECT_FALSE(Nees(error, P));
  P << 1.0, 0.0, 0.0, std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Nees(error, P));
}

TEST(Nees, UnitsDoNotMatter) {
  Random random(1);
  const Matrix15d P = SomeCovariance(&random);
  const Vector15d z = random.NormalVector<15>();
  const Vector15d error = P.llt().matrixL() * z;
  Vector15d units;
  for (int i = 0; i < 15; ++i) units[i] = std::pow(10.0, random.Uniform(-8.0, 8.0));
  const Matrix15d P_units = units.asDiagonal() * P * units.asDiagonal();
  EXPECT_NEAR(Nees(units.cwiseProduct(error), P_units).value(), Nees(error, P).value(), 1e-6);
}

TEST(Nees, RotationErrorsAreGlobal) {
  // An error of 0.1 rad about G's x axis, where G's x is known to 0.1 rad and the rest hardly:
  // 1 sigma, however B is turned. Taken in B, it would be along another axis.
  InertialState estimate;
  estimate.nav.R_GB = YawRotation(1.5);
  InertialState truth = estimate;
  truth.nav.R_GB = ExpQuaternion({0.1, 0, 0}) * estimate.nav.R_GB;
  Matrix15d P = Matrix15d::Identity();
  P(0, 0) = 0.01;
  const NeesSample sample = ComputeNees(5, truth, estimate, P);
  EXPECT_NEAR(sample.value[Index(NeesBlock::kOrientation)].value(), 1.0, 1e-12);
  EXPECT_NEAR(sample.value[Index(NeesBlock::kPose)].value(), 1.0, 1e-12);
  EXPECT_NEAR(sample.value[Index(NeesBlock::kPosition)].value(), 0.0, 1e-12);
}

TEST(Nees, BlocksAreMarginalsOfTheirPlaces) {
  Random random(2);
  const Matrix15d P = SomeCovariance(&random);
  const Vector15d error = P.llt().matrixL() * (0.1 * random.NormalVector<15>()).eval();
  InertialState estimate;
  estimate.nav.R_GB = RandomRotation(&random);
  // The estimator's covariance goes on with calibration: what follows is left out.
  Eigen::MatrixXd longer = Eigen::MatrixXd::Identity(20, 20);
  longer.topLeftCorner<15, 15>() = P;
  const NeesSample sample = ComputeNees(0, BoxPlus(estimate, error), estimate, longer);
  const auto expect = [&](NeesBlock block, int offset, int size) {
    const Eigen::VectorXd e = error.segment(offset, size);
    const double by_inverse = e.dot(P.block(offset, offset, size, size).inverse() * e);
    EXPECT_NEAR(sample.value[Index(block)].value(), by_inverse, 1e-6 * by_inverse)
        << NeesBlockName(block);
  };
  expect(NeesBlock::kPose, 0, 6);
  expect(NeesBlock::kOrientation, 0, 3);
  expect(NeesBlock::kPosition, 3, 3);
  expect(NeesBlock::kVelocity, 6, 3);
  expect(NeesBlock::kGyroBias, 9, 3);
  expect(NeesBlock::kAccelBias, 12, 3);
  expect(NeesBlock::kState, 0, 15);
}

TEST(Nees, UnknownTruthHasNoNees) {
  const NeesSample no_biases = ComputeNees(0, {}, {}, Matrix15d::Identity(), true, false);
  EXPECT_TRUE(no_biases.value[Index(NeesBlock::kVelocity)]);
  EXPECT_FALSE(no_biases.value[Index(NeesBlock::kGyroBias)]);
  EXPECT_FALSE(no_biases.value[Index(NeesBlock::kState)]);
  const NeesSample poses_only = ComputeNees(0, {}, {}, Matrix15d::Identity(), false, true);
  EXPECT_TRUE(poses_only.value[Index(NeesBlock::kPose)]);
  EXPECT_FALSE(poses_only.value[Index(NeesBlock::kVelocity)]);
  EXPECT_TRUE(poses_only.value[Index(NeesBlock::kAccelBias)]);
  EXPECT_FALSE(poses_only.value[Index(NeesBlock::kState)]);
}

/// Runs whose errors are drawn from P and judged by P / overconfidence.
std::vector<NeesRun> DrawnRuns(int count, double overconfidence, Random* random) {
  const Matrix15d P = SomeCovariance(random);
  const Matrix15d told = P / overconfidence;
  const Matrix15d L = P.llt().matrixL();
  std::vector<NeesRun> runs(static_cast<std::size_t>(count));
  for (NeesRun& run : runs) {
    run.start = kEpoch;
    InertialState estimate;
    for (int i = 0; i <= 60; ++i) {
      estimate.nav.R_GB = WalkPose(0.1 * i).R;
      const Vector15d error = 1e-3 * (L * random->NormalVector<15>());
      run.samples.push_back(
          ComputeNees(kEpoch + i * 100 * kMs, BoxPlus(estimate, error), estimate, 1e-6 * told));
    }
  }
  return runs;
}

TEST(Consistency, ErrorsDrawnFromTheCovarianceAreConsistent) {
  Random random(4);
  const ConsistencyReport report = SummarizeConsistency(DrawnRuns(100, 1.0, &random));
  EXPECT_EQ(report.runs, 100);
  EXPECT_EQ(report.not_computed, 0);
  ASSERT_EQ(report.blocks.size(), 7u);
  for (const BlockConsistency& block : report.blocks) {
    EXPECT_EQ(block.instants, 41);  // 2.0 to 6.0 s at 10 Hz
    EXPECT_TRUE(block.band.Contains(block.median_instant)) << NeesBlockName(block.block);
    // Here instants are independent: the mean of 4100 values scatters by sqrt(2 dof / 4100).
    EXPECT_NEAR(block.mean, block.dof, 4.0 * std::sqrt(2.0 * block.dof / 4100.0));
    EXPECT_NEAR(block.standard_error, std::sqrt(2.0 * block.dof / 4100.0),
                0.3 * std::sqrt(2.0 * block.dof / 4100.0));
    EXPECT_GT(block.instants_in_band, 0.8);  // expected 0.95 of 41
    EXPECT_FALSE(block.rejected);
  }
}

TEST(Consistency, OverconfidenceIsRejected) {
  Random random(6);
  const ConsistencyReport report = SummarizeConsistency(DrawnRuns(100, 2.0, &random));
  for (const BlockConsistency& block : report.blocks) {
    EXPECT_NEAR(block.mean, 2.0 * block.dof, 0.3 * block.dof);
    EXPECT_TRUE(block.rejected) << NeesBlockName(block.block);
  }
}

TEST(Consistency, FailedRunsAreCountedAndTheFirstSecondsAreNot) {
  const auto run_of = [](double value, bool failed) {
    NeesRun run{.start = 0, .failed = failed, .samples = {}};
    for (int i = 0; i < 40; ++i) {
      NeesSample sample;
      sample.timestamp = i * 100 * kMs;
      sample.value[Index(NeesBlock::kPose)] = i < 20 ? 1e9 : value;
      run.samples.push_back(sample);
    }
    return run;
  };
  std::vector<NeesRun> runs = {run_of(5.0, false), run_of(8.0, false), run_of(1e6, true)};
  runs[0].samples.pop_back();                                         // one instant less
  runs[1].samples[30].value[Index(NeesBlock::kPose)] = std::nullopt;  // not definite
  const ConsistencyReport report = SummarizeConsistency(runs);
  EXPECT_EQ(report.runs, 3);
  EXPECT_EQ(report.failed, 1);
  EXPECT_EQ(report.not_computed, 1);
  ASSERT_EQ(report.blocks.size(), 1u);
  EXPECT_EQ(report.blocks[0].runs, 2);
  EXPECT_EQ(report.blocks[0].instants, 18);
  EXPECT_DOUBLE_EQ(report.blocks[0].mean, 6.5);
  EXPECT_DOUBLE_EQ(report.blocks[0].median_instant, 6.5);
  EXPECT_DOUBLE_EQ(report.blocks[0].standard_error, 1.5);
  EXPECT_NE(ConsistencyText(report).find("3 runs, 1 failed, 1 values not computed"),
            std::string::npos);
  const std::vector<NeesOfRun> one = SummarizeNees(runs[1]);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].instants, 19);
  EXPECT_DOUBLE_EQ(one[0].mean, 8.0);
}

TEST(Consistency, NoRunsGiveNoBlocks) { EXPECT_TRUE(SummarizeConsistency({}).blocks.empty()); }

}  // namespace
}  // namespace duet
