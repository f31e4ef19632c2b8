#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "backends/msckf/nullspace.h"

namespace duet {

/// What the linearization of a landmark leaves out, as noise: the modified Gaussian second-order
/// filter (Jazwinski 1970, 9.3; Maybeck 1982, 12.3) for the one product that matters where a motion
/// hardly fixes depths.
///
/// A landmark's whitened pixels are r = H x + H_f f + s + n with the errors x of poses, velocities
/// and calibration and f of (alpha, beta, rho). H is all but linear in the inverse depth, so that
///
///   s = D x f_rho,   D = dH / drho = (H(rho) - H(0)) / rho   (2m x width)
///
/// f_rho follows x and n by least squares, f_rho = -(d x + g n) with g the third row of
/// (H_f' H_f)^-1 H_f' and d = g H. For Gaussian errors its variance is v = |g|^2 + d P d' and
///
///   Cov(s) = v D P D' + (D P d') (D P d')'
///
/// A pose that is off is off for every landmark of the window alike: these terms do not average out
/// over K landmarks but add up, and the noise of each is taken as I + K Cov(s). Where K v is less
/// than rho^2 all this is small beside what H P H' and the pixels' noise are, and left out.
/// Rows of one landmark are mixed, never added to: what is orthogonal to the unobservable
/// directions stays so.
class SecondOrderNoise {
 public:
  using ConstRows = Eigen::Ref<const MeasurementRows, 0, Eigen::OuterStride<>>;
  using ConstLandmarkRows = Eigen::Ref<const LandmarkRows, 0, Eigen::OuterStride<>>;
  using ConstMatrix = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  /// How a landmark's inverse depth follows the errors with covariance `P` (width x width). `H`
  /// (2m x width) and `H_f` are whitened, before the projection.
  void SetDepth(const ConstRows& H, const ConstLandmarkRows& H_f, const ConstMatrix& P);

  /// After SetDepth. Whether K landmarks of this sort have noise of second order worth its cost.
  [[nodiscard]] bool Matters(double rho, int K) const {
    return rho == 0.0 || K * variance_ >= rho * rho;
  }

  /// After SetDepth, with the same H and P, `H_at_infinity` of the landmark at rho = 0: factors
  /// the noise. False where it can't be.
  [[nodiscard]] bool SetDerivative(const ConstRows& H, const ConstRows& H_at_infinity, double rho,
                                   const ConstMatrix& P, int K);

  /// Of f_rho [1/m^2], after SetDepth.
  [[nodiscard]] double variance() const { return variance_; }
  /// L with L L' = I + K Cov(s), in the lower triangle, after SetDerivative: L^-1 makes the
  /// landmark's rows of unit variance.
  [[nodiscard]] const Eigen::MatrixXd& factor() const { return llt_.matrixLLT(); }

 private:
  double variance_ = 0.0;
  Eigen::RowVectorXd g_;
  Eigen::RowVectorXd d_;
  Eigen::VectorXd P_d_;
  MeasurementRows D_;
  Eigen::MatrixXd P_D_;
  Eigen::VectorXd D_P_d_;
  Eigen::MatrixXd covariance_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

}  // namespace duet
