#include "backends/msckf/outlier_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "test/backends/msckf/random_state.h"

namespace duet {
namespace {

constexpr int kObservations = 9;
constexpr int kWidth = 12;
constexpr int kDegreesOfFreedom = 2 * kObservations - 3;

using test::Normal;

/// A landmark's whitened measurements [H | r] and H_f, r drawn from what H P H' + I says.
struct Problem {
  explicit Problem(std::uint64_t seed) {
    Random random(seed);
    H_f = 5.0 * Normal<LandmarkRows>(&random, 2 * kObservations, 3);
    rows = Normal<MeasurementRows>(&random, 2 * kObservations, kWidth + 1);  // r: its noise
    P = test::RandomCovariance(&random, kWidth);
    const Eigen::VectorXd x = Normal<Eigen::MatrixXd>(&random, kWidth, 1);
    const Eigen::MatrixXd L = P.llt().matrixL();
    rows.rightCols<1>() += rows.leftCols<kWidth>() * (L * x) + H_f * Eigen::Vector3d(1, 2, 3);
  }

  /// From here on the pixels' noise is not white: with covariance N, and drawn anew.
  void CorrelateNoise(std::uint64_t seed) {
    Random random(seed);
    N = test::RandomCovariance(&random, 2 * kObservations);
    N.diagonal().array() += 1.0;
    rows.rightCols<1>() +=
        N.llt().matrixL() * Normal<Eigen::VectorXd>(&random, 2 * kObservations, 1);
  }

  /// The gate's distance without the observations `left_out`, from scratch.
  [[nodiscard]] double Distance(const std::vector<int>& left_out) const {
    std::vector<int> kept;
    for (int k = 0; k < kObservations; ++k) {
      if (std::find(left_out.begin(), left_out.end(), k) != left_out.end()) continue;
      kept.insert(kept.end(), {2 * k, 2 * k + 1});
    }
    LandmarkRows H_f_kept = H_f(kept, Eigen::all);
    MeasurementRows rows_kept = rows(kept, Eigen::all);
    const Eigen::LLT<Eigen::MatrixXd> noise(N(kept, kept));
    noise.matrixL().solveInPlace(H_f_kept);
    noise.matrixL().solveInPlace(rows_kept);
    ProjectNullspace(H_f_kept, rows_kept);
    const Eigen::MatrixXd H = rows_kept.bottomRows(rows_kept.rows() - 3).leftCols<kWidth>();
    const Eigen::VectorXd r = rows_kept.bottomRows(rows_kept.rows() - 3).rightCols<1>();
    const Eigen::MatrixXd S = H * P * H.transpose() + Eigen::MatrixXd::Identity(r.size(), r.size());
    return r.dot(S.llt().solve(r));
  }

  std::optional<double> Find(int most, std::vector<int>* outliers) const {
    LandmarkRows reflected = H_f;
    MeasurementRows projected = rows;
    const Eigen::MatrixXd L = N.llt().matrixL();
    L.triangularView<Eigen::Lower>().solveInPlace(reflected);
    L.triangularView<Eigen::Lower>().solveInPlace(projected);
    ProjectNullspace(reflected, projected);
    const auto below = projected.bottomRows(kDegreesOfFreedom);
    return OutlierSearch(0.9999).Find(reflected, below.leftCols(kWidth), below.col(kWidth), P, gate,
                                      N.isIdentity(0.0) ? nullptr : &L, most, outliers);
  }

  LandmarkRows H_f;
  MeasurementRows rows;
  Eigen::MatrixXd P;
  Eigen::MatrixXd N = Eigen::MatrixXd::Identity(2 * kObservations, 2 * kObservations);
  ChiSquaredGate gate{0.95, 2 * kObservations};
};

TEST(OutlierSearch, FindsThePixelThatWasThrownOffAndTheDistanceOfTheRest) {
  int found_count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Problem problem(seed);
    // So far that it stands out from what the state's uncertainty explains.
    problem.rows(2 * 4 + 1, kWidth) += 100.0;
    const double rest = problem.Distance({4});
    if (rest > problem.gate.Threshold(kDegreesOfFreedom - 2)) continue;  // one in twenty
    ++found_count;
    std::vector<int> outliers;
    const std::optional<double> found = problem.Find(2, &outliers);
    ASSERT_TRUE(found) << seed;
    EXPECT_THAT(outliers, ::testing::ElementsAre(4)) << seed;
    // A difference of distances a thousand times as large.
    EXPECT_NEAR(*found, rest, 1e-10 * problem.Distance({})) << seed;
    EXPECT_FALSE(problem.Find(0, &outliers)) << "more than may be left out";
  }
  EXPECT_GE(found_count, 15);
}

// A pixel is one that noise of second order has mixed into the rows of the others.
TEST(OutlierSearch, FindsThePixelThroughNoiseThatIsNotWhite) {
  int found_count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Problem problem(seed);
    problem.CorrelateNoise(seed + 100);
    problem.rows(2 * 4 + 1, kWidth) += 300.0;
    const double rest = problem.Distance({4});
    if (rest > problem.gate.Threshold(kDegreesOfFreedom - 2)) continue;
    ++found_count;
    std::vector<int> outliers;
    const std::optional<double> found = problem.Find(2, &outliers);
    ASSERT_TRUE(found) << seed;
    EXPECT_THAT(outliers, ::testing::ElementsAre(4)) << seed;
    EXPECT_NEAR(*found, rest, 1e-9 * problem.Distance({})) << seed;
  }
  EXPECT_GE(found_count, 15);
}

// Two that stand against one landmark may draw a third with them, one at a time: what is left
// passes all the same, with the distance that it has by itself.
TEST(OutlierSearch, WhatIsLeftOfSeveralOutliersPasses) {
  int found_count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Problem problem(seed);
    problem.rows(2 * 4, kWidth) += 100.0;
    problem.rows(2 * 7 + 1, kWidth) -= 100.0;
    std::vector<int> outliers;
    const std::optional<double> found = problem.Find(4, &outliers);
    if (!found) continue;
    ++found_count;
    EXPECT_THAT(outliers, ::testing::IsSupersetOf({4, 7})) << seed;
    EXPECT_TRUE(std::is_sorted(outliers.begin(), outliers.end()));
    const int left = kDegreesOfFreedom - 2 * static_cast<int>(outliers.size());
    EXPECT_LE(*found, problem.gate.Threshold(left));
    EXPECT_NEAR(*found, problem.Distance(outliers), 1e-9 * problem.Distance({})) << seed;
  }
  EXPECT_GE(found_count, 15);
}

TEST(OutlierSearch, LeavesATrackAloneThatIsNoisyAllOver) {
  int taken_apart = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Problem problem(seed);
    // Just beyond the gate, and no pixel more than another.
    const double threshold = problem.gate.Threshold(kDegreesOfFreedom);
    problem.rows.rightCols<1>() *= std::sqrt(1.05 * threshold / problem.Distance({}));
    std::vector<int> outliers;
    if (problem.Find(2, &outliers)) ++taken_apart;
  }
  EXPECT_LE(taken_apart, 2);
}

}  // namespace
}  // namespace duet
