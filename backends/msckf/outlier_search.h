#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "backends/msckf/gate.h"
#include "backends/msckf/nullspace.h"

namespace duet {

/// Which observations of a landmark that the gate refused contradict the others: data snooping
/// (Baarda 1968) on what the gate tests. With the residual's covariance S = A' H P H' A + I after
/// the projection A' of 6.23, W = A S^-1 A' is the weight of the 2m residuals before it, r' W r the
/// gate's distance, and for observation k (two rows)
///
///   T_k = (W r)_k' W_kk^-1 (W r)_k
///
/// is by how much the distance falls where k is left out; chi-squared with two degrees of freedom
/// where k is good. Leaving k out turns W into W - W_:k W_kk^-1 W_k:.
class OutlierSearch {
 public:
  /// `probability`: share of good observations whose T_k is within the bound.
  explicit OutlierSearch(double probability);

  /// Leaves out the observation of the largest T_k, as long as it is beyond the bound, until the
  /// rest passes `gate`. The distance of the rest where it does with at most `most` left out: their
  /// indices, ascending, are in `outliers`; else nothing. `H_f` is what ProjectNullspace left (m
  /// observations, 2m rows), `H` and `r` the 2m - 3 projected rows, P the covariance of what H's
  /// columns act on. `noise`: where the rows were divided by L (lower triangle) before the
  /// projection, L; then W = L^-T A S^-1 A' L^-1. Else null.
  [[nodiscard]] std::optional<double> Find(
      const Eigen::Ref<const LandmarkRows, 0, Eigen::OuterStride<>>& H_f,
      const Eigen::Ref<const MeasurementRows, 0, Eigen::OuterStride<>>& H,
      const Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>& r,
      const Eigen::Ref<const Eigen::MatrixXd>& P, const ChiSquaredGate& gate,
      const Eigen::MatrixXd* noise, int most, std::vector<int>* outliers);

 private:
  double bound_;
  Eigen::MatrixXd HP_;  // scratch
  Eigen::MatrixXd S_;
  Eigen::MatrixXd A_;  // transposed: (2m - 3) x 2m
  Eigen::MatrixXd W_;
  Eigen::VectorXd y_;
  Eigen::VectorXd W_r_;
  Eigen::Matrix<double, Eigen::Dynamic, 2> columns_;
  Eigen::Matrix<double, Eigen::Dynamic, 2> gain_;
};

}  // namespace duet
