#pragma once

#include <span>
#include <vector>

namespace duet {

/// The p-quantile (0 <= p <= 1) of `sorted` (ascending, not empty): linear between the order
/// statistics around rank h = (n - 1) p, counted from 0. This is definition 7 of Hyndman and Fan
/// ("Sample quantiles in statistical packages", 1996), the default of numpy and R; the median of an
/// even number of values is the mean of the middle two.
[[nodiscard]] double SortedQuantile(std::span<const double> sorted, double p);

/// What is told of a set of errors; the unit is that of the values. With `count` 0 every number is
/// NaN.
struct ErrorSummary {
  ErrorSummary();

  int count = 0;
  double rmse;  ///< sqrt(mean of squares)
  double mean;
  double min;
  double p5, p25, median, p75, p95, p99;  ///< by SortedQuantile
  double max;
};

[[nodiscard]] ErrorSummary Summarize(std::vector<double> values);

}  // namespace duet
