#pragma once

#include <span>
#include <vector>

#include "evaluation/bootstrap.h"
#include "evaluation/metrics.h"
#include "evaluation/signed_rank.h"

namespace duet {

/// One pair: two runs on the same stream and seed that differ in what is compared.
struct PairedRuns {
  double first = 0.0;  ///< the metric's value; NaN where the run has none
  double second = 0.0;
  bool first_failed = false;
  bool second_failed = false;
};

struct PairedOptions {
  BootstrapOptions bootstrap;
  SignedRankOptions signed_rank;
};

/// Who is better by how much, from pairs.
///
/// The test is Wilcoxon's signed-rank test of the differences of scores (Metric::Score), of their
/// logarithms where the metric is an error whose values are all positive: a ratio is the same
/// number on an easy and on a hard stream. **A pair of which one run failed counts as the largest
/// difference of all, to the other's favour** (worst rank: Lachin 1999), and is in no effect or
/// interval; of which both failed, it tells nothing and is left out. Every count is kept.
struct PairedComparison {
  int pairs = 0;  ///< both ran and have a value: what `ratio`, `difference` are made of
  int only_first_failed = 0;
  int only_second_failed = 0;
  int both_failed = 0;
  int without_value = 0;  ///< ran, but at least one has no value
  int strata = 0;         ///< that have a pair

  bool is_ratio = false;  ///< the test is of logarithms, and `ratio` is known
  /// Hodges-Lehmann estimates, first against second: of first / second (through logarithms) and of
  /// first - second in the metric's unit; BCa intervals; NaN where unknown.
  double ratio;
  Band ratio_interval;
  double difference;
  Band difference_interval;

  /// Of the estimate: of the ratio's logarithm where `is_ratio`, else of the difference. From the
  /// interval, which is symmetric enough for its length to tell it; NaN without an interval.
  double standard_error;
  /// The difference that so many pairs that scatter like these show with probability 0.8 in a
  /// two-sided test at `level`: a factor (> 1) where `is_ratio`, else in the metric's unit. The
  /// estimate and the test have the same efficiency, so that it is t(1 - level / 2) + t(0.8)
  /// standard errors of the estimate, quantiles of Student's t with pairs - 1 degrees of freedom:
  /// normal ones promise 18 pairs at level 0.05 / 8 a probability of 0.8 that is 0.63. NaN where
  /// the standard error is not known.
  [[nodiscard]] double Detectable(double level) const;

  SignedRank test;
  double failure_p_value = 1.0;  ///< McNemar's, that both fail equally often
  /// Pairs that tell something: the test's count. The smallest p that so many can give is 2^(1-n).
  [[nodiscard]] int informative() const { return test.count; }
  /// Below 0: the first's score is smaller (it is better), by the ranks' sum.
  [[nodiscard]] double direction() const { return test.w_plus - test.w_minus; }

  PairedComparison();
};

/// True where `informative` pairs can reach p <= level at all: all of them to one side.
[[nodiscard]] bool CanShow(int informative, double level);
/// The fewest that can.
[[nodiscard]] int PairsNeeded(double level);

/// `strata`: the pairs of each stream; ranks are over all of them together, resamples within each.
[[nodiscard]] PairedComparison ComparePairs(std::span<const std::vector<PairedRuns>> strata,
                                            const Metric& metric,
                                            const PairedOptions& options = {});

}  // namespace duet
