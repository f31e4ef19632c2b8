#include "common/geometry/se3.h"

#include <cmath>

namespace duet {
namespace {

// Below this squared angle the two higher coefficients are summed as series; above it their closed
// forms lose at most two digits.
constexpr double kSquareSeriesBelow = 1.0;

// sum over k >= 2 of (-1)^k weight(k) x2^(k-2) / (2k + extra)!, to rounding for x2 < 1.
template <typename Weight>
double FactorialSeries(double x2, int extra, Weight weight) {
  double factorial = 1.0;
  for (int i = 2; i <= 4 + extra; ++i) factorial *= i;
  double power = 1.0;
  double sum = 0.0;
  for (int k = 2; k < 12; ++k) {
    sum += power * weight(k) / factorial;
    power *= -x2;
    factorial *= (2.0 * k + extra + 1.0) * (2.0 * k + extra + 2.0);
  }
  return sum;
}

// (x^2 + 2 cos x - 2) / (2 x^4) = 1/24 - x^2/720 + ...
double QuarticCoefficient(double x2) {
  if (x2 < kSquareSeriesBelow) return FactorialSeries(x2, 0, [](int) { return 1.0; });
  return (x2 + 2.0 * std::cos(std::sqrt(x2)) - 2.0) / (2.0 * x2 * x2);
}

// (2 x - 3 sin x + x cos x) / (2 x^5) = 1/120 - x^2/2520 + ...
double QuinticCoefficient(double x2) {
  if (x2 < kSquareSeriesBelow) return FactorialSeries(x2, 1, [](int k) { return k - 1.0; });
  const double x = std::sqrt(x2);
  return (2.0 * x - 3.0 * std::sin(x) + x * std::cos(x)) / (2.0 * x2 * x2 * x);
}

// (x - sin x) / x^3 = 1/6 - x^2/120 + ...
double CubicCoefficient(double x2) {
  if (x2 < kSquareSeriesBelow)
    return 1.0 / 6.0 - x2 * FactorialSeries(x2, 1, [](int) { return 1.0; });
  const double x = std::sqrt(x2);
  return (x - std::sin(x)) / (x2 * x);
}

}  // namespace

Pose ExpSe3(const Vector6d& theta_rho) {
  const Eigen::Vector3d theta = theta_rho.head<3>();
  return {ExpQuaternion(theta), LeftJacobian(theta) * theta_rho.tail<3>()};
}

Vector6d LogSe3(const Pose& T) {
  Vector6d theta_rho;
  theta_rho.head<3>() = Log(T.R);
  theta_rho.tail<3>() = LeftJacobianInverse(theta_rho.head<3>()) * T.p;
  return theta_rho;
}

Matrix6d LeftJacobianSe3(const Vector6d& theta_rho) {
  const Eigen::Vector3d theta = theta_rho.head<3>();
  const Eigen::Matrix3d P = Hat(theta);
  const Eigen::Matrix3d X = Hat(theta_rho.tail<3>());
  const double x2 = theta.squaredNorm();
  // Barfoot, "State Estimation for Robotics" (2017), 7.86b.
  const Eigen::Matrix3d PX = P * X;
  const Eigen::Matrix3d XP = X * P;
  const Eigen::Matrix3d PXP = PX * P;
  const Eigen::Matrix3d Q = 0.5 * X + CubicCoefficient(x2) * (PX + XP + PXP) +
                            QuarticCoefficient(x2) * (P * PX + XP * P - 3.0 * PXP) +
                            QuinticCoefficient(x2) * (PXP * P + P * PXP);
  const Eigen::Matrix3d J = LeftJacobian(theta);
  Matrix6d J6;
  J6.topLeftCorner<3, 3>() = J;
  J6.topRightCorner<3, 3>().setZero();
  J6.bottomLeftCorner<3, 3>() = Q;
  J6.bottomRightCorner<3, 3>() = J;
  return J6;
}

}  // namespace duet
