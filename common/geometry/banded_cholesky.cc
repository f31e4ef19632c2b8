#include "common/geometry/banded_cholesky.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/support/logging.h"

namespace duet {

BandedCholesky::BandedCholesky(Eigen::MatrixXd lower) : factor_(std::move(lower)) {
  const Eigen::Index n = factor_.cols();
  const Eigen::Index width = factor_.rows() - 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index below = std::min(width, n - 1 - i);
    CHECK_GT(factor_(0, i), 0.0) << "not positive definite at row " << i;
    const double pivot = std::sqrt(factor_(0, i));
    factor_(0, i) = pivot;
    factor_.col(i).segment(1, below) /= pivot;
    for (Eigen::Index k = 1; k <= below; ++k) {
      factor_.col(i + k).head(below - k + 1) -=
          factor_(k, i) * factor_.col(i).segment(k, below - k + 1);
    }
  }
}

void BandedCholesky::SolveInPlace(Eigen::Ref<Eigen::MatrixXd> right) const {
  const Eigen::Index n = factor_.cols();
  const Eigen::Index width = factor_.rows() - 1;
  CHECK_EQ(right.rows(), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    right.row(i) /= factor_(0, i);
    for (Eigen::Index k = 1; k <= std::min(width, n - 1 - i); ++k) {
      right.row(i + k) -= factor_(k, i) * right.row(i);
    }
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    for (Eigen::Index k = 1; k <= std::min(width, n - 1 - i); ++k) {
      right.row(i) -= factor_(k, i) * right.row(i + k);
    }
    right.row(i) /= factor_(0, i);
  }
}

}  // namespace duet
