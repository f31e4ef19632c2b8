#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

namespace duet::test {

/// Jacobian of f: R^n -> R^m at x by central differences over six points: the error is
/// h^6 f^(7) / 140 + 3e-16 |f| / h, about 1e-13 for functions of size and scale 1 at h = 1e-2,
/// 1e-12 at 1e-3 (better for those with steeper high derivatives). Sizes are fixed where those of x
/// and f(x) are.
template <class Function, class Derived>
auto NumericJacobian(const Function& f, const Eigen::MatrixBase<Derived>& x, double h = 1e-3) {
  using Argument = typename Derived::PlainObject;
  using Value = std::decay_t<decltype(f(std::declval<const Argument&>()))>;
  constexpr std::array<double, 3> kWeights = {45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0};
  Eigen::Matrix<double, Value::RowsAtCompileTime, Argument::RowsAtCompileTime> J;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Argument moved = x;
    const auto difference = [&](double step) -> Value {
      moved[i] = x[i] + step;
      const Value above = f(moved);
      moved[i] = x[i] - step;
      return above - f(moved);
    };
    const Value column = (kWeights[0] * difference(h) + kWeights[1] * difference(2 * h) +
                          kWeights[2] * difference(3 * h)) /
                         h;
    if (i == 0) J.resize(column.size(), x.size());
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

}  // namespace duet::test
