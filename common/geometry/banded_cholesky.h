#pragma once

#include <Eigen/Core>

namespace duet {

/// Cholesky factor of a symmetric positive definite band matrix, in time n * bandwidth^2.
class BandedCholesky {
 public:
  /// `lower` holds the lower band by diagonals: lower(k, i) is the matrix's entry (i + k, i),
  /// k = 0 ... bandwidth; what lies beyond the matrix is ignored. CHECKs positive pivots.
  explicit BandedCholesky(Eigen::MatrixXd lower);

  /// Solves for every column of `right`, in place.
  void SolveInPlace(Eigen::Ref<Eigen::MatrixXd> right) const;

 private:
  Eigen::MatrixXd factor_;  ///< in the same form
};

}  // namespace duet
