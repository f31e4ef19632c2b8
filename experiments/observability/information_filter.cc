#include "experiments/observability/information_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

#include "backends/window/normal_equations.h"
#include "backends/window/window_linearizer.h"
#include "backends/window/window_state.h"
#include "common/support/logging.h"

namespace duet {
namespace {

// H without the three components from `column` on, which are eliminated: H -= Y'Y with
// Y = L^-1 H_l; their own rows and columns are left as they come out. Only `size` of H count.
void EliminateLandmark(Eigen::Index column, Eigen::Index size, Eigen::MatrixXd* H,
                       Eigen::MatrixXd* scratch) {
  const Eigen::Matrix3d L_inverse = LandmarkInverseCholesky(H->block<3, 3>(column, column));
  scratch->noalias() = L_inverse * H->block(column, 0, 3, size);
  H->topLeftCorner(size, size).noalias() -= scratch->transpose() * *scratch;
}

}  // namespace

InformationFilter::InformationFilter(const CalibrationLayout& layout, const Eigen::MatrixXd& prior)
    : layout_(&layout), fixed_(kFrameSize + layout.size()), H_(prior) {
  CHECK_EQ(prior.rows(), fixed_);
  CHECK_EQ(prior.cols(), fixed_);
}

int InformationFilter::OpenLandmark() {
  const int slot = static_cast<int>(owner_.size());
  int landmark = static_cast<int>(slot_.size());
  if (free_.empty()) {
    slot_.push_back(slot);
  } else {
    landmark = free_.back();
    free_.pop_back();
    slot_[landmark] = slot;
  }
  owner_.push_back(landmark);
  if (H_.rows() < size()) {
    const Eigen::Index old = H_.rows();
    const Eigen::Index grown = old + std::max<Eigen::Index>(3, 3 * (old / 6));
    H_.conservativeResize(grown, grown);
    H_.rightCols(grown - old).setZero();
    H_.bottomRows(grown - old).setZero();
  }
  H_.middleRows<3>(Column(slot)).setZero();
  H_.middleCols<3>(Column(slot)).setZero();
  return landmark;
}

void InformationFilter::AddPixel(int landmark, const PixelJacobians& J) {
  const Eigen::Index l = Column(slot_[landmark]);
  const Eigen::Index c = kFrameSize;
  const Eigen::Index width = layout_->size();
  H_.block<9, 9>(0, 0).noalias() += J.state.transpose() * J.state;
  H_.block<3, 3>(l, l).noalias() += J.landmark.transpose() * J.landmark;
  const Eigen::Matrix<double, 3, 9> W = J.landmark.transpose() * J.state;
  H_.block<3, 9>(l, 0) += W;
  H_.block<9, 3>(0, l) += W.transpose();
  if (width == 0) return;
  const auto& J_c = J.calibration;
  H_.block(c, c, width, width).noalias() += J_c.transpose() * J_c;
  H_.block(0, c, 9, width).noalias() += J.state.transpose() * J_c;
  H_.block(c, 0, width, 9).noalias() += J_c.transpose() * J.state;
  H_.block(l, c, 3, width).noalias() += J.landmark.transpose() * J_c;
  H_.block(c, l, width, 3).noalias() += J_c.transpose() * J.landmark;
}

void InformationFilter::CloseLandmark(int landmark) {
  const int slot = slot_[landmark];
  CHECK_GE(slot, 0);
  EliminateLandmark(Column(slot), size(), &H_, &scratch_);
  // The last slot takes its place.
  const int last = static_cast<int>(owner_.size()) - 1;
  if (slot != last) {
    const Eigen::Index to = Column(slot);
    const Eigen::Index from = Column(last);
    const Eigen::Index n = size();
    H_.block(to, 0, 3, n) = H_.block(from, 0, 3, n);
    H_.block(0, to, n, 3) = H_.block(0, from, n, 3);
    H_.block<3, 3>(to, to) = H_.block<3, 3>(from, from).eval();
    owner_[slot] = owner_[last];
    slot_[owner_[slot]] = slot;
  }
  owner_.pop_back();
  slot_[landmark] = -1;
  free_.push_back(landmark);
}

// With the IMU's noise w (15, unit variance) in place of frame i,
//
//   J_i x_i + J_j x_j + J_c c = w   =>   x_i = M w + A x_j + B c,
//
// the information over (x_i, c, landmarks) becomes one over (w, x_j, c, landmarks), to which w adds
// the identity; w is eliminated. Adding J'J and eliminating x_i is the same on paper, but a
// difference of the IMU's information (1e9 and more) and itself, which drowns what little is known
// of a state that drifts.
void InformationFilter::Propagate(const ImuFactorJacobians& J, const StandstillResidual* rest) {
  const Eigen::Index n = size();
  const Eigen::Index c = kFrameSize;
  const std::vector<int>& imu_columns = layout_->imu_columns();
  const auto width = static_cast<Eigen::Index>(imu_columns.size());
  const Eigen::PartialPivLU<Matrix15d> lu(J.J_i);
  const Matrix15d M = lu.inverse();
  const Matrix15d A = -lu.solve(J.J_j);
  Eigen::Matrix<double, kFrameSize, Eigen::Dynamic> B(kFrameSize, width);
  if (width > 0) B = -lu.solve(J.J_T(Eigen::all, imu_columns));

  // x_j and c in place of x_i: first the columns, in frame i's rows and in all others, ...
  Eigen::MatrixXd frame_rows = H_.topLeftCorner(kFrameSize, n);
  const Matrix15d H_ii = frame_rows.leftCols<kFrameSize>();
  frame_rows.leftCols<kFrameSize>() = H_ii * A;
  frame_rows.middleCols(c, width).noalias() += H_ii * B;
  const Eigen::MatrixXd below = H_.block(c, 0, n - c, kFrameSize);
  H_.block(c, 0, n - c, kFrameSize).noalias() = below * A;
  H_.block(c, c, n - c, width).noalias() += below * B;
  // ... then the rows.
  H_.topLeftCorner(kFrameSize, n).noalias() = A.transpose() * frame_rows;
  H_.block(c, 0, width, n).noalias() += B.transpose() * frame_rows;

  Matrix15d G = Matrix15d::Identity() + M.transpose() * H_ii * M;
  Eigen::MatrixXd Y = M.transpose() * frame_rows;
  if (rest != nullptr) {
    const Eigen::Matrix<double, 6, 1> weight = rest->sigma.cwiseInverse();
    const Eigen::Matrix<double, 6, 9> J_rest = weight.asDiagonal() * rest->J_i;
    const Eigen::Matrix<double, 6, kFrameSize> J_w = J_rest * M.topRows<9>();
    Eigen::MatrixXd J_x = Eigen::MatrixXd::Zero(6, c + width);
    J_x.leftCols<kFrameSize>() = J_rest * A.topRows<9>();
    J_x.leftCols<9>() += weight.asDiagonal() * rest->J_j;
    J_x.rightCols(width) = J_rest * B.topRows<9>();
    G.noalias() += J_w.transpose() * J_w;
    Y.leftCols(c + width).noalias() += J_w.transpose() * J_x;
    H_.topLeftCorner(c + width, c + width).noalias() += J_x.transpose() * J_x;
  }
  const Eigen::LLT<Matrix15d> llt(G);
  CHECK(llt.info() == Eigen::Success) << "the information is not positive semidefinite";
  llt.matrixL().solveInPlace(Y);
  H_.topLeftCorner(n, n).noalias() -= Y.transpose() * Y;
}

Eigen::MatrixXd InformationFilter::Covariance() const {
  Eigen::MatrixXd H = H_.topLeftCorner(size(), size());
  Eigen::MatrixXd scratch;
  for (int slot = static_cast<int>(owner_.size()) - 1; slot >= 0; --slot) {
    EliminateLandmark(Column(slot), Column(slot + 1), &H, &scratch);
  }
  Eigen::MatrixXd rest = H.topLeftCorner(fixed_, fixed_);
  rest = (0.5 * (rest + rest.transpose())).eval();
  return NewestCovariance(rest, layout_->size());
}

}  // namespace duet
