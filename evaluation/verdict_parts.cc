#include "evaluation/verdict_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "evaluation/text_table.h"

namespace duet {

std::string PValueText(double p) {
  if (std::isnan(p)) return "no test";
  return p < 0.001 ? "p < 0.001" : "p = " + Number(p, 3);
}

bool IsDecided(Decision decision) {
  return decision == Decision::kFirstBetter || decision == Decision::kSecondBetter;
}

std::string CountText(int count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string EvidenceText(const MetricComparison& comparison, const ArmComparison& arms,
                         const Band& interval, int decimals) {
  const ComparisonRow& overall = arms.overall();
  const PairedComparison& paired = overall.paired;
  std::string text = " (";
  if (paired.pairs > 0 && std::isfinite(interval.low) && std::isfinite(interval.high)) {
    text += "95 % interval " + Number(interval.low, decimals) + " to " +
            Number(interval.high, decimals) + "; ";
  }
  const int one_failed = paired.only_first_failed + paired.only_second_failed;
  text += CountText(paired.pairs, "pair") + (one_failed > 0 ? " of which both ran" : "") + " on " +
          CountText(arms.streams(), "stream") + ", " + PValueText(overall.p_holm);
  if (one_failed > 0) {
    text += " of these and " + CountText(one_failed, "pair") + " of which one failed";
  }
  return text + (comparison.tests > 1 ? " after Holm's correction" : "") + ")";
}

std::string StreamsText(const ArmComparison& arms, Decision decision) {
  const int streams = arms.streams();
  if (arms.single_rows() < 2 || streams < 2) return "";
  const Decision contrary =
      decision == Decision::kFirstBetter ? Decision::kSecondBetter : Decision::kFirstBetter;
  const auto count = [&](Decision wanted) {
    const auto end = arms.rows.begin() + static_cast<std::ptrdiff_t>(arms.single_rows());
    return static_cast<int>(std::count_if(arms.rows.begin(), end, [&](const ComparisonRow& row) {
      return !row.repeats && row.decision == wanted;
    }));
  };
  const int too_few = count(Decision::kTooFew);
  if (too_few == streams) return ", with too few pairs to show it on one stream alone";
  std::string text = ", shown on " + std::to_string(count(decision)) + " of " +
                     std::to_string(streams) + " streams taken alone";
  if (too_few > 0) text += " (" + std::to_string(too_few) + " of them with too few pairs for it)";
  if (count(contrary) > 0) text += " and the contrary on " + std::to_string(count(contrary));
  return text;
}

std::string FewStreamsText(const ArmComparison& arms) {
  if (arms.streams() >= 3) return "";
  return ", on " + CountText(arms.streams(), "stream") + " only: a general verdict takes three";
}

std::string TooFewText(const MetricComparison& comparison, const PairedComparison& paired) {
  if (paired.informative() == 0) {
    if (paired.both_failed > 0 && paired.without_value == 0) {
      return paired.both_failed == 1
                 ? "both failed in the only pair"
                 : "both failed in all " + CountText(paired.both_failed, "pair");
    }
    return "there is no pair with a value of both";
  }
  return CountText(paired.informative(), "pair") + " that " +
         (paired.informative() == 1 ? "differs" : "differ") + " cannot" +
         (comparison.tests > 1 ? " among " + std::to_string(comparison.tests) + " tests" : "") +
         ", " + std::to_string(PairsNeeded(comparison.first_step_alpha())) + " can";
}

std::string DetectableText(const MetricComparison& comparison, const PairedComparison& paired) {
  const Metric& metric = comparison.metric;
  const double detectable = paired.Detectable(comparison.first_step_alpha());
  if (!std::isfinite(detectable) || !(detectable > (paired.is_ratio ? 1.0 : 0.0))) return "";
  const std::string size = paired.is_ratio ? Number(100.0 * (detectable - 1.0), 1) + " %"
                                           : Number(detectable, metric.decimals) +
                                                 (metric.unit.empty() ? "" : " " + metric.unit);
  return "; so many pairs show a difference of " + size + " four times in five" +
         (comparison.tests > 1 ? ", whatever the other tests say" : "");
}

std::string SentencesOf(const std::vector<std::string>& clauses) {
  std::string text;
  for (std::string clause : clauses) {
    // A name keeps its own spelling; what the program says begins with a capital.
    for (const char* beginning :
         {"nothing can be said", "nothing is said", "the difference in", "the covariance", "of "}) {
      if (clause.starts_with(beginning)) clause[0] = static_cast<char>(clause[0] - 'a' + 'A');
    }
    text += (text.empty() ? "" : "\n") + clause + ".";
  }
  return text;
}

}  // namespace duet
