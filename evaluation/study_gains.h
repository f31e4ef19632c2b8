#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluation/study_comparison.h"
#include "evaluation/study_grid.h"
#include "evaluation/study_table.h"

namespace duet {

/// Whom a change helps more. Where a study compares settings (or perturbations) with a baseline, an
/// estimator's gain by one is its metric with it over its metric with the baseline, on the same
/// stream and seed: that the one estimator is shown to gain and the other is not does not say that
/// the one gains more. Here gains are compared, pair by pair: the ratio of two estimators' gains (a
/// ratio of ratios) in the same test, with the same interval and the same rules for identical
/// input, coverage and chaos, as runs themselves in CompareArms.
///
/// Where the metric is no error with positive values alone, a gain is a difference of scores
/// (Metric::Score), and gains are compared by their difference, in the metric's unit.
///
/// Failures: an estimator that fails with the change alone has the worst gain of all, with the
/// baseline alone the best, with both none. A pair in which these speak against one of the two
/// counts as one that failed for it; where they speak against both alike, as one that failed for
/// both.

struct GainComparison {
  std::string change;  ///< "t_d estimated instead of t_d fixed", with what else varies in brackets
  ArmComparison arms;  ///< first, second: estimators; a row's ratio is of their gains
  /// Hodges-Lehmann estimates over all pairs with both gains: a factor below 1 (a difference below
  /// 0) is an improvement; NaN where there is none.
  double first_gain = std::numeric_limits<double>::quiet_NaN();
  double second_gain = std::numeric_limits<double>::quiet_NaN();
};

struct MetricGains {
  bool is_ratio = false;  ///< of every comparison
  /// Its arms are those of `changes`; Holm's correction is over all of their rows.
  MetricComparison comparison;
  std::vector<GainComparison> changes;
};

/// Every change from the baseline, every two estimators each. Nothing where estimators are compared
/// themselves, where there is one, where no direction of the metric is better, or where no run has
/// a gain (a calibration that the baseline does not estimate).
[[nodiscard]] std::optional<MetricGains> CompareGains(const StudyGrid& grid, const Metric& metric,
                                                      const StudyTableOptions& options);

/// A sentence a change, a line each: whom it helps more, and by how much.
[[nodiscard]] std::string GainsSentences(const MetricGains& gains);

}  // namespace duet
