// The linear algebra of the update: null-space projection, compression, gate, Kalman update.

#include "backends/msckf/kalman_update.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>
#include <numeric>

#include "backends/msckf/compression.h"
#include "backends/msckf/gate.h"
#include "backends/msckf/nullspace.h"
#include "test/backends/msckf/random_state.h"

namespace duet {
namespace {

using test::RandomCovariance;

Eigen::MatrixXd RandomMatrix(Random* random, Eigen::Index rows, Eigen::Index cols) {
  Eigen::MatrixXd M(rows, cols);
  for (Eigen::Index i = 0; i < M.size(); ++i) M(i) = random->Normal();
  return M;
}

// What a stack of unit noise says of x: H'H and H'r.
Eigen::MatrixXd Information(const Eigen::MatrixXd& H_r) {
  return H_r.leftCols(H_r.cols() - 1).transpose() * H_r;
}

// ... of x after a landmark with Jacobian H_f is marginalized: the Schur complement.
Eigen::MatrixXd MarginalInformation(const Eigen::MatrixXd& H_f, const Eigen::MatrixXd& H_r) {
  const Eigen::MatrixXd S =
      Eigen::MatrixXd::Identity(H_f.rows(), H_f.rows()) -
      H_f * (H_f.transpose() * H_f).ldlt().solve(Eigen::MatrixXd(H_f.transpose()));
  return H_r.leftCols(H_r.cols() - 1).transpose() * S * H_r;
}

TEST(Nullspace, LeavesWhatMarginalizingTheLandmarkLeaves) {
  Random random(1);
  for (const int rows : {4, 5, 8, 22, 60}) {
    const Eigen::MatrixXd H_f = RandomMatrix(&random, rows, 3);
    const Eigen::MatrixXd H_r = RandomMatrix(&random, rows, 13);
    LandmarkRows H_f_used = H_f;
    MeasurementRows projected = H_r;
    ProjectNullspace(H_f_used, projected);
    const Eigen::MatrixXd expected = MarginalInformation(H_f, H_r);
    EXPECT_LT((Information(projected.bottomRows(rows - 3)) - expected).norm(),
              1e-13 * H_r.squaredNorm())
        << rows;
  }
}

TEST(Nullspace, RemovesEveryErrorOfTheLandmarkFromTheResidual) {
  Random random(2);
  const Eigen::MatrixXd H_f = RandomMatrix(&random, 10, 3);
  MeasurementRows rows = MeasurementRows::Zero(10, 3);
  rows.col(2) = H_f * Eigen::Vector3d(1.0, -20.0, 300.0);
  LandmarkRows H_f_used = H_f;
  ProjectNullspace(H_f_used, rows);
  EXPECT_LT(rows.col(2).tail(7).norm(), 1e-12);  // of 1e3
}

TEST(Nullspace, TouchesOnlyTheColumnsItIsGiven) {
  Random random(3);
  const Eigen::MatrixXd H_f = RandomMatrix(&random, 10, 3);
  MeasurementRows rows = MeasurementRows::Zero(10, 12);
  rows.middleCols(4, 5) = RandomMatrix(&random, 10, 5);
  rows.col(11) = RandomMatrix(&random, 10, 1);
  MeasurementRows part = rows;
  LandmarkRows H_f_used = H_f;
  ProjectNullspace(H_f_used, rows);
  H_f_used = H_f;
  ProjectNullspace(H_f_used, part, 4, 9);
  EXPECT_TRUE(part == rows);
}

TEST(Compression, KeepsTheInformation) {
  Random random(4);
  for (const int rows : {3, 12, 13, 40, 300}) {
    const Eigen::MatrixXd stack = RandomMatrix(&random, rows, 13);
    Eigen::MatrixXd compressed = stack;
    const int left = Compress(compressed);
    EXPECT_EQ(left, std::min(rows, 12));
    EXPECT_LT((Information(compressed.topRows(left)) - Information(stack)).norm(),
              1e-13 * stack.squaredNorm());
    if (rows > 12) {
      EXPECT_TRUE(compressed.topLeftCorner(12, 12).isUpperTriangular(0.0));
    }
  }
}

TEST(Compression, ColumnsWithoutMeasurementsStayEmpty) {
  Random random(5);
  Eigen::MatrixXd stack = RandomMatrix(&random, 30, 9);
  stack.col(3).setZero();
  const Eigen::MatrixXd expected = Information(stack);
  const int left = Compress(stack);
  EXPECT_LT((Information(stack.topRows(left)) - expected).norm(), 1e-13 * expected.norm());
}

class KalmanUpdateTest : public ::testing::Test {
 protected:
  Random random_{6};
  Eigen::MatrixXd P_ = RandomCovariance(&random_, 30);
  std::vector<int> columns_ = {2, 3, 4, 10, 11, 20, 29};
  Eigen::MatrixXd H_r_ = RandomMatrix(&random_, 12, 8);
  KalmanWorkspace workspace_;

