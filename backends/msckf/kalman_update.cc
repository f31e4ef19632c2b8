#include "backends/msckf/kalman_update.h"

#include <Eigen/Cholesky>

#include "common/support/logging.h"

namespace duet {

bool KalmanUpdate(const Eigen::Ref<const Eigen::MatrixXd>& H_r, std::span<const int> columns,
                  Eigen::Ref<Eigen::MatrixXd> P, Eigen::Ref<Eigen::VectorXd> dx,
                  KalmanWorkspace* workspace, MeasurementShape shape) {
  const auto width = static_cast<Eigen::Index>(columns.size());
  CHECK_EQ(H_r.cols(), width + 1);
  const auto n = P.rows();
  const auto rows = H_r.rows();
  const auto H = H_r.leftCols(width);

  KalmanWorkspace& w = *workspace;
  w.P_columns.resize(n, width);
  for (Eigen::Index j = 0; j < width; ++j) w.P_columns.col(j) = P.col(columns[j]);
  w.P_H.resize(n, rows);
  const bool triangular = shape == MeasurementShape::kUpperTriangular;
  if (triangular) {
    w.P_H.noalias() = w.P_columns * H.triangularView<Eigen::Upper>().transpose();
  } else {
    w.P_H.noalias() = w.P_columns * H.transpose();
  }
  w.measured.resize(width, rows);
  for (Eigen::Index j = 0; j < width; ++j) w.measured.row(j) = w.P_H.row(columns[j]);
  w.S.resize(rows, rows);
  // Only the lower triangle of S is needed.
  w.S.triangularView<Eigen::Lower>() = H * w.measured;
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
