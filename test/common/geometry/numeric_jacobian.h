#pragma once

#include <Eigen/Core>
#include <array>

namespace duet {

/// Jacobian of f: R^n -> R^m at x by central differences over six points: the error is
/// h^6 f^(7) / 140 + 3e-16 |f| / h, about 1e-13 for functions of size and scale 1 at h = 1e-2
/// (1e-12 at 1e-3, for those with steeper high derivatives). f takes and gives fixed-size vectors.
template <int kRows, int kCols, typename Function>
Eigen::Matrix<double, kRows, kCols> NumericJacobian(const Function& f,
                                                    const Eigen::Matrix<double, kCols, 1>& x,
                                                    double h = 1e-2) {
  constexpr std::array<double, 3> kWeights = {45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0};
  Eigen::Matrix<double, kRows, kCols> J;
  for (int i = 0; i < kCols; ++i) {
    Eigen::Matrix<double, kRows, 1> sum = Eigen::Matrix<double, kRows, 1>::Zero();
    for (int k = 0; k < 3; ++k) {
      Eigen::Matrix<double, kCols, 1> above = x;
      Eigen::Matrix<double, kCols, 1> below = x;
      above[i] += (k + 1) * h;
      below[i] -= (k + 1) * h;
      sum += kWeights[k] * (f(above) - f(below));
    }
    J.col(i) = sum / h;
  }
  return J;
}

}  // namespace duet