  [[nodiscard]] Eigen::MatrixXd DenseH(const Eigen::MatrixXd& H_r) const {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(H_r.rows(), 30);
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      H.col(columns_[j]) = H_r.col(static_cast<Eigen::Index>(j));
    }
    return H;
  }
};

TEST_F(KalmanUpdateTest, EqualsJosephsForm) {
  const Eigen::MatrixXd H = DenseH(H_r_);
  const Eigen::MatrixXd S = H * P_ * H.transpose() + Eigen::MatrixXd::Identity(12, 12);
  const Eigen::MatrixXd K = P_ * H.transpose() * S.inverse();
  const Eigen::MatrixXd I_KH = Eigen::MatrixXd::Identity(30, 30) - K * H;
  const Eigen::MatrixXd joseph = I_KH * P_ * I_KH.transpose() + K * K.transpose();

  Eigen::MatrixXd P = P_;
  Eigen::VectorXd dx(30);
  ASSERT_TRUE(KalmanUpdate(H_r_, columns_, P, dx, &workspace_));
  EXPECT_LT((P - joseph).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((dx - K * H_r_.rightCols<1>()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(P == P.transpose());
}

TEST_F(KalmanUpdateTest, ACompressedStackGivesTheSame) {
  Eigen::MatrixXd P = P_;
  Eigen::VectorXd dx(30);
  ASSERT_TRUE(KalmanUpdate(H_r_, columns_, P, dx, &workspace_));

  Eigen::MatrixXd stack = H_r_;
  const int left = Compress(stack);
  Eigen::MatrixXd P_compressed = P_;
  Eigen::VectorXd dx_compressed(30);
  ASSERT_TRUE(KalmanUpdate(stack.topRows(left), columns_, P_compressed, dx_compressed, &workspace_,
                           MeasurementShape::kUpperTriangular));
  EXPECT_LT((P - P_compressed).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((dx - dx_compressed).cwiseAbs().maxCoeff(), 1e-12);
}

// Wider than the blocks in which the product with a triangular H is taken.
TEST(KalmanUpdate, IsTheSameForAWideCompressedStack) {
  Random random(8);
  const Eigen::MatrixXd P = RandomCovariance(&random, 90);
  const Eigen::MatrixXd H_r = 0.1 * RandomMatrix(&random, 150, 76);
  std::vector<int> columns(75);
  std::iota(columns.begin(), columns.end(), 10);
  KalmanWorkspace workspace;
  Eigen::MatrixXd P_full = P;
  Eigen::VectorXd dx_full(90);
  ASSERT_TRUE(KalmanUpdate(H_r, columns, P_full, dx_full, &workspace));
  Eigen::MatrixXd stack = H_r;
  const int left = Compress(stack);
  Eigen::MatrixXd P_compressed = P;
  Eigen::VectorXd dx_compressed(90);
  ASSERT_TRUE(KalmanUpdate(stack.topRows(left), columns, P_compressed, dx_compressed, &workspace,
                           MeasurementShape::kUpperTriangular));
  EXPECT_LT((P_full - P_compressed).norm(), 1e-12 * P.norm());
  EXPECT_LT((dx_full - dx_compressed).norm(), 1e-12 * P.norm());
}

// H P goes through the projection as the rows do: A' (H P) = (A' H) P.
TEST(KalmanUpdate, TakesAProductThatWasProjectedWithItsRows) {
  Random random(9);
  const Eigen::MatrixXd P = RandomCovariance(&random, 20);
  const Eigen::MatrixXd H_f = RandomMatrix(&random, 16, 3);
  MeasurementRows rows = RandomMatrix(&random, 16, 13);
  std::vector<int> columns(12);
  std::iota(columns.begin(), columns.end(), 5);
  MeasurementRows product = rows.leftCols(12) * P.middleRows(5, 12);
  LandmarkRows H_f_used = H_f;
  ProjectNullspace(H_f_used, rows);
  ApplyProjection(H_f_used, product);
  const Eigen::MatrixXd H_r = rows.bottomRows(13);
  const Eigen::MatrixXd P_H = product.bottomRows(13).transpose();
  EXPECT_LT((P_H - P.middleCols(5, 12) * H_r.leftCols(12).transpose()).norm(), 1e-13 * P_H.norm());

  KalmanWorkspace workspace;
  Eigen::MatrixXd P_expected = P;
  Eigen::VectorXd dx_expected(20);
  ASSERT_TRUE(KalmanUpdate(H_r, columns, P_expected, dx_expected, &workspace));
  Eigen::MatrixXd P_known = P;
  Eigen::VectorXd dx_known(20);
  workspace.P_H = P_H;
  ASSERT_TRUE(KalmanUpdateOfKnownProduct(H_r, columns, P_known, dx_known, &workspace));
  EXPECT_LT((P_known - P_expected).norm(), 1e-12 * P.norm());
  EXPECT_LT((dx_known - dx_expected).norm(), 1e-12 * P.norm());
}

// Measurements a million times better than the prior: what is left of P is 1e-12 of it, and
// P - W W' still has eigenvalues that are positive to the rounding of P itself.
TEST_F(KalmanUpdateTest, StaysPositiveUnderPreciseMeasurements) {
  H_r_.leftCols(7) *= 1e6;
  Eigen::MatrixXd P = P_;
  Eigen::VectorXd dx(30);
  for (int repeat = 0; repeat < 20; ++repeat) {
    ASSERT_TRUE(KalmanUpdate(H_r_, columns_, P, dx, &workspace_));
  }
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P).eigenvalues().minCoeff(),
            -1e-14 * P_.norm());
}

TEST_F(KalmanUpdateTest, RefusesACovarianceThatIsNone) {
  Eigen::MatrixXd P = -P_;
  const Eigen::MatrixXd before = P;
  Eigen::VectorXd dx(30);
  EXPECT_FALSE(KalmanUpdate(100.0 * H_r_, columns_, P, dx, &workspace_));
  EXPECT_TRUE(P == before);
}

TEST(Gate, RefusesBeyondTheQuantileOfTheWholeResidual) {
  Random random(7);
  const int m = 6;
  const Eigen::MatrixXd H = RandomMatrix(&random, m, 9);
  const Eigen::MatrixXd P = RandomCovariance(&random, 9);
  const Eigen::MatrixXd S = H * P * H.transpose() + Eigen::MatrixXd::Identity(m, m);
  const Eigen::VectorXd direction = RandomMatrix(&random, m, 1);
  const double gamma = direction.dot(S.ldlt().solve(direction));
  ChiSquaredGate gate(0.95, 20);
  const double quantile =
      boost::math::quantile(boost::math::chi_squared_distribution<double>(m), 0.95);
  EXPECT_NEAR(gate.Threshold(m), quantile, 1e-12);
  EXPECT_TRUE(gate.Passes(H, Eigen::VectorXd(direction * std::sqrt(0.999 * quantile / gamma)), P));
  EXPECT_FALSE(gate.Passes(H, Eigen::VectorXd(direction * std::sqrt(1.001 * quantile / gamma)), P));
}

TEST(Gate, PassesItsShareOfGoodMeasurements) {
  Random random(8);
  ChiSquaredGate gate(0.9, 10);
  const Eigen::MatrixXd H = RandomMatrix(&random, 5, 7);
  const Eigen::MatrixXd P = RandomCovariance(&random, 7);
  const Eigen::MatrixXd L = P.llt().matrixL();
  int passed = 0;
  constexpr int kTrials = 4000;
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::VectorXd r = H * (L * RandomMatrix(&random, 7, 1)) + RandomMatrix(&random, 5, 1);
    passed += gate.Passes(H, r, P);
  }
  // 4 standard deviations of a binomial share: 4 sqrt(0.9 0.1 / 4000) = 0.019.
  EXPECT_NEAR(passed / static_cast<double>(kTrials), 0.9, 0.019);
}

}  // namespace
}  // namespace duet
