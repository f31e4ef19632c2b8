#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/study_comparison.h"
#include "evaluation/text_table.h"
#include "evaluation/verdict_parts.h"

namespace duet {
namespace {

/// Whom a sentence speaks of first, and the numbers turned to that order.
struct Sides {
  const std::string* subject;
  const std::string* other;
  double ratio;
  Band ratio_interval;
  double difference;
  Band difference_interval;
};

Sides SidesOf(const ArmComparison& arms, const PairedComparison& paired, bool first_is_subject) {
  if (first_is_subject) {
    return {&arms.first,           &arms.second,      paired.ratio,
            paired.ratio_interval, paired.difference, paired.difference_interval};
  }
  return {&arms.second,       &arms.first,
          1.0 / paired.ratio, {1.0 / paired.ratio_interval.high, 1.0 / paired.ratio_interval.low},
          -paired.difference, {-paired.difference_interval.high, -paired.difference_interval.low}};
}

/// How large, and how sure: "0.84 times that of msckf (95 % interval 0.79 to 0.90; 60 pairs on 3
/// streams, p < 0.001 after Holm's correction)".
std::string SizeText(const MetricComparison& comparison, const ArmComparison& arms,
                     const Sides& sides) {
  const PairedComparison& paired = arms.overall().paired;
  std::string text;
  Band interval;
  int decimals = 3;
  if (paired.is_ratio) {
    text = Number(sides.ratio, decimals) + " times that of " + *sides.other;
    interval = sides.ratio_interval;
  } else if (paired.pairs > 0) {
    decimals = comparison.metric.decimals;
    const std::string unit = comparison.metric.unit.empty() ? "" : " " + comparison.metric.unit;
    text = Number(std::abs(sides.difference), decimals) + unit +
           (sides.difference < 0.0 ? " less than " : " more than ") + *sides.other;
    interval = sides.difference_interval;
    if (sides.difference < 0.0) interval = {-interval.high, -interval.low};
  } else {
    text = "there is no pair of which both ran";
  }
  return text + EvidenceText(comparison, arms, interval, decimals);
}

std::string FailuresText(const ArmComparison& arms) {
  const PairedComparison& paired = arms.overall().paired;
  std::string text;
  const auto add = [&](int count, const std::string& name) {
    if (count == 0) return;
    text +=
        (text.empty() ? ", and " : " and ") + name + " alone failed in " + CountText(count, "pair");
  };
  add(paired.only_first_failed, arms.first);
  add(paired.only_second_failed, arms.second);
  return text;
}

std::string DecidedClause(const MetricComparison& comparison, const ArmComparison& arms) {
  const Metric& metric = comparison.metric;
  const ComparisonRow& overall = arms.overall();
  const Sides sides = SidesOf(arms, overall.paired, overall.decision == Decision::kFirstBetter);
  const std::string end =
      StreamsText(arms, overall.decision) + FailuresText(arms) + FewStreamsText(arms);
  const double better_sign = metric.better == Better::kHigher ? 1.0 : -1.0;
  const double effect = overall.paired.is_ratio ? std::log(sides.ratio) : sides.difference;
  if (overall.paired.pairs == 0 || !(effect * better_sign > 0.0)) {
    return *sides.subject + " is better in " + metric.words +
           " because it fails less; where both ran it is " + SizeText(comparison, arms, sides) +
           end;
  }
  const char* adjective = metric.better == Better::kHigher         ? "larger "
                          : metric.better == Better::kNearExpected ? "more consistent "
                                                                   : "smaller ";
  return *sides.subject + " has the " + adjective + metric.words + ": " +
         SizeText(comparison, arms, sides) + end;
}

std::string UndecidedClause(const MetricComparison& comparison, const ArmComparison& arms) {
  const Metric& metric = comparison.metric;
  const ComparisonRow& overall = arms.overall();
  const std::string between = " between " + arms.first + " and " + arms.second;
  const Sides sides = SidesOf(arms, overall.paired, true);
  const std::string size = *sides.subject + "'s is " + SizeText(comparison, arms, sides);
  switch (overall.decision) {
    case Decision::kEqual:
      return arms.first + " and " + arms.second + " have the same " + metric.words + " in " +
             (overall.paired.pairs == 1 ? "the only pair"
                                        : "all " + CountText(overall.paired.pairs, "pair"));
    case Decision::kTooFew:
      return "nothing can be said of " + metric.words + between + ": " +
             TooFewText(comparison, overall.paired);
    case Decision::kBelowChaos: {
      const std::string floor = overall.paired.is_ratio
                                    ? "a factor of " + Number(arms.chaos_floor, 3)
                                    : Number(arms.chaos_floor, metric.decimals) +
                                          (metric.unit.empty() ? "" : " " + metric.unit);
      return "the difference in " + metric.words + between +
             " is below the chaos floor, no verdict: " + size + ", and jitter alone makes " + floor;
    }
    case Decision::kCoversLess: {
      const bool first = overall.paired.direction() < 0.0;
      return (first ? arms.first : arms.second) + " has the smaller " + metric.words +
             " but covers " + Number(first ? overall.first_coverage : overall.second_coverage, 3) +
             " of the span and " + (first ? arms.second : arms.first) + " " +
             Number(first ? overall.second_coverage : overall.first_coverage, 3) +
             ", no verdict: " + size;
    }
    case Decision::kNoDirection:
      return metric.words + " differs" + between + ": " + size + FewStreamsText(arms);
    default:
      return "nothing can be said of " + metric.words + between + ": " + size +
             DetectableText(comparison, overall.paired) + FailuresText(arms);
  }
}

}  // namespace

std::string VerdictSentences(const MetricComparison& comparison) {
  if (comparison.arms.empty()) return "There is nothing to compare.";
  std::vector<std::string> clauses;
  // All of a few; of many those that are decided.
  constexpr std::size_t kFew = 3;
  int undecided = 0;
  for (const ArmComparison& arms : comparison.arms) {
    if (IsDecided(arms.overall().decision)) {
      clauses.push_back(DecidedClause(comparison, arms));
    } else if (comparison.arms.size() <= kFew) {
      clauses.push_back(UndecidedClause(comparison, arms));
    } else {
      ++undecided;
    }
  }
  if (undecided > 0) {
    const bool all = undecided == static_cast<int>(comparison.arms.size());
    clauses.push_back(
        (all ? "nothing can be said of any of " : "nothing can be said of the other ") +
        CountText(undecided, "comparison") + " of " + comparison.metric.words);
  }
  return SentencesOf(clauses);
}

}  // namespace duet
