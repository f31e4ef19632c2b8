#include "evaluation/allan.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/support/logging.h"

namespace duet {
namespace {

constexpr double kFlat = 2.0 * 0.69314718055994530942 / std::numbers::pi;  // 2 ln 2 / pi
constexpr double kPointsPerDecade = 12.0;
constexpr std::size_t kFewestStretches = 9;
constexpr std::size_t kStartsPerStretch = 64;
constexpr double kModelError = 0.02;

using Eigen::Vector3d;

// What a unit of N^2, B^2 and K^2 adds to the variance.
Vector3d BasisAt(double tau_s) { return {1.0 / tau_s, kFlat, tau_s / 3.0}; }

std::vector<std::size_t> Stretches(std::size_t samples) {
  std::vector<std::size_t> lengths;
  const std::size_t longest = samples / kFewestStretches;
  for (int i = 0;; ++i) {
    const auto length =
        static_cast<std::size_t>(std::llround(std::pow(10.0, i / kPointsPerDecade)));
    if (length > longest) return lengths;
    if (lengths.empty() || length > lengths.back()) lengths.push_back(length);
  }
}

// Relative variance of each point's sigma^2, and with it the weight of its share of an octave.
struct Row {
  Vector3d basis;
  double variance;  // sigma^2(tau)
  double weight;
};

std::vector<Row> RowsOf(const std::vector<AllanPoint>& curve) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, curve.size() - 1);
    const double octaves =
        std::log2(curve[after].tau_s / curve[before].tau_s) / static_cast<double>(after - before);
    rows.push_back(
        {BasisAt(curve[i].tau_s), curve[i].deviation * curve[i].deviation,
         std::min(1.0, octaves) / (2.0 / curve[i].clusters + kModelError * kModelError)});
  }
  return rows;
}

struct Solution {
  Vector3d squares = Vector3d::Zero();    // N^2, B^2, K^2
  Vector3d variances = Vector3d::Zero();  // of them; of those at 0 were they free alone
};

// Least squares of (basis . x - variance) / mean with x >= 0: of the seven sets of noises that may
// be there, the best whose solution is positive.
Solution NonNegative(const std::vector<Row>& rows, const std::vector<double>& means) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double weight = rows[i].weight / (means[i] * means[i]);
    H += weight * rows[i].basis * rows[i].basis.transpose();
    b += weight * rows[i].basis * rows[i].variance;
  }
  Solution best;
  double best_gain = 0.0;
  for (unsigned set = 1; set < 8; ++set) {
    std::vector<int> free;
    for (int k = 0; k < 3; ++k) {
      if ((set >> k) & 1U) free.push_back(k);
    }
    // Scaled to a unit diagonal: the three differ by many orders of magnitude.
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd H_free(n, n);
    Eigen::VectorXd b_free(n);
    Eigen::VectorXd scale(n);
    for (Eigen::Index i = 0; i < n; ++i) scale[i] = 1.0 / std::sqrt(H(free[i], free[i]));
    for (Eigen::Index i = 0; i < n; ++i) {
      b_free[i] = scale[i] * b[free[i]];
      for (Eigen::Index j = 0; j < n; ++j) {
        H_free(i, j) = scale[i] * scale[j] * H(free[i], free[j]);
      }
    }
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(H_free);
    const Eigen::VectorXd x = ldlt.solve(b_free);
    const double gain = b_free.dot(x);
    if (x.minCoeff() < 0.0 || gain <= best_gain) continue;
    best_gain = gain;
    const Eigen::MatrixXd covariance = ldlt.solve(Eigen::MatrixXd::Identity(n, n));
    best.squares.setZero();
    best.variances = H.diagonal().cwiseInverse();
    for (Eigen::Index i = 0; i < n; ++i) {
      best.squares[free[i]] = scale[i] * x[i];
      best.variances[free[i]] = scale[i] * scale[i] * covariance(i, i);
    }
  }
  return best;
}

NoiseEstimate RootOf(double square, double variance) {
  const double sigma = std::sqrt(variance);
  if (square <= 0.0) return {0.0, std::sqrt(sigma)};
  return {std::sqrt(square), 0.5 * sigma / std::sqrt(square)};
}

}  // namespace

std::vector<AllanPoint> AllanDeviation(std::span<const double> signal, double rate_hz) {
  CHECK_GT(rate_hz, 0.0);
  const std::size_t n = signal.size();
  if (n < 20) return {};
  double mean = 0.0;
  for (const double value : signal) mean += value / static_cast<double>(n);
  // Running sum about the mean, which the second difference does not see: gravity keeps its digits.
  std::vector<double> sums(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) sums[i + 1] = sums[i] + (signal[i] - mean);
  std::vector<AllanPoint> curve;
  for (const std::size_t m : Stretches(n)) {
    const std::size_t stride = std::max<std::size_t>(1, m / kStartsPerStretch);
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t k = 0; k + 2 * m <= n; k += stride) {
      const double difference = sums[k + 2 * m] - 2.0 * sums[k + m] + sums[k];
      squares += difference * difference;
      count += 1.0;
    }
    const double length = static_cast<double>(m);
    curve.push_back({.tau_s = length / rate_hz,
                     .deviation = std::sqrt(squares / (2.0 * count)) / length,
                     .clusters = static_cast<double>(n) / length - 1.0});
  }
  return curve;
}

double AllanFit::Deviation(double tau_s) const {
  const Vector3d squares(white.value * white.value, instability.value * instability.value,
                         walk.value * walk.value);
  return std::sqrt(squares.dot(BasisAt(tau_s)));
}

AllanFit FitAllan(const std::vector<AllanPoint>& curve) {
  AllanFit fit;
  if (curve.size() < 4) return fit;
  const auto lowest = std::min_element(
      curve.begin(), curve.end(),
      [](const AllanPoint& a, const AllanPoint& b) { return a.deviation < b.deviation; });
  fit.lowest_deviation = lowest->deviation;
  fit.lowest_tau_s = lowest->tau_s;
  if (lowest->deviation <= 0.0) return fit;

  const std::vector<Row> rows = RowsOf(curve);
  std::vector<double> means;
  means.reserve(rows.size());
  for (const Row& row : rows) means.push_back(row.variance);
  Solution solution;
  constexpr int kRounds = 200;
  for (int round = 0; round < kRounds; ++round) {
    const Vector3d previous = solution.squares;
    solution = NonNegative(rows, means);
    double change = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      means[i] = rows[i].basis.dot(solution.squares);
      change = std::max(change, std::abs(rows[i].basis.dot(previous) / means[i] - 1.0));
    }
    if (change < 1e-10) break;
  }
  fit.white = RootOf(solution.squares[0], solution.variances[0]);
  fit.instability = RootOf(solution.squares[1], solution.variances[1]);
  fit.walk = RootOf(solution.squares[2], solution.variances[2]);
  double squares = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double relative = rows[i].variance / means[i] - 1.0;
    squares += relative * relative / (2.0 / curve[i].clusters + kModelError * kModelError);
  }
  fit.misfit = std::sqrt(squares / static_cast<double>(rows.size()));
  return fit;
}

}  // namespace duet
