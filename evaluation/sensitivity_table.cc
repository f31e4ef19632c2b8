#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/metrics.h"
#include "evaluation/study_comparison.h"
#include "evaluation/study_table_parts.h"
#include "evaluation/verdict_parts.h"

namespace duet {
namespace {

/// The ways in which one kind of error can be measured, of those that the study's records have.
struct MeasureFamily {
  const char* words;
  std::vector<Metric> metrics;
};

bool OfPosition(const std::string& key) {
  return key == "rms.position_m" || key.starts_with("ate.position_m") ||
         key.starts_with("relative.position_m.");
}
bool OfOrientation(const std::string& key) {
  return key == "rms.orientation_deg" || key == "ate.tilt_deg" ||
         key.starts_with("ate.orientation_deg") || key.starts_with("relative.orientation_deg.");
}

std::vector<MeasureFamily> FamiliesOf(const StudyResult& study) {
  std::vector<MeasureFamily> families = {{"position", {}}, {"orientation", {}}};
  std::vector<std::string> seen;
  for (const StudyRun& run : study.runs) {
    if (run.failed) continue;
    for (const auto& [key, value] : run.metrics) {
      if (!OfPosition(key) && !OfOrientation(key)) continue;
      if (std::find(seen.begin(), seen.end(), key) != seen.end()) continue;
      seen.push_back(key);
      families[OfPosition(key) ? 0 : 1].metrics.push_back(MetricOf(key));
    }
  }
  std::erase_if(families, [](const MeasureFamily& family) { return family.metrics.size() < 2; });
  return families;
}

/// What the measures of one family say of one pair of arms.
struct MeasureVotes {
  int first = 0;
  int second = 0;
  int measures = 0;
};

/// Of many pairs those of which a measure says something are named; the others are counted.
constexpr std::size_t kFewPairs = 3;

std::string VotesText(const MeasureVotes& votes, const ArmComparison& arms, const char* family) {
  const std::string of = "of " + std::to_string(votes.measures) + " measures of the " + family;
  if (votes.first > 0 && votes.second > 0) {
    return of + " " + std::to_string(votes.first) + " say " + arms.first + " and " +
           std::to_string(votes.second) + " " + arms.second +
           ": who is better depends on how it is measured";
  }
  const int decided = votes.first + votes.second;
  if (decided == 0)
    return of + " none says who of " + arms.first + " and " + arms.second + " is better";
  return of + " " + (decided == votes.measures ? "all" : std::to_string(decided)) + " say " +
         (votes.first > 0 ? arms.first : arms.second) + " and none " +
         (votes.first > 0 ? arms.second : arms.first);
}

}  // namespace

std::vector<StudyTable> SensitivityTables(const StudyGrid& grid, const StudyTableOptions& options) {
  const std::vector<MeasureFamily> families = FamiliesOf(grid.study());
  StudyTable table;
  table.name = "sensitivity";
  table.title = "does the verdict depend on how the error is measured";
  table.columns = {{.title = "measured as", .is_text = true},
                   {.title = "pairs"},
                   {.title = "ratio", .spread = "95 % interval"},
                   {.title = "p (Holm)"},
                   {.title = "better", .is_text = true}};
  std::vector<std::string> clauses;
  for (const MeasureFamily& family : families) {
    int undecided = 0;
    std::vector<MetricComparison> comparisons;
    for (const Metric& metric : family.metrics) {
      comparisons.push_back(CompareArms(grid, metric, options));
    }
    for (std::size_t pair = 0; pair < comparisons.front().arms.size(); ++pair) {
      const ArmComparison& named = comparisons.front().arms[pair];
      table.rows.push_back(
          {.section = std::string(family.words) + ": " + named.first + " / " + named.second,
           .cells = {}});
      MeasureVotes votes;
      for (const MetricComparison& comparison : comparisons) {
        const ArmComparison& arms = comparison.arms[pair];
        const ComparisonRow& overall = arms.overall();
        if (overall.paired.pairs == 0) continue;
        ++votes.measures;
        votes.first += overall.decision == Decision::kFirstBetter ? 1 : 0;
        votes.second += overall.decision == Decision::kSecondBetter ? 1 : 0;
        TableCell ratio = NumberCell(overall.paired.ratio, 3);
        ratio.low = overall.paired.ratio_interval.low;
        ratio.high = overall.paired.ratio_interval.high;
        table.rows.push_back(
            {.section = "",
             .cells = {TextCell(comparison.metric.words), NumberCell(overall.paired.pairs, 0),
                       std::move(ratio), PValueCell(overall.p_holm),
                       TextCell(DecisionText(arms, overall.decision))}});
      }
      if (votes.measures < 2) continue;
      if (comparisons.front().arms.size() > kFewPairs && votes.first + votes.second == 0) {
        ++undecided;
      } else {
        clauses.push_back(VotesText(votes, named, family.words));
      }
    }
    if (undecided > 0) {
      clauses.push_back("of all measures of the " + std::string(family.words) +
                        " none says who is better in " + std::to_string(undecided) +
                        " of the pairs");
    }
  }
  if (clauses.empty()) return {};
  table.verdict = SentencesOf(clauses);
  table.foot = {
      "ratio, p, better: over all streams, as in the measure's own table of pairs (METRIC.paired), "
      "where p is corrected over that table"};
  return {std::move(table)};
}

}  // namespace duet
