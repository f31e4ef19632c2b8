#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/measurement/calibration.h"

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

/// Directions in which `covariance` (of the calibration) is still more than `least_ratio` of the
/// prior's standard deviation: a basis of the span of those eigenvectors of S^-1 P S^-1,
/// S = diag(sigmas), whose eigenvalues exceed least_ratio^2. The basis is chosen to be read:
/// the reduced echelon form by complete pivoting, which has a single component where that lies in
/// the span.
[[nodiscard]] std::vector<CalibrationDirection> WeakDirections(const Eigen::MatrixXd& covariance,
                                                               const Eigen::VectorXd& sigmas,
                                                               double least_ratio);

/// "T_a.11 + 0.4 cam0.fx - t_d".
[[nodiscard]] std::string DirectionText(const CalibrationDirection& direction,
                                        const std::vector<std::string>& names);

}  // namespace duet
