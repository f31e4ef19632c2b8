#include "backends/window/marginalization.h"

#include <cmath>
#include <numeric>
#include <vector>

namespace duet {
namespace {

/// S A S = P' L L' P with S = diag(scale): L is n x rank, lower trapezoidal; row i of L belongs to
/// component order[i] of A. (Eigen's LDLT pivots on the diagonal it was given, not on what is left
/// of it, and so reveals no rank.)
struct PivotedCholesky {
  Eigen::VectorXd scale;
  std::vector<int> order;
  Eigen::MatrixXd L;
};

PivotedCholesky Factorize(const Eigen::MatrixXd& A) {
  const int n = static_cast<int>(A.rows());
  PivotedCholesky f;
  f.scale.resize(n);
  for (int i = 0; i < n; ++i) f.scale[i] = A(i, i) > 0.0 ? 1.0 / std::sqrt(A(i, i)) : 0.0;
  Eigen::MatrixXd M = f.scale.asDiagonal() * A * f.scale.asDiagonal();
  f.order.resize(n);
  std::iota(f.order.begin(), f.order.end(), 0);

  int rank = 0;
  for (; rank < n; ++rank) {
    Eigen::Index offset = 0;
    if (M.diagonal().tail(n - rank).maxCoeff(&offset) <= kRankTolerance) break;
    const int pivot = rank + static_cast<int>(offset);
    if (pivot != rank) {
      std::swap(f.order[rank], f.order[pivot]);
      M.row(rank).swap(M.row(pivot));
      M.col(rank).swap(M.col(pivot));
    }
    const int below = n - rank - 1;
    M(rank, rank) = std::sqrt(M(rank, rank));
    auto column = M.col(rank).tail(below);
    column /= M(rank, rank);
    M.bottomRightCorner(below, below).noalias() -= column * column.transpose();
  }
  f.L = M.leftCols(rank).triangularView<Eigen::Lower>();
  return f;
}

}  // namespace

SquareRootForm TakeSquareRoot(const InformationForm& form) {
  const PivotedCholesky f = Factorize(form.H);
  const Eigen::Index n = form.H.rows();
  const Eigen::Index rank = f.L.cols();
  SquareRootForm root{Eigen::MatrixXd(rank, n), Eigen::VectorXd(rank)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const int component = f.order[i];
    if (f.scale[component] > 0.0) {
      root.J.col(component) = f.L.row(i).transpose() / f.scale[component];
    } else {
      root.J.col(component).setZero();
    }
  }
  // b = J'e has a solution; the first `rank` of its rows in pivot order fix it.
  for (Eigen::Index i = 0; i < rank; ++i) root.e[i] = f.scale[f.order[i]] * form.b[f.order[i]];
  f.L.topRows(rank).triangularView<Eigen::Lower>().solveInPlace(root.e);
  return root;
}

InformationForm SchurComplement(const InformationForm& form, std::span<const int> keep,
                                std::span<const int> drop) {
  const std::vector<int> k(keep.begin(), keep.end());
  const std::vector<int> d(drop.begin(), drop.end());
  InformationForm result{form.H(k, k), form.b(k)};
  if (d.empty()) return result;

  // With the first `rank` components of d in pivot order, H_dd^+ = S L^-T L^-1 S there and zero
  // elsewhere is a generalized inverse; H_dk lies in the range of H_dd, so any of them will do.
  const PivotedCholesky f = Factorize(form.H(d, d));
  const Eigen::Index rank = f.L.cols();
  const Eigen::Index n = static_cast<Eigen::Index>(k.size());
  Eigen::MatrixXd whitened(rank, n + 1);
  for (Eigen::Index i = 0; i < rank; ++i) {
    const int component = d[f.order[i]];
    const double scale = f.scale[f.order[i]];
    for (Eigen::Index j = 0; j < n; ++j) whitened(i, j) = scale * form.H(component, k[j]);
    whitened(i, n) = scale * form.b[component];
  }
  f.L.topRows(rank).triangularView<Eigen::Lower>().solveInPlace(whitened);
  result.H.noalias() -= whitened.leftCols(n).transpose() * whitened.leftCols(n);
  result.b.noalias() -= whitened.leftCols(n).transpose() * whitened.col(n);
  return result;
}

}  // namespace duet
