#include "backends/msckf/second_order_noise.h"

#include <Eigen/LU>
#include <algorithm>

namespace duet {
namespace {

/// Of an inverse depth of which nothing is known [1/m^2]: nothing that a camera tracks for long is
/// nearer than a metre or so.
constexpr double kUnknownVariance = 1.0;

}  // namespace

void SecondOrderNoise::SetDepth(const ConstRows& H, const ConstLandmarkRows& H_f,
                                const ConstMatrix& P) {
  const Eigen::Matrix3d V = (H_f.transpose() * H_f).inverse();
  g_ = V.row(2) * H_f.transpose();
  d_.noalias() = g_ * H;
  P_d_.noalias() = P * d_.transpose();
  variance_ = V(2, 2) + d_.dot(P_d_);
}

bool SecondOrderNoise::SetDerivative(const ConstRows& H, const ConstRows& H_at_infinity, double rho,
                                     const ConstMatrix& P, int K) {
  D_ = (H - H_at_infinity) / rho;
  P_D_.noalias() = P * D_.transpose();
  D_P_d_.noalias() = D_ * P_d_;
  const double share = std::min(1.0, kUnknownVariance / variance_);
  covariance_.noalias() = D_ * P_D_;
  covariance_ *= K * share * variance_;
  covariance_.noalias() += (K * share) * D_P_d_ * D_P_d_.transpose();
  covariance_.diagonal().array() += 1.0;
  llt_.compute(covariance_);
  return llt_.info() == Eigen::Success;
}

}  // namespace duet
