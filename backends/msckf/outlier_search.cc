#include "backends/msckf/outlier_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/support/logging.h"

namespace duet {
namespace {

/// Below this share of its weight an observation is hardly checked by the others: no verdict.
constexpr double kLeastRedundancy = 1e-6;

/// A', the transpose of the last 2m - 3 columns of the product of the three reflections that
/// ProjectNullspace left in H_f.
void BasisOfNullspace(const Eigen::Ref<const LandmarkRows, 0, Eigen::OuterStride<>>& H_f,
                      Eigen::MatrixXd* A_transposed, Eigen::VectorXd* scratch) {
  const Eigen::Index rows = H_f.rows();
  Eigen::MatrixXd& A = *A_transposed;
  A.setZero(rows - 3, rows);
  A.rightCols(rows - 3).diagonal().setOnes();
  for (int j = 2; j >= 0; --j) {
    const auto tail = H_f.col(j).tail(rows - j - 1);
    const double norm2 = tail.squaredNorm();
    if (norm2 == 0.0) continue;
    const double beta = 2.0 / (1.0 + norm2);
    Eigen::VectorXd& s = *scratch;
    s = A.col(j);
    s.noalias() += A.rightCols(rows - j - 1) * tail;
    s *= beta;
    A.col(j) -= s;
    A.rightCols(rows - j - 1).noalias() -= s * tail.transpose();
  }
}

}  // namespace

OutlierSearch::OutlierSearch(double probability) : bound_(-2.0 * std::log1p(-probability)) {
  CHECK(probability > 0.0 && probability < 1.0);
}

std::optional<double> OutlierSearch::Find(
    const Eigen::Ref<const LandmarkRows, 0, Eigen::OuterStride<>>& H_f,
    const Eigen::Ref<const MeasurementRows, 0, Eigen::OuterStride<>>& H,
    const Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>& r,
    const Eigen::Ref<const Eigen::MatrixXd>& P, const ChiSquaredGate& gate,
    const Eigen::MatrixXd* noise, int most, std::vector<int>* outliers) {
  outliers->clear();
  HP_.noalias() = H * P;
  S_.noalias() = HP_ * H.transpose();
  S_.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(S_);
  if (llt.info() != Eigen::Success) return std::nullopt;
  BasisOfNullspace(H_f, &A_, &y_);
  if (noise != nullptr) noise->triangularView<Eigen::Lower>().solveInPlace<Eigen::OnTheRight>(A_);
  llt.matrixL().solveInPlace(A_);
  y_ = r;
  llt.matrixL().solveInPlace(y_);
  W_.noalias() = A_.transpose() * A_;
  W_r_.noalias() = A_.transpose() * y_;
  double distance = y_.squaredNorm();
  int degrees_of_freedom = static_cast<int>(r.size());

  const int count = static_cast<int>(H_f.rows() / 2);
  while (distance > gate.Threshold(degrees_of_freedom)) {
    int worst = -1;
    double worst_fall = bound_;
    for (int k = 0; k < count; ++k) {
      const Eigen::Matrix2d W_kk = W_.block<2, 2>(2 * k, 2 * k);
      if (!(W_kk.determinant() > kLeastRedundancy * kLeastRedundancy)) continue;
      const Eigen::Vector2d w_k = W_r_.segment<2>(2 * k);
      const double fall = w_k.dot(W_kk.inverse() * w_k);
      if (fall > worst_fall) {
        worst = k;
        worst_fall = fall;
      }
    }
    if (worst < 0 || static_cast<int>(outliers->size()) == most || degrees_of_freedom <= 3) {
      return std::nullopt;
    }
    columns_ = W_.middleCols<2>(2 * worst);
    const Eigen::Matrix2d inverse = columns_.middleRows<2>(2 * worst).inverse();
    gain_.noalias() = columns_ * inverse;
    const Eigen::Vector2d w = W_r_.segment<2>(2 * worst);
    W_r_.noalias() -= gain_ * w;
    W_.noalias() -= gain_ * columns_.transpose();
    // Rounding must not let it come again.
    W_.middleCols<2>(2 * worst).setZero();
    W_.middleRows<2>(2 * worst).setZero();
    distance -= worst_fall;
    degrees_of_freedom -= 2;
    outliers->push_back(worst);
  }
  std::sort(outliers->begin(), outliers->end());
  return distance;
}

}  // namespace duet
