#pragma once

#include <span>

namespace duet {

/// Wilcoxon's signed-rank test of paired differences ("Individual comparisons by ranking methods",
/// 1945): under the hypothesis each difference is as likely as its negative. Ranks of magnitudes,
/// equal ones get the mean of their ranks; infinite differences (a pair of which one run failed)
/// are the largest, equal to one another.

/// What becomes of differences that are zero.
enum class ZeroDifferences {
  kPratt,    ///< ranked with the others and left out then (Pratt 1959)
  kWilcoxon  ///< left out before ranking (Wilcoxon 1945, R's wilcox.test)
};

struct SignedRankOptions {
  /// Pratt: leaving zeros out first can make a small difference more significant by adding zeros
  /// to it.
  ZeroDifferences zeros = ZeroDifferences::kPratt;
  /// With at most so many differences that are not zero the distribution is the exact one, given
  /// the ranks; ties do not change that. Above, it is the normal one with the variance of these
  /// ranks (which is the correction for ties) and a continuity correction of 1/2.
  int exact_up_to = 50;
};

struct SignedRank {
  int count = 0;         ///< differences that are not zero
  int zeros = 0;         ///< left out
  double w_plus = 0.0;   ///< sum of the ranks of positive differences
  double w_minus = 0.0;  ///< and of negative ones
  bool exact = true;
  double p_value = 1.0;  ///< of both sides; 1 where every difference is zero
};

[[nodiscard]] SignedRank SignedRankTest(std::span<const double> differences,
                                        const SignedRankOptions& options = {});

/// The estimate that belongs to the test: the median of the n (n + 1) / 2 means (x_i + x_j) / 2,
/// i <= j (Hodges and Lehmann 1963). For the centre of a symmetric distribution, at most 14 % less
/// efficient than the mean where that is best, and hardly moved by single large values.
/// Values are finite, at least one.
[[nodiscard]] double HodgesLehmann(std::span<const double> values);

}  // namespace duet
