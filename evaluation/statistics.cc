#include "evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/support/logging.h"

namespace duet {

double SortedQuantile(std::span<const double> sorted, double p) {
  CHECK(!sorted.empty());
  CHECK(p >= 0.0 && p <= 1.0) << p;
  const double h = static_cast<double>(sorted.size() - 1) * p;
  const auto below = static_cast<std::size_t>(std::floor(h));
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], h - std::floor(h));
}

ErrorSummary::ErrorSummary() {
  for (double* field : {&rmse, &mean, &min, &p5, &p25, &median, &p75, &p95, &p99, &max}) {
    *field = std::numeric_limits<double>::quiet_NaN();
  }
}

ErrorSummary Summarize(std::vector<double> values) {
  ErrorSummary summary;
  if (values.empty()) return summary;
  // Sorted before summing: the result does not depend on the order of the values.
  std::sort(values.begin(), values.end());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  summary.count = static_cast<int>(values.size());
  summary.rmse = std::sqrt(sum_of_squares / n);
  summary.mean = sum / n;
  summary.min = values.front();
  summary.p5 = SortedQuantile(values, 0.05);
  summary.p25 = SortedQuantile(values, 0.25);
  summary.median = SortedQuantile(values, 0.50);
  summary.p75 = SortedQuantile(values, 0.75);
  summary.p95 = SortedQuantile(values, 0.95);
  summary.p99 = SortedQuantile(values, 0.99);
  summary.max = values.back();
  return summary;
}

}  // namespace duet
