#include "evaluation/paired_test.h"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstddef>
#include <limits>

#include "evaluation/proportion.h"

namespace duet {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool BothRan(const PairedRuns& pair) { return !pair.first_failed && !pair.second_failed; }
bool HaveValues(const PairedRuns& pair) {
  return BothRan(pair) && std::isfinite(pair.first) && std::isfinite(pair.second);
}

/// An error whose values, in every pair, have a logarithm.
bool IsRatio(std::span<const std::vector<PairedRuns>> strata, const Metric& metric) {
  if (metric.better != Better::kLower) return false;
  for (const auto& stratum : strata) {
    for (const PairedRuns& pair : stratum) {
      if (HaveValues(pair) && !(pair.first > 0.0 && pair.second > 0.0)) return false;
    }
  }
  return true;
}

double ShownDifference(const PairedRuns& pair, const Metric& metric) {
  // Of an error with a sign the magnitudes are compared, of NEES the distances to what is expected.
  const bool raw = metric.better == Better::kLower || metric.better == Better::kHigher ||
                   metric.better == Better::kNeither;
  return raw ? pair.first - pair.second : metric.Score(pair.first) - metric.Score(pair.second);
}

double StandardErrorOf(const Band& interval, double confidence) {
  const boost::math::normal normal;
  return (interval.high - interval.low) /
         (2.0 * boost::math::quantile(normal, 0.5 + 0.5 * confidence));
}

void CountPairs(std::span<const std::vector<PairedRuns>> strata, PairedComparison* comparison) {
  for (const auto& stratum : strata) {
    bool any = false;
    for (const PairedRuns& pair : stratum) {
      if (pair.first_failed && pair.second_failed) {
        ++comparison->both_failed;
      } else if (pair.first_failed) {
        ++comparison->only_first_failed;
      } else if (pair.second_failed) {
        ++comparison->only_second_failed;
      } else if (!HaveValues(pair)) {
        ++comparison->without_value;
      } else {
        ++comparison->pairs;
      }
      any = any || !BothRan(pair) || HaveValues(pair);
    }
    if (any) ++comparison->strata;
  }
}

}  // namespace

PairedComparison::PairedComparison()
    : ratio(kNaN),
      ratio_interval{kNaN, kNaN},
      difference(kNaN),
      difference_interval{kNaN, kNaN},
      standard_error(kNaN) {}

double PairedComparison::Detectable(double level) const {
  if (std::isnan(standard_error) || pairs < 2) return kNaN;
  const boost::math::students_t t(pairs - 1);
  const double distance = (boost::math::quantile(boost::math::complement(t, 0.5 * level)) +
                           boost::math::quantile(t, 0.8)) *
                          standard_error;
  return is_ratio ? std::exp(distance) : distance;
}

bool CanShow(int informative, double level) { return std::ldexp(1.0, 1 - informative) <= level; }

int PairsNeeded(double level) {
  int pairs = 1;
  while (!CanShow(pairs, level)) ++pairs;
  return pairs;
}

PairedComparison ComparePairs(std::span<const std::vector<PairedRuns>> strata, const Metric& metric,
                              const PairedOptions& options) {
  PairedComparison comparison;
  CountPairs(strata, &comparison);
  comparison.is_ratio = IsRatio(strata, metric) && comparison.pairs > 0;

  std::vector<std::vector<double>> logarithms(strata.size());
  std::vector<std::vector<double>> differences(strata.size());
  std::vector<double> scores;  // of the test: the smaller, the better the first
  for (std::size_t s = 0; s < strata.size(); ++s) {
    for (const PairedRuns& pair : strata[s]) {
      if (pair.first_failed != pair.second_failed) {
        scores.push_back(pair.first_failed ? std::numeric_limits<double>::infinity()
                                           : -std::numeric_limits<double>::infinity());
      }
      if (!HaveValues(pair)) continue;
      differences[s].push_back(ShownDifference(pair, metric));
      if (comparison.is_ratio) logarithms[s].push_back(std::log(pair.first / pair.second));
      scores.push_back(comparison.is_ratio ? logarithms[s].back()
                                           : metric.Score(pair.first) - metric.Score(pair.second));
    }
  }
  comparison.test = SignedRankTest(scores, options.signed_rank);
  comparison.failure_p_value =
      McNemarPValue(comparison.only_first_failed, comparison.only_second_failed);
  if (comparison.pairs == 0) return comparison;

  const auto estimate = [](const std::vector<std::vector<double>>& values) {
    std::vector<double> all;
    for (const auto& stratum : values) all.insert(all.end(), stratum.begin(), stratum.end());
    return HodgesLehmann(all);
  };
  comparison.difference = estimate(differences);
  comparison.difference_interval = BootstrapInterval(differences, HodgesLehmann, options.bootstrap);
  comparison.standard_error =
      StandardErrorOf(comparison.difference_interval, options.bootstrap.confidence);
  if (comparison.is_ratio) {
    comparison.ratio = std::exp(estimate(logarithms));
    const Band interval = BootstrapInterval(logarithms, HodgesLehmann, options.bootstrap);
    comparison.ratio_interval = {std::exp(interval.low), std::exp(interval.high)};
    comparison.standard_error = StandardErrorOf(interval, options.bootstrap.confidence);
  }
  return comparison;
}

}  // namespace duet
