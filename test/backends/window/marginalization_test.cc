#include "backends/window/marginalization.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numeric>
#include <vector>

#include "common/support/random.h"

namespace duet {
namespace {

// A quadratic from `rows` random residuals, components of very different units.
InformationForm RandomForm(int size, int rows, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd J(rows, size);
  Eigen::VectorXd r(rows);
  for (int i = 0; i < rows; ++i) {
    r[i] = random.Normal();
    for (int j = 0; j < size; ++j) J(i, j) = random.Normal() * (j % 3 == 0 ? 1e4 : 1.0);
  }
  return {J.transpose() * J, J.transpose() * r};
}

std::vector<int> Range(int first, int last) {
  std::vector<int> range(last - first);
  std::iota(range.begin(), range.end(), first);
  return range;
}

TEST(SchurComplement, MarginalizeThenSolveEqualsSolvingAll) {
  const InformationForm form = RandomForm(40, 80, 1);
  const Eigen::VectorXd all = -form.H.ldlt().solve(form.b);
  const InformationForm marginal = SchurComplement(form, Range(15, 40), Range(0, 15));
  const Eigen::VectorXd kept = -marginal.H.ldlt().solve(marginal.b);
  const Eigen::VectorXd scale = form.H.diagonal().cwiseSqrt().tail(25);
  // Condition number about 1e2 after scaling.
  EXPECT_LT((scale.asDiagonal() * (kept - all.tail(25))).norm(), 1e-11);
}

TEST(SchurComplement, InverseIsTheMarginalCovariance) {
  const InformationForm form = RandomForm(12, 30, 2);
  const std::vector<int> keep = {2, 3, 7, 9, 10};
  const std::vector<int> drop = {0, 1, 4, 5, 6, 8, 11};
  const Eigen::MatrixXd covariance = form.H.inverse();
  const Eigen::MatrixXd marginal = SchurComplement(form, keep, drop).H.inverse();
  const Eigen::MatrixXd expected = covariance(keep, keep);
  const Eigen::VectorXd sigma = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((sigma.asDiagonal() * (marginal - expected) * sigma.asDiagonal()).norm(), 1e-10);
}

TEST(SchurComplement, DropsDirectionsWithoutInformation) {
  // Component 0 and 1 are seen only in their sum, component 2 not at all.
  Eigen::MatrixXd J(3, 5);
  J << 1, 1, 0, 2, 0,  //
      0, 0, 0, 1, 1,   //
      1, 1, 0, 0, 3;
  const Eigen::Vector3d r(0.1, -0.2, 0.3);
  const InformationForm form{J.transpose() * J, J.transpose() * r};
  const InformationForm marginal =
      SchurComplement(form, std::vector<int>{3, 4}, std::vector<int>{0, 1, 2});
  // By hand: eliminating s = x0 + x1 from (s + 2a, s + 3b) leaves (2a - 3b) / sqrt(2).
  Eigen::MatrixXd K(2, 2);
  K << 1, 1, 2 / std::sqrt(2.0), -3 / std::sqrt(2.0);
  const Eigen::Vector2d e(-0.2, (0.1 - 0.3) / std::sqrt(2.0));
  EXPECT_LT((marginal.H - K.transpose() * K).norm(), 1e-13);
  EXPECT_LT((marginal.b - K.transpose() * e).norm(), 1e-13);
}

TEST(TakeSquareRoot, GivesBackTheQuadratic) {
  const InformationForm form = RandomForm(30, 60, 3);
  const SquareRootForm root = TakeSquareRoot(form);
  ASSERT_EQ(root.J.rows(), 30);
  const Eigen::VectorXd scale = form.H.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT(
      (scale.asDiagonal() * (root.J.transpose() * root.J - form.H) * scale.asDiagonal()).norm(),
      1e-13);
  EXPECT_LT(scale.cwiseProduct(root.J.transpose() * root.e - form.b).norm(), 1e-12);
}

TEST(TakeSquareRoot, HasTheRankOfTheQuadratic) {
  InformationForm form = RandomForm(30, 11, 4);  // 11 residuals
  form.H.row(5).setZero();
  form.H.col(5).setZero();
  form.b[5] = 0.0;
  const SquareRootForm root = TakeSquareRoot(form);
  EXPECT_EQ(root.J.rows(), 11);
  EXPECT_EQ(root.J.col(5).norm(), 0.0);
  const Eigen::VectorXd scale =
      (form.H.diagonal().array() > 0).select(form.H.diagonal().cwiseSqrt().cwiseInverse(), 0.0);
  EXPECT_LT(
      (scale.asDiagonal() * (root.J.transpose() * root.J - form.H) * scale.asDiagonal()).norm(),
      1e-12);
  EXPECT_LT(scale.cwiseProduct(root.J.transpose() * root.e - form.b).norm(), 1e-11);
}

TEST(Marginalization, ChainOfStatesEqualsBatchLeastSquares) {
  // A linear-Gaussian system x' = A x + w with measurements z = C x + n of every state: sliding a
  // window of two states through the production functions gives the batch's last estimate and
  // covariance.
  Random random(5);
  constexpr int kStates = 60;
  constexpr int n = 6;
  const Eigen::MatrixXd A =
      Eigen::MatrixXd::Identity(n, n) +
      0.1 * Eigen::MatrixXd::NullaryExpr(n, n, [&]() { return random.Normal(); });
  const Eigen::MatrixXd C = Eigen::MatrixXd::NullaryExpr(2, n, [&]() { return random.Normal(); });

  InformationForm batch{Eigen::MatrixXd::Zero(n * kStates, n * kStates),
                        Eigen::VectorXd::Zero(n * kStates)};
  const auto add = [](int first, const Eigen::MatrixXd& J, const Eigen::VectorXd& r,
                      InformationForm* form) {
    form->H.block(first, first, J.cols(), J.cols()) += J.transpose() * J;
    form->b.segment(first, J.cols()) += J.transpose() * r;
  };
  SquareRootForm prior{Eigen::MatrixXd::Identity(n, n), Eigen::VectorXd::Zero(n)};
  add(0, prior.J, prior.e, &batch);
  Eigen::VectorXd window_mean;
  Eigen::MatrixXd window_covariance;
  for (int k = 0; k + 1 < kStates; ++k) {
    Eigen::MatrixXd J_motion(n, 2 * n);
    J_motion << -10.0 * A, 10.0 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd r_motion = random.NormalVector(n);
    const Eigen::VectorXd r_measured = random.NormalVector(2);
    add(n * k, J_motion, r_motion, &batch);
    add(n * (k + 1), C, r_measured, &batch);

    InformationForm window{Eigen::MatrixXd::Zero(2 * n, 2 * n), Eigen::VectorXd::Zero(2 * n)};
    add(0, prior.J, prior.e, &window);
    add(0, J_motion, r_motion, &window);
    add(n, C, r_measured, &window);
    const InformationForm marginal = SchurComplement(window, Range(n, 2 * n), Range(0, n));
    prior = TakeSquareRoot(marginal);
    window_mean = -marginal.H.ldlt().solve(marginal.b);
    window_covariance = marginal.H.inverse();
  }
  const Eigen::VectorXd batch_mean = -batch.H.ldlt().solve(batch.b);
  const Eigen::MatrixXd batch_covariance = batch.H.inverse();
  // Condition number of the batch's H: about 1e5; 60 steps of rounding.
  const double scale = batch_mean.norm();
  EXPECT_LT((window_mean - batch_mean.tail(n)).norm(), 1e-10 * scale);
  const Eigen::MatrixXd expected = batch_covariance.bottomRightCorner(n, n);
  EXPECT_LT((window_covariance - expected).norm(), 1e-10 * expected.norm());
}

}  // namespace
}  // namespace duet
