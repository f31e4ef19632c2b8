#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "evaluation/metrics.h"
#include "evaluation/paired_test.h"
#include "evaluation/study_grid.h"
#include "evaluation/study_pairs.h"
#include "evaluation/study_table.h"

namespace duet {

/// Two arms of a study against each other in one metric, and what may be said of it.

enum class Decision {
  kFirstBetter,   ///< the first is better
  kSecondBetter,  ///< the second is
  kNothing,       ///< no difference is shown
  kEqual,         ///< every pair has the same value twice
  kTooFew,        ///< so few pairs can show none among so many tests
  kBelowChaos,    ///< a difference is shown, and smaller than the chaos floor
  kCoversLess,    ///< the better one covers less of the span
  kNoDirection    ///< a difference is shown in a metric of which no direction is better
};

struct ComparisonRow {
  std::string stream;  ///< empty: all streams together
  bool repeats =
      false;  ///< each of its inputs is an earlier stream's too: the same by another name
  PairedComparison paired;
  double p_holm = std::numeric_limits<double>::quiet_NaN();
  double first_coverage = std::numeric_limits<double>::quiet_NaN();  ///< median of the runs
  double second_coverage = std::numeric_limits<double>::quiet_NaN();
  Decision decision = Decision::kNothing;
};

struct ArmComparison {
  std::string first;  ///< names of arms
  std::string second;
  /// One a stream that has pairs; where they are several, all of them together last, in which an
  /// input counts once, whatever it is called.
  std::vector<ComparisonRow> rows;
  /// What two runs of one arm that differ by jitter alone typically differ by (the median over
  /// pairs of runs on the chaos streams; of the two arms the larger): a factor above 1 where the
  /// comparison is of ratios, else in the metric's unit; NaN without a chaos stream.
  double chaos_floor = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] const ComparisonRow& overall() const { return rows.back(); }
  /// Rows of single streams: all but the last where there are several.
  [[nodiscard]] std::size_t single_rows() const { return rows.size() - (rows.size() > 1 ? 1 : 0); }
  /// How many of them have input of their own.
  [[nodiscard]] int streams() const;
};

struct MetricComparison {
  Metric metric;
  int tests = 0;  ///< that Holm's correction is over: every row that has a pair
  double alpha = 0.05;
  std::vector<ArmComparison> arms;

  /// What a p-value must be at most to be shown whatever the others are: Holm's first step.
  [[nodiscard]] double first_step_alpha() const { return alpha / std::max(tests, 1); }
};

/// Every pair of arms that differ in options.compare alone: estimators each with each, settings and
/// perturbations each with the baseline. Throws InputError where the baseline does not exist.
[[nodiscard]] MetricComparison CompareArms(const StudyGrid& grid, const Metric& metric,
                                           const StudyTableOptions& options);

/// The parts that CompareArms is made of, for comparisons of other numbers than a run's own
/// (evaluation/study_gains.h).
struct ComparedStream {
  std::string name;
  StreamPairs pairs;
  double first_coverage = std::numeric_limits<double>::quiet_NaN();
  double second_coverage = std::numeric_limits<double>::quiet_NaN();
};
/// Rows without decisions; names, coverage over all and the chaos floor are left to the caller.
[[nodiscard]] ArmComparison CompareStreams(const std::vector<ComparedStream>& streams,
                                           const Metric& metric, const StudyTableOptions& options);
/// Counts the tests, corrects their p-values and decides each row of `comparison`.
void DecideAll(const StudyTableOptions& options, MetricComparison* comparison);
/// Over the runs that did not fail; NaN where there is none.
[[nodiscard]] double MedianCoverage(const StudyGrid& grid, const std::vector<std::size_t>& streams,
                                    std::size_t arm);
/// The median over pairs of values of their distance; NaN below two values.
[[nodiscard]] double MedianPairDifference(const std::vector<double>& values);

/// A sentence a comparison, a line each: who is better, by how much, how sure; or that nothing can
/// be said, and why. Of many those that are decided, and the number of the others.
[[nodiscard]] std::string VerdictSentences(const MetricComparison& comparison);

/// "msckf", "nothing shown", "below the chaos floor", ...
[[nodiscard]] std::string DecisionText(const ArmComparison& arms, Decision decision);

/// "p = 0.012", "p < 0.001".
[[nodiscard]] std::string PValueText(double p);

}  // namespace duet
