#pragma once

namespace duet {

/// The value that a chi-squared variable with `dof` degrees of freedom stays below with
/// probability `p`.
[[nodiscard]] double ChiSquaredQuantile(double p, double dof);

struct Band {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] bool Contains(double x) const { return low <= x && x <= high; }
};

/// Where the mean of `count` independent chi-squared variables with `dof` degrees of freedom each
/// lies with probability `confidence`, the same probability left out on either side.
[[nodiscard]] Band MeanChiSquaredBand(double dof, int count, double confidence);

/// The probability of a mean at least as far out, on either side, where the `count` variables
/// really are chi-squared: 2 min(P(below), P(above)), at most 1.
[[nodiscard]] double MeanChiSquaredPValue(double mean, double dof, int count);

}  // namespace duet
