#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace duet {

/// A direction of the calibration's error, in units of the priors' standard deviations.
struct CalibrationDirection {
  struct Term {
    int component;       ///< of the layout
    double coefficient;  ///< in prior sigmas; the largest one is 1
  };
  std::vector<Term> terms;  ///< largest first; those below kSmallestTerm are left out
  /// Standard deviation along it, as a share of the prior's.
  double ratio = 0.0;
};

/// Terms below this share of a direction's largest are not named.
inline constexpr double kSmallestTerm = 0.1;

/// The directions in which a covariance of the calibration is still more than a share of the
/// prior's: the span of those eigenvectors of S^-1 P S^-1, S = diag(prior sigmas), whose
/// eigenvalues exceed least_ratio^2.
class WeakSpace {
 public:
  WeakSpace(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& prior_sigmas,
            double least_ratio);

  [[nodiscard]] int dimension() const { return static_cast<int>(basis_.rows()); }

  /// A basis of it that is chosen to be read: the reduced echelon form by complete pivoting, which
  /// has a single component where that lies in the space.
  [[nodiscard]] std::vector<CalibrationDirection> Directions() const;

  /// The standard deviation that these directions alone leave to each component, as a share of its
  /// prior's.
  [[nodiscard]] Eigen::VectorXd ComponentRatios() const;

 private:
  Eigen::MatrixXd scaled_;       ///< S^-1 P S^-1
  Eigen::MatrixXd basis_;        ///< orthonormal rows
  Eigen::VectorXd eigenvalues_;  ///< of the rows
};

/// "T_a.11 + 0.4 cam0.fx - t_d".
[[nodiscard]] std::string DirectionText(const CalibrationDirection& direction,
                                        const std::vector<std::string>& names);

}  // namespace duet
