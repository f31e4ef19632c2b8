#pragma once

#include <Eigen/Core>
#include <cmath>

namespace duet::testing {

/// Central differences of `f` (error vector of size n -> vector) at zero, with Ridders' two-step
/// extrapolation: error O(h^4), so that h = 1e-3 leaves about 1e-11 of truncation and rounding of
/// smooth functions of order one.
template <class Function>
Eigen::MatrixXd NumericJacobian(Function&& f, int n, double h = 1e-3) {
  Eigen::MatrixXd J;
  for (int i = 0; i < n; ++i) {
    const auto difference = [&](double step) -> Eigen::VectorXd {
      Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
      x[i] = step;
      const Eigen::VectorXd plus = f(x);
      x[i] = -step;
      const Eigen::VectorXd minus = f(x);
      return (plus - minus) / (2.0 * step);
    };
    const Eigen::VectorXd column = (4.0 * difference(0.5 * h) - difference(h)) / 3.0;
    if (J.cols() == 0) J.resize(column.size(), n);
    J.col(i) = column;
  }
  return J;
}

/// Largest difference relative to the larger of the matrices' own scale and `floor`.
inline double RelativeDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                 double floor = 1e-9) {
  const double scale = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), floor});
  return (a - b).cwiseAbs().maxCoeff() / scale;
}

}  // namespace duet::testing
