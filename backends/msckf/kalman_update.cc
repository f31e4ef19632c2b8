#include "backends/msckf/kalman_update.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "common/support/logging.h"

namespace duet {

namespace {

/// The lower triangle of H M. Of an upper triangular H only what is not zero takes part.
void LowerTriangleOfProduct(const Eigen::Ref<const Eigen::MatrixXd>& H, const Eigen::MatrixXd& M,
                            MeasurementShape shape, Eigen::MatrixXd* S) {
  const auto rows = H.rows();
  S->resize(rows, rows);
  if (shape == MeasurementShape::kFull) {
    S->triangularView<Eigen::Lower>() = H * M;
    return;
  }
  constexpr Eigen::Index kBlock = 32;
  for (Eigen::Index first = 0; first < rows; first += kBlock) {
    const auto count = std::min(kBlock, rows - first);
    const auto H_block = H.block(first, first, count, H.cols() - first);
    const auto M_block = M.bottomRows(H.cols() - first);
    S->block(first, 0, count, first + count).noalias() = H_block * M_block.leftCols(first + count);
  }
}

}  // namespace

bool KalmanUpdate(const Eigen::Ref<const Eigen::MatrixXd>& H_r, std::span<const int> columns,
                  Eigen::Ref<Eigen::MatrixXd> P, Eigen::Ref<Eigen::VectorXd> dx,
                  KalmanWorkspace* workspace, MeasurementShape shape) {
  const auto width = static_cast<Eigen::Index>(columns.size());
  CHECK_EQ(H_r.cols(), width + 1);
  const auto H = H_r.leftCols(width);
  KalmanWorkspace& w = *workspace;
  w.P_columns.resize(P.rows(), width);
  for (Eigen::Index j = 0; j < width; ++j) w.P_columns.col(j) = P.col(columns[j]);
  w.P_H.resize(P.rows(), H_r.rows());
  if (shape == MeasurementShape::kUpperTriangular) {
    w.P_H.noalias() = w.P_columns * H.triangularView<Eigen::Upper>().transpose();
  } else {
    w.P_H.noalias() = w.P_columns * H.transpose();
  }
  return KalmanUpdateOfKnownProduct(H_r, columns, P, dx, workspace, shape);
}

bool KalmanUpdateOfKnownProduct(const Eigen::Ref<const Eigen::MatrixXd>& H_r,
                                std::span<const int> columns, Eigen::Ref<Eigen::MatrixXd> P,
                                Eigen::Ref<Eigen::VectorXd> dx, KalmanWorkspace* workspace,
                                MeasurementShape shape) {
  const auto width = static_cast<Eigen::Index>(columns.size());
  CHECK_EQ(H_r.cols(), width + 1);
  const auto rows = H_r.rows();
  KalmanWorkspace& w = *workspace;
  CHECK_EQ(w.P_H.rows(), P.rows());
  CHECK_EQ(w.P_H.cols(), rows);
  w.measured.resize(width, rows);
  for (Eigen::Index j = 0; j < width; ++j) w.measured.row(j) = w.P_H.row(columns[j]);
  // Only the lower triangle of S is needed.
  LowerTriangleOfProduct(H_r.leftCols(width), w.measured, shape, &w.S);
  w.S.diagonal().array() += 1.0;

  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(w.S);
  if (llt.info() != Eigen::Success) return false;
  llt.matrixU().solveInPlace<Eigen::OnTheRight>(w.P_H);  // P H' L'^-1
  w.y = H_r.col(width);
  llt.matrixL().solveInPlace(w.y);
  dx.noalias() = w.P_H * w.y;
  P.selfadjointView<Eigen::Lower>().rankUpdate(w.P_H, -1.0);
  P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
  return true;
}

}  // namespace duet
