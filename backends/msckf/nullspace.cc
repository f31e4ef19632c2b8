#include "backends/msckf/nullspace.h"

#include <cmath>

#include "common/support/logging.h"

namespace duet {
namespace {

/// Column `j` of H_f below the diagonal becomes zero; it keeps the reflection v (v_j = 1 implied)
/// of I - beta v v'. Returns beta, 0 where there is nothing to do.
double Reflect(LandmarkRowsRef H_f, int j) {
  const auto below = H_f.rows() - j - 1;
  const double head = H_f(j, j);
  const double tail_norm2 = H_f.col(j).tail(below).squaredNorm();
  if (tail_norm2 == 0.0) return 0.0;
  const double norm = std::sqrt(head * head + tail_norm2);
  const double diagonal = head > 0.0 ? -norm : norm;
  H_f.col(j).tail(below) /= head - diagonal;
  H_f(j, j) = diagonal;
  const double beta = (diagonal - head) / diagonal;
  for (int k = j + 1; k < 3; ++k) {
    const double s = beta * (H_f(j, k) + H_f.col(j).tail(below).dot(H_f.col(k).tail(below)));
    H_f(j, k) -= s;
    H_f.col(k).tail(below) -= s * H_f.col(j).tail(below);
  }
  return beta;
}

/// I - beta v v', v = (1, tail of column j of H_f), on the columns [first, first + width) of
/// `rows`.
void Apply(const LandmarkRowsRef& H_f, int j, double beta, Eigen::Index first, Eigen::Index width,
           MeasurementRowsRef rows) {
  const auto m = rows.rows();
  // s = v' rows, kept in the row that the reflection uses up less beta s.
  auto head = rows.row(j).segment(first, width);
  for (Eigen::Index i = j + 1; i < m; ++i) head += H_f(i, j) * rows.row(i).segment(first, width);
  for (Eigen::Index i = j + 1; i < m; ++i) {
    rows.row(i).segment(first, width) -= (beta * H_f(i, j)) * head;
  }
}

}  // namespace

void ProjectNullspace(LandmarkRowsRef H_f, MeasurementRowsRef rows, int first_column,
                      int last_column) {
  CHECK_GT(H_f.rows(), 3);
  CHECK_EQ(H_f.rows(), rows.rows());
  const double beta[3] = {Reflect(H_f, 0), Reflect(H_f, 1), Reflect(H_f, 2)};
  for (int j = 0; j < 3; ++j) {
    if (beta[j] == 0.0) continue;
    Apply(H_f, j, beta[j], first_column, last_column - first_column, rows);
    Apply(H_f, j, beta[j], rows.cols() - 1, 1, rows);
  }
}

void ApplyProjection(const LandmarkRowsRef& H_f, MeasurementRowsRef rows) {
  CHECK_EQ(H_f.rows(), rows.rows());
  for (int j = 0; j < 3; ++j) {
    const double tail_norm2 = H_f.col(j).tail(H_f.rows() - j - 1).squaredNorm();
    if (tail_norm2 == 0.0) continue;
    Apply(H_f, j, 2.0 / (1.0 + tail_norm2), 0, rows.cols(), rows);
  }
}

void ProjectNullspace(LandmarkRowsRef H_f, MeasurementRowsRef rows) {
  ProjectNullspace(H_f, rows, 0, static_cast<int>(rows.cols()) - 1);
}

}  // namespace duet
