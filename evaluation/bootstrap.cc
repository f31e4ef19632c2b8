#include "evaluation/bootstrap.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/support/logging.h"
#include "common/support/random.h"
#include "evaluation/statistics.h"

namespace duet {
namespace {

std::vector<double> Joined(std::span<const std::vector<double>> strata) {
  std::vector<double> all;
  for (const auto& stratum : strata) all.insert(all.end(), stratum.begin(), stratum.end());
  return all;
}

/// The statistic of each resample, sorted.
std::vector<double> Replicates(std::span<const std::vector<double>> strata,
                               const Statistic& statistic, const BootstrapOptions& options) {
  Random random(options.seed);
  std::vector<double> replicates(static_cast<std::size_t>(options.resamples));
  std::vector<double> resample;
  for (double& replicate : replicates) {
    resample.clear();
    for (const auto& stratum : strata) {
      const int size = static_cast<int>(stratum.size());
      for (int i = 0; i < size; ++i) {
        resample.push_back(stratum[static_cast<std::size_t>(random.Index(size))]);
      }
    }
    replicate = statistic(resample);
  }
  std::sort(replicates.begin(), replicates.end());
  return replicates;
}

/// Efron's acceleration: a sixth of the skewness of the jackknife's values.
double Acceleration(const std::vector<double>& values, const Statistic& statistic) {
  std::vector<double> without(values.begin() + 1, values.end());
  std::vector<double> jackknife(values.size());
  double mean = 0.0;
  for (std::size_t left_out = 0; left_out < values.size(); ++left_out) {
    if (left_out > 0) without[left_out - 1] = values[left_out - 1];
    jackknife[left_out] = statistic(without);
    mean += jackknife[left_out] / static_cast<double>(values.size());
  }
  double squares = 0.0;
  double cubes = 0.0;
  for (const double value : jackknife) {
    const double d = mean - value;
    squares += d * d;
    cubes += d * d * d;
  }
  return squares > 0.0 ? cubes / (6.0 * std::pow(squares, 1.5)) : 0.0;
}

}  // namespace

Band BootstrapInterval(std::span<const std::vector<double>> strata, const Statistic& statistic,
                       const BootstrapOptions& options) {
  CHECK_GE(options.resamples, 0);
  CHECK(options.confidence > 0.0 && options.confidence < 1.0);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> values = Joined(strata);
  if (options.resamples == 0 || values.size() < kMinBootstrapValues) return {kNaN, kNaN};
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); })) {
    const double estimate = statistic(values);
    return {estimate, estimate};
  }
  const double estimate = statistic(values);
  const std::vector<double> replicates = Replicates(strata, statistic, options);
  const auto [first, last] = std::equal_range(replicates.begin(), replicates.end(), estimate);
  const auto count = static_cast<double>(replicates.size());
  // Half of those that equal it count as below; at the ends half a resample keeps the normal
  // quantile finite.
  const double below =
      static_cast<double>(first - replicates.begin()) + 0.5 * static_cast<double>(last - first);
  const boost::math::normal normal;
  const double z0 =
      boost::math::quantile(normal, std::clamp(below / count, 0.5 / count, 1.0 - 0.5 / count));
  const double a = Acceleration(values, statistic);
  const auto end = [&](double p) {
    const double z = z0 + boost::math::quantile(normal, p);
    const double slope = 1.0 - a * z;
    // Beyond the pole of the correction there is no more of the distribution.
    const double corrected =
        slope > 0.0 ? boost::math::cdf(normal, z0 + z / slope) : (z > 0.0 ? 1.0 : 0.0);
    return SortedQuantile(replicates, corrected);
  };
  const double left_out = 0.5 * (1.0 - options.confidence);
  return {end(left_out), end(1.0 - left_out)};
}

}  // namespace duet
