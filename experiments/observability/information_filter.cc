#include "experiments/observability/information_filter.h"

#include <Eigen/Cholesky>

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

void InformationFilter::Propagate(const ImuFactorJacobians& J, const StandstillResidual* rest) {
  const Eigen::Index n = size();
  const Eigen::Index c = kFrameSize;
  // Frame i against (frame j in its place | calibration | landmarks), and i's own block.
  Matrix15d G = H_.topLeftCorner<kFrameSize, kFrameSize>();
  Eigen::MatrixXd B = H_.topLeftCorner(kFrameSize, n);
  G.noalias() += J.J_i.transpose() * J.J_i;
  B.leftCols<kFrameSize>().noalias() = J.J_i.transpose() * J.J_j;
  H_.block(0, 0, kFrameSize, n).setZero();
  H_.block(0, 0, n, kFrameSize).setZero();
  H_.topLeftCorner<kFrameSize, kFrameSize>().noalias() = J.J_j.transpose() * J.J_j;

  const std::vector<int>& imu_columns = layout_->imu_columns();
  if (!imu_columns.empty()) {
    const auto width = static_cast<Eigen::Index>(imu_columns.size());
    const Eigen::Matrix<double, kFrameSize, Eigen::Dynamic> J_c = J.J_T(Eigen::all, imu_columns);
    B.middleCols(c, width).noalias() += J.J_i.transpose() * J_c;
    H_.block(0, c, kFrameSize, width).noalias() += J.J_j.transpose() * J_c;
    H_.block(c, 0, width, kFrameSize).noalias() += J_c.transpose() * J.J_j;
    H_.block(c, c, width, width).noalias() += J_c.transpose() * J_c;
  }
  if (rest != nullptr) {
    const Eigen::Matrix<double, 6, 1> w = rest->sigma.cwiseInverse();
    const Eigen::Matrix<double, 6, 9> J_i = w.asDiagonal() * rest->J_i;
    const Eigen::Matrix<double, 6, 9> J_j = w.asDiagonal() * rest->J_j;
    G.topLeftCorner<9, 9>().noalias() += J_i.transpose() * J_i;
    B.topLeftCorner<9, 9>().noalias() += J_i.transpose() * J_j;
    H_.topLeftCorner<9, 9>().noalias() += J_j.transpose() * J_j;
  }

  // J_i of the IMU factor is invertible, and so is G; scaled to a unit diagonal.
  const Vector15d scale = G.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Matrix15d> llt(scale.asDiagonal() * G * scale.asDiagonal());
  CHECK(llt.info() == Eigen::Success) << "a frame's information is not positive definite";
  B = scale.asDiagonal() * B;
  llt.matrixL().solveInPlace(B);
  H_.topLeftCorner(n, n).noalias() -= B.transpose() * B;
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
