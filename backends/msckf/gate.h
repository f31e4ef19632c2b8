#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace duet {

/// The chi-squared test of thesis 6.24 to 6.26. Erratum: 6.25 leaves the measurement noise out of
/// the residual's covariance; here it is H P H' + I (rows are scaled to unit noise).
class ChiSquaredGate {
 public:
  /// Quantiles for 1 .. max_degrees_of_freedom, computed once. `probability` is the share of good
  /// measurements that pass (0.95 in the thesis).
  ChiSquaredGate(double probability, int max_degrees_of_freedom);

  [[nodiscard]] double Threshold(int degrees_of_freedom) const;

  /// True where r' (H P H' + I)^-1 r is within the quantile for as many degrees of freedom as r
  /// has. `H` and `r` are scaled to unit noise, P the covariance of what the columns of H act on.
  template <class DerivedH, class DerivedR, class DerivedP>
  [[nodiscard]] bool Passes(const Eigen::MatrixBase<DerivedH>& H,
                            const Eigen::MatrixBase<DerivedR>& r,
                            const Eigen::MatrixBase<DerivedP>& P) {
    if (PassesAtOnce(r)) return true;
    HP_.resize(r.size(), H.cols());
    HP_.noalias() = H * P;
    return PassesOfKnownProduct(HP_, H, r);
  }

  /// True where no covariance is needed: H P H' is positive semidefinite, so the squared norm of r
  /// is an upper bound.
  template <class DerivedR>
  [[nodiscard]] bool PassesAtOnce(const Eigen::MatrixBase<DerivedR>& r) const {
    return r.squaredNorm() <= Threshold(static_cast<int>(r.size()));
  }

  /// Passes of a given H P.
  template <class DerivedHP, class DerivedH, class DerivedR>
  [[nodiscard]] bool PassesOfKnownProduct(const Eigen::MatrixBase<DerivedHP>& HP,
                                          const Eigen::MatrixBase<DerivedH>& H,
                                          const Eigen::MatrixBase<DerivedR>& r) {
    S_.resize(r.size(), r.size());
    S_.noalias() = HP * H.transpose();
    S_.diagonal().array() += 1.0;
    return Distance(r) <= Threshold(static_cast<int>(r.size()));
  }

 private:
  /// r' S^-1 r; infinite where S is not positive definite.
  double Distance(const Eigen::Ref<const Eigen::VectorXd>& r);

  std::vector<double> thresholds_;
  Eigen::MatrixXd HP_;  // scratch
  Eigen::MatrixXd S_;   // scratch
  Eigen::VectorXd y_;   // scratch
};

}  // namespace duet
