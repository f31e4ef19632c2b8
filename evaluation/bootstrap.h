#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "evaluation/chi_squared.h"

namespace duet {

struct BootstrapOptions {
  int resamples = 2000;
  double confidence = 0.95;
  std::uint64_t seed = 1;  ///< of the resamples: the same values give the same interval
};

/// A number that is made of values in any order.
using Statistic = std::function<double(std::span<const double>)>;

/// An interval that holds the statistic's true value with about `confidence`: the bias-corrected
/// and accelerated (BCa) bootstrap (Efron, "Better bootstrap confidence intervals", JASA 1987). It
/// is chosen over the plain percentile interval because errors' ratios are skewed and samples are
/// small: BCa's ends are right to the second order for a statistic that is smooth enough, as the
/// mean and the Hodges-Lehmann estimate are (the median of few values is not).
///
/// Each stratum (the pairs of one stream) is resampled by itself. The acceleration comes from
/// leaving out one value at a time. Fewer than `kMinBootstrapValues` values in all give no interval
/// (NaN): their resamples are too few to tell a tail; values that are all equal give that value.
inline constexpr int kMinBootstrapValues = 6;
[[nodiscard]] Band BootstrapInterval(std::span<const std::vector<double>> strata,
                                     const Statistic& statistic,
                                     const BootstrapOptions& options = {});

}  // namespace duet
