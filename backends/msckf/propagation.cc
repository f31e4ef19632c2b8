#include "backends/msckf/propagation.h"

namespace duet {
namespace {

constexpr int kNav = 9;
constexpr int kInertial = 15;

}  // namespace

void PropagateCovariance(const Transition& transition, const CalibrationLayout& layout,
                         Eigen::Ref<Eigen::MatrixXd> P, PropagationWorkspace* workspace) {
  // F = the rows of (theta, p, v); the T matrices come first in the calibration.
  const std::vector<int>& imu_columns = layout.imu_columns();
  const int width = kInertial + static_cast<int>(imu_columns.size());
  auto& F = workspace->F;
  F.setZero(kNav, width);
  F.leftCols<kInertial>() = transition.Phi.topRows<kNav>();
  F.rightCols(width - kInertial) = transition.Gamma(Eigen::all, imu_columns);

  const auto n = P.rows();
  auto& F_P = workspace->F_P;
  F_P.resize(kNav, n);
  F_P.noalias() = F * P.topRows(width);
  Eigen::Matrix<double, kNav, kNav> corner;
  corner.noalias() = F_P.leftCols(width) * F.transpose();
  P.topLeftCorner<kNav, kNav>() =
      0.5 * (corner + corner.transpose()) + transition.Q.topLeftCorner<kNav, kNav>();
  P.topRightCorner(kNav, n - kNav) = F_P.rightCols(n - kNav);
  P.block<kNav, kInertial - kNav>(0, kNav) += transition.Q.topRightCorner<kNav, kInertial - kNav>();
  P.bottomLeftCorner(n - kNav, kNav) = P.topRightCorner(kNav, n - kNav).transpose();
  P.block<kInertial - kNav, kInertial - kNav>(kNav, kNav) +=
      transition.Q.bottomRightCorner<kInertial - kNav, kInertial - kNav>();
}

}  // namespace duet
