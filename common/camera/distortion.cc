#include "common/camera/distortion.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace duet {
namespace {

constexpr int kMaxDegree = 4;
constexpr int kMaxIterations = 50;
// Residual in d that counts as converged; the iterations go on to rounding while they improve.
constexpr double kConverged = 1e-10;

double Evaluate(std::span<const double> coefficients, double u) {
  double sum = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * u + *c;
  return sum;
}

// The sign change of the polynomial between low and high, to rounding.
double Bisect(std::span<const double> coefficients, double low, double high) {
  const bool positive = Evaluate(coefficients, low) > 0.0;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return low;
    ((Evaluate(coefficients, middle) > 0.0) == positive ? low : high) = middle;
  }
}

// The positive roots of c[0] + c[1] u + c[2] u^2, ascending; the number of them.
int PositiveQuadraticRoots(const double* c, double* roots) {
  double candidates[2];
  int count = 0;
  if (c[2] == 0.0) {
    if (c[1] != 0.0) candidates[count++] = -c[0] / c[1];
  } else {
    const double discriminant = c[1] * c[1] - 4.0 * c[2] * c[0];
    if (discriminant < 0.0) return 0;
    const double q = -0.5 * (c[1] + std::copysign(std::sqrt(discriminant), c[1]));
    candidates[count++] = q / c[2];
    if (q != 0.0) candidates[count++] = c[0] / q;
    if (count == 2 && candidates[0] > candidates[1]) std::swap(candidates[0], candidates[1]);
  }
  int positive = 0;
  for (int i = 0; i < count; ++i) {
    if (candidates[i] > 0.0) roots[positive++] = candidates[i];
  }
  return positive;
}

// The smallest u > 0 at which the polynomial c[0] + c[1] u + ... with c[0] > 0 reaches zero;
// infinity if nowhere. Between the zeros of its derivative a polynomial is monotone, so that its
// signs there bracket every root: from the quadratic derivative upwards, degree by degree.
double SmallestPositiveRoot(std::span<const double> c) {
  int top = static_cast<int>(c.size()) - 1;
  while (top > 0 && c[top] == 0.0) --top;
  if (std::all_of(c.begin(), c.end(), [](double x) { return x >= 0.0; })) {
    return std::numeric_limits<double>::infinity();
  }
  double largest = 0.0;
  for (int i = 0; i < top; ++i) largest = std::max(largest, std::abs(c[i] / c[top]));
  const double bound = 1.0 + largest;  // Cauchy's: every root lies within

  std::array<double, kMaxDegree> roots{};  // of the derivative one degree below
  int root_count = 0;
  for (int degree = std::min(top, 2); degree <= top; ++degree) {
    std::array<double, kMaxDegree + 1> derivative{};
    const int order = top - degree;
    for (int i = 0; i <= degree; ++i) {
      double factor = 1.0;
      for (int j = 1; j <= order; ++j) factor *= i + j;
      derivative[i] = factor * c[i + order];
    }
    if (degree <= 2) {
      root_count = PositiveQuadraticRoots(derivative.data(), roots.data());
      continue;
    }
    const std::span<const double> p(derivative.data(), degree + 1);
    std::array<double, kMaxDegree> found{};
    int found_count = 0;
    double low = 0.0;
    for (int i = 0; i <= root_count; ++i) {
      const double high = i < root_count ? roots[i] : bound;
      if ((Evaluate(p, low) > 0.0) != (Evaluate(p, high) > 0.0)) {
        found[found_count++] = Bisect(p, low, high);
      }
      low = high;
    }
    roots = found;
    root_count = found_count;
  }
  return root_count > 0 ? roots[0] : std::numeric_limits<double>::infinity();
}

}  // namespace

double RadialTangential::MaxRadius(const double* k) {
  // d/dr of r (1 + k1 r^2 + k2 r^4 + k3 r^6), in u = r^2.
  const std::array<double, 4> slope = {1.0, 3.0 * k[0], 5.0 * k[1], 7.0 * k[4]};
  return std::sqrt(SmallestPositiveRoot(slope));
}

bool RadialTangential::Undistort(const double* k, const Eigen::Vector2d& d, double max_radius,
                                 Eigen::Vector2d* x) {
  const double d_norm = d.norm();
  if (!std::isfinite(d_norm)) return false;
  const double inside = 0.9 * max_radius;
  Eigen::Vector2d best = d_norm <= inside ? d : Eigen::Vector2d(d * (inside / d_norm));
  Eigen::Vector2d distorted;
  Eigen::Matrix2d J;
  Distort(k, best, &distorted, &J, nullptr);
  Eigen::Vector2d residual = d - distorted;
  double error = residual.norm();
  for (int i = 0; i < kMaxIterations && error > 0.0; ++i) {
    const double determinant = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    if (!(determinant > 0.0)) return false;  // the fold of the branch
    Eigen::Vector2d step((J(1, 1) * residual.x() - J(0, 1) * residual.y()) / determinant,
                         (J(0, 0) * residual.y() - J(1, 0) * residual.x()) / determinant);
    // Halved until it stays on the branch and improves.
    bool improved = false;
    for (int halvings = 0; halvings < 30 && !improved; ++halvings, step *= 0.5) {
      const Eigen::Vector2d next = best + step;
      if (next.norm() > max_radius) continue;
      Eigen::Matrix2d J_next;
      Distort(k, next, &distorted, &J_next, nullptr);
      const double next_error = (d - distorted).norm();
      if (!(next_error < error)) {
        if (error <= kConverged) break;  // rounding
        continue;
      }
      improved = true;
      best = next;
      J = J_next;
      residual = d - distorted;
      error = next_error;
    }
    if (!improved) break;
  }
  if (error > kConverged || J.determinant() <= 0.0) return false;
  *x = best;
  return true;
}

double Equidistant::MaxRadius(const double* k) {
  // d/dtheta of theta P(theta^2), in w = theta^2.
  const std::array<double, 5> slope = {1.0, 3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]};
  const double theta = std::sqrt(SmallestPositiveRoot(slope));
  return theta < std::numbers::pi / 2.0 ? std::tan(theta) : std::numeric_limits<double>::infinity();
}

bool Equidistant::Undistort(const double* k, const Eigen::Vector2d& d, double max_radius,
                            Eigen::Vector2d* x) {
  const double theta_d = d.norm();
  if (!std::isfinite(theta_d)) return false;
  const std::array<double, 5> P = {1.0, k[0], k[1], k[2], k[3]};
  const std::array<double, 5> slope = {1.0, 3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]};
  // theta P(theta^2) grows from 0 to theta_max: Newton, kept in the bracket by bisection.
  double low = 0.0;
  double high = std::atan(max_radius);
  if (theta_d > high * Evaluate(P, high * high)) return false;
  double theta = std::min(theta_d, high);
  double residual = theta_d - theta * Evaluate(P, theta * theta);
  for (int i = 0; i < kMaxIterations; ++i) {
    (residual > 0.0 ? low : high) = theta;
    double next = theta + residual / Evaluate(slope, theta * theta);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double next_residual = theta_d - next * Evaluate(P, next * next);
    const bool done = std::abs(next_residual) >= std::abs(residual) && std::abs(residual) < 1e-14;
    if (done || next == theta) break;
    theta = next;
    residual = next_residual;
  }
  // At 90 degrees a direction has no z = 1.
  if (std::abs(residual) > kConverged || theta >= std::numbers::pi / 2.0) return false;
  *x = theta_d > 0.0 ? Eigen::Vector2d((std::tan(theta) / theta_d) * d) : d;
  return true;
}

}  // namespace duet
