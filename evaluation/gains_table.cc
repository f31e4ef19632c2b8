#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/study_gains.h"
#include "evaluation/study_table_parts.h"
#include "evaluation/text_table.h"
#include "evaluation/verdict_parts.h"

namespace duet {
namespace {

/// Two estimators' gains, the better one's first.
struct GainSides {
  const std::string* better;
  const std::string* other;
  double better_gain;
  double other_gain;
  /// How far apart, and its interval: other / better, or other - better.
  double apart;
  Band interval;
};

GainSides GainSidesOf(const GainComparison& gain, bool ratio, bool first_is_better) {
  const PairedComparison& paired = gain.arms.overall().paired;
  const auto turned = [&](const Band& band) {
    return ratio ? Band{1.0 / band.high, 1.0 / band.low} : Band{-band.high, -band.low};
  };
  const double apart = ratio ? paired.ratio : paired.difference;
  const Band interval = ratio ? paired.ratio_interval : paired.difference_interval;
  if (!first_is_better) {
    return {&gain.arms.second, &gain.arms.first, gain.second_gain, gain.first_gain, apart,
            interval};
  }
  return {&gain.arms.first,
          &gain.arms.second,
          gain.first_gain,
          gain.second_gain,
          ratio ? 1.0 / apart : -apart,
          turned(interval)};
}

std::string GainSizeText(const Metric& metric, double value) {
  return Number(value, metric.decimals) + (metric.unit.empty() ? "" : " " + metric.unit);
}

/// "position error (ATE) becomes 0.500 times as large for msckf and 0.600 times for window"
std::string GainsText(const MetricGains& gains, const GainSides& sides) {
  const Metric& metric = gains.comparison.metric;
  if (!std::isfinite(sides.better_gain)) return "no pair has a gain of both";
  if (gains.is_ratio) {
    return metric.words + " becomes " + Number(sides.better_gain, 3) + " times as large for " +
           *sides.better + " and " + Number(sides.other_gain, 3) + " times for " + *sides.other;
  }
  // A gain is of scores, of which less is better.
  const auto changed = [&](double score) {
    const double value = metric.better == Better::kHigher ? -score : score;
    return GainSizeText(metric, std::abs(value)) + (value < 0.0 ? " less" : " more");
  };
  return metric.words + " becomes " + changed(sides.better_gain) + " for " + *sides.better +
         " and " + changed(sides.other_gain) + " for " + *sides.other;
}

std::string DecidedGain(const MetricGains& gains, const GainComparison& gain) {
  const Decision decision = gain.arms.overall().decision;
  const GainSides sides = GainSidesOf(gain, gains.is_ratio, decision == Decision::kFirstBetter);
  const Metric& metric = gains.comparison.metric;
  const double neutral = gains.is_ratio ? 1.0 : 0.0;
  const std::string evidence = EvidenceText(gains.comparison, gain.arms, sides.interval,
                                            gains.is_ratio ? 3 : metric.decimals);
  const std::string end = evidence + StreamsText(gain.arms, decision) + FewStreamsText(gain.arms);
  if (!(sides.apart > neutral)) {
    return gain.change + " is better for " + *sides.better + " than for " + *sides.other +
           " because of the runs that fail; where all ran, " + GainsText(gains, sides) + end;
  }
  const std::string by = gains.is_ratio ? Number(sides.apart, 3) + " times as much as "
                                        : GainSizeText(metric, sides.apart) + " more than ";
  if (sides.better_gain >= neutral) {
    return gain.change + " costs " + *sides.other + " " + by + *sides.better + ": " +
           GainsText(gains, sides) + end;
  }
  return gain.change + " helps " + *sides.better + " " + by + *sides.other + ": " +
         GainsText(gains, sides) + end;
}

std::string UndecidedGain(const MetricGains& gains, const GainComparison& gain) {
  const MetricComparison& comparison = gains.comparison;
  const ComparisonRow& overall = gain.arms.overall();
  const bool first_is_better = overall.paired.direction() <= 0.0;
  const GainSides sides = GainSidesOf(gain, gains.is_ratio, first_is_better);
  const std::string whom = gain.change + " helps " + gain.arms.first + " or " + gain.arms.second +
                           " more in " + comparison.metric.words;
  const std::string size =
      GainsText(gains, sides) + EvidenceText(comparison, gain.arms, sides.interval,
                                             gains.is_ratio ? 3 : comparison.metric.decimals);
  switch (overall.decision) {
    case Decision::kEqual:
      return gain.change + " changes " + comparison.metric.words + " alike for " + gain.arms.first +
             " and " + gain.arms.second + " in all pairs";
    case Decision::kTooFew:
      return "nothing can be said of whether " + whom + ": " +
             TooFewText(comparison, overall.paired);
    case Decision::kBelowChaos:
      return "nothing is said of whether " + whom +
             ", the difference is below the chaos floor: " + size;
    case Decision::kCoversLess:
      return "nothing is said of whether " + whom + ", since with it " + *sides.better +
             " covers less of the span: " + size;
    default:
      return "nothing can be said of whether " + whom + ": " + size +
             DetectableText(comparison, overall.paired);
  }
}

}  // namespace

std::string GainsSentences(const MetricGains& gains) {
  // All of a few; of many those that are decided.
  constexpr std::size_t kFew = 3;
  std::vector<std::string> clauses;
  int undecided = 0;
  for (const GainComparison& gain : gains.changes) {
    if (IsDecided(gain.arms.overall().decision)) {
      clauses.push_back(DecidedGain(gains, gain));
    } else if (gains.changes.size() <= kFew) {
      clauses.push_back(UndecidedGain(gains, gain));
    } else {
      ++undecided;
    }
  }
  if (undecided > 0) {
    const bool all = undecided == static_cast<int>(gains.changes.size());
    clauses.push_back("nothing can be said of which estimator gains more in " +
                      gains.comparison.metric.words + " in " + (all ? "any of " : "the other ") +
                      CountText(undecided, "comparison"));
  }
  return SentencesOf(clauses);
}

StudyTable GainsTable(const MetricGains& gains, const StudyTableOptions& options) {
  const Metric& metric = gains.comparison.metric;
  const bool ratio = gains.is_ratio;
  StudyTable table;
  table.name = metric.key + ".gains";
  table.title = metric.Title() +
                ": which estimator gains more by a change, pairs of gains on the "
                "same stream and seed";
  table.columns = {{.title = "stream", .is_text = true},
                   {.title = "pairs"},
                   {.title = "failures against"},
                   {.title = ratio ? "ratio of gains" : "difference of gains",
                    .unit = ratio ? "" : metric.unit,
                    .spread = "95 % interval"},
                   {.title = "p"},
                   {.title = "p (Holm)"},
                   {.title = "gains more", .is_text = true}};
  for (const GainComparison& gain : gains.changes) {
    const ArmComparison& arms = gain.arms;
    table.rows.push_back(
        {.section = gain.change + ": " + arms.first + " / " + arms.second, .cells = {}});
    for (const ComparisonRow& row : arms.rows) {
      const PairedComparison& paired = row.paired;
      const Band& interval = ratio ? paired.ratio_interval : paired.difference_interval;
      TableCell effect =
          NumberCell(ratio ? paired.ratio : paired.difference, ratio ? 3 : metric.decimals);
      effect.low = interval.low;
      effect.high = interval.high;
      table.rows.push_back(
          {.section = "",
           .cells = {TextCell(row.stream.empty() ? "all streams" : row.stream),
                     NumberCell(paired.pairs, 0),
                     TextCell(std::to_string(paired.only_first_failed) + " : " +
                              std::to_string(paired.only_second_failed)),
                     std::move(effect),
                     PValueCell(std::isnan(row.p_holm) ? row.p_holm : paired.test.p_value),
                     PValueCell(row.p_holm), TextCell(DecisionText(arms, row.decision))}});
    }
  }
  table.verdict = GainsSentences(gains);
  table.foot = {
      ratio
          ? "gain: the metric with the change / with the baseline, of one estimator on one stream "
            "and seed (below 1: better); ratio of gains: first / second estimator's, a ratio of "
            "ratios"
          : "gain: the metric with the change - with the baseline, of one estimator on one stream "
            "and seed, turned so that less is better; difference of gains: first - second "
            "estimator's",
      "failures against: an estimator that fails with the change alone has the worst gain of all, "
      "with the baseline alone the best, with both none; in how many pairs that speaks against the "
      "first : the second"};
  for (std::string& line : PairedFoot(gains.comparison, options)) {
    table.foot.push_back(std::move(line));
  }
  for (const GainComparison& gain : gains.changes) {
    if (std::isnan(gain.arms.chaos_floor)) continue;
    table.foot.push_back("chaos floor of " + gain.change + ", " + gain.arms.first + " / " +
                         gain.arms.second + ChaosFloorText(gain.arms, metric, "gains"));
  }
  return table;
}

}  // namespace duet
