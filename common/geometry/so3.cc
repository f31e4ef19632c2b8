#include "common/geometry/so3.h"

#include <Eigen/SVD>
#include <cmath>

namespace duet {
namespace {

// Below this squared angle the closed forms have lost more digits (1e-16 / theta^2 of them) than
// the truncated series below, which is exact to rounding there.
constexpr double kSeriesBelow = 0.25;

// (1 - cos x) / x^2 of x2 = x^2, by the half angle, which does not cancel.
double OneMinusCosOverSquare(double x2) {
  if (x2 < 1e-8) return 0.5 - x2 / 24.0;
  const double half = 0.5 * std::sqrt(x2);
  const double sinc = std::sin(half) / half;
  return 0.5 * sinc * sinc;
}

// (x - sin x) / x^3.
double AngleMinusSinOverCube(double x2) {
  if (x2 < kSeriesBelow) {
    double sum = 1.0 / 1307674368000.0;  // 1 / 15!
    for (const double c : {6227020800.0, 39916800.0, 362880.0, 5040.0, 120.0, 6.0}) {
      sum = 1.0 / c - x2 * sum;
    }
    return sum;
  }
  const double x = std::sqrt(x2);
  return (x - std::sin(x)) / (x2 * x);
}

// (1 - (x/2) cot(x/2)) / x^2.
double OneMinusHalfCotOverSquare(double x2) {
  if (x2 < kSeriesBelow) {
    // |B_2k| / (2k)!, k = 1 ... 8 (Bernoulli numbers).
    double sum = 3617.0 / 10670622842880000.0;
    for (const double c : {1.0 / 74724249600.0, 691.0 / 1307674368000.0, 1.0 / 47900160.0,
                           1.0 / 1209600.0, 1.0 / 30240.0, 1.0 / 720.0, 1.0 / 12.0}) {
      sum = c + x2 * sum;
    }
    return sum;
  }
  const double half = 0.5 * std::sqrt(x2);
  return (1.0 - half * std::cos(half) / std::sin(half)) / x2;
}

// a I + b [v]x + c [v]x^2 with [v]x^2 = v v' - |v|^2 I.
Eigen::Matrix3d HatPolynomial(double a, double b, double c, const Eigen::Vector3d& v) {
  Eigen::Matrix3d M = (c * v) * v.transpose();
  M.diagonal().array() += a - c * v.squaredNorm();
  const Eigen::Vector3d w = b * v;
  M(0, 1) -= w.z();
  M(0, 2) += w.y();
  M(1, 0) += w.z();
  M(1, 2) -= w.x();
  M(2, 0) -= w.y();
  M(2, 1) += w.x();
  return M;
}

}  // namespace

Eigen::Matrix3d Hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d M;
  M << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return M;
}

Eigen::Quaterniond ExpQuaternion(const Eigen::Vector3d& theta) {
  const double x2 = theta.squaredNorm();
  Eigen::Quaterniond q;
  if (x2 < 1e-8) {
    q.w() = 1.0 - x2 / 8.0 + x2 * x2 / 384.0;
    q.vec() = (0.5 - x2 / 48.0) * theta;
  } else {
    const double x = std::sqrt(x2);
    q.w() = std::cos(0.5 * x);
    q.vec() = (std::sin(0.5 * x) / x) * theta;
  }
  return q;
}

Eigen::Matrix3d Exp(const Eigen::Vector3d& theta) {
  return ExpQuaternion(theta).toRotationMatrix();
}

Eigen::Vector3d Log(const Eigen::Quaterniond& q) {
  const Eigen::Vector3d v = q.vec();
  const double n = v.norm();
  const double w = std::abs(q.w());
  // One half turn has two rotation vectors; the same one for q and -q.
  double sign = q.w() < 0.0 ? -1.0 : 1.0;
  if (w == 0.0) {
    const double lead = v.x() != 0.0 ? v.x() : v.y() != 0.0 ? v.y() : v.z();
    sign = lead < 0.0 ? -1.0 : 1.0;
  }
  // atan2(n, w) / n = (1 - (n/w)^2 / 3 + ...) / w.
  const double scale = n < 1e-8 * w ? 2.0 / w : 2.0 * std::atan2(n, w) / n;
  return (sign * scale) * v;
}

Eigen::Vector3d Log(const Eigen::Matrix3d& R) { return Log(Eigen::Quaterniond(R)); }

Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& theta) {
  const double x2 = theta.squaredNorm();
  return HatPolynomial(1.0, OneMinusCosOverSquare(x2), AngleMinusSinOverCube(x2), theta);
}

Eigen::Matrix3d LeftJacobianInverse(const Eigen::Vector3d& theta) {
  return HatPolynomial(1.0, -0.5, OneMinusHalfCotOverSquare(theta.squaredNorm()), theta);
}

Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& theta) { return LeftJacobian(-theta); }

Eigen::Matrix3d RightJacobianInverse(const Eigen::Vector3d& theta) {
  return LeftJacobianInverse(-theta);
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  // The sign of the smallest singular value makes the product a rotation, not a reflection.
  if (U.determinant() * svd.matrixV().determinant() < 0.0) U.col(2) *= -1.0;
  return U * svd.matrixV().transpose();
}

}  // namespace duet
