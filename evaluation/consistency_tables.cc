#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/chi_squared.h"
#include "evaluation/failure_reasons.h"
#include "evaluation/holm.h"
#include "evaluation/proportion.h"
#include "evaluation/statistics.h"
#include "evaluation/study_comparison.h"
#include "evaluation/study_table_parts.h"
#include "evaluation/text_table.h"
#include "evaluation/verdict_parts.h"

namespace duet {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The NEES of one arm on one stream, in one block.
struct NeesCell {
  std::size_t stream = 0;
  std::size_t arm = 0;
  Metric metric;
  double dof = kUnknown;
  int runs = 0;
  int inputs = 0;  ///< of the runs, different: so many values are independent
  double mean = kUnknown;
  double standard_error = kUnknown;
  Band band = {kUnknown, kUnknown};
  double p_value = kUnknown;
  double p_holm = kUnknown;
};

NeesCell MakeNeesCell(const StudyCell& runs, const Metric& metric) {
  NeesCell cell;
  cell.metric = metric;
  cell.dof = metric.expected;
  if (!(cell.dof > 0.0)) {
    const std::vector<double> sizes = runs.Values(metric.key + ".dof");
    const bool one_size = !sizes.empty() && std::all_of(sizes.begin(), sizes.end(), [&](double n) {
      return n == sizes.front();
    });
    cell.dof = one_size && sizes.front() > 0.0 ? sizes.front() : kUnknown;
  }
  cell.runs = static_cast<int>(runs.Values(metric.key).size());
  const std::vector<double> values = runs.MeansByInput(metric.key);
  cell.inputs = static_cast<int>(values.size());
  if (values.empty()) return cell;
  cell.mean = Summarize(values).mean;
  if (values.size() > 1) {
    double squares = 0.0;
    for (const double value : values) squares += (value - cell.mean) * (value - cell.mean);
    cell.standard_error = std::sqrt(squares / (cell.inputs - 1) / cell.inputs);
  }
  return cell;
}

const char* NeesVerdict(const NeesCell& cell, double alpha) {
  if (cell.runs == 0 || std::isnan(cell.dof)) return "-";
  if (cell.inputs == 1) return cell.runs == 1 ? "one run, no verdict" : "one input, no verdict";
  if (!(cell.p_holm <= alpha)) return "not refuted";
  return cell.mean > cell.dof ? "too sure" : "too unsure";
}

std::string NeesSentences(const StudyGrid& grid, const std::vector<NeesCell>& cells, double alpha) {
  std::vector<std::string> clauses;
  // Of many arms those that are refuted are named; the others are counted.
  constexpr std::size_t kFewArms = 4;
  const bool many = grid.arms().size() > kFewArms;
  int others = 0;
  int tests_of_others = 0;
  for (std::size_t a = 0; a < grid.arms().size(); ++a) {
    int tested = 0;
    std::map<std::string, int> verdicts;
    const NeesCell* worst = nullptr;
    for (const NeesCell& cell : cells) {
      if (cell.arm != a || std::isnan(cell.p_holm)) continue;
      ++tested;
      ++verdicts[NeesVerdict(cell, alpha)];
      const auto off = [](const NeesCell& c) { return std::abs(std::log(c.mean / c.dof)); };
      if (cell.p_holm <= alpha && (worst == nullptr || off(cell) > off(*worst))) worst = &cell;
    }
    if (tested == 0) continue;
    if (many && worst == nullptr) {
      ++others;
      tests_of_others += tested;
      continue;
    }
    std::string& text = clauses.emplace_back("the covariance of " + grid.arms()[a].name);
    if (worst == nullptr) {
      text += " is refuted in none of " + std::to_string(tested) + " tests";
      continue;
    }
    const auto add = [&](const char* verdict, const char* before) {
      if (verdicts[verdict] == 0) return;
      text += std::string(before) + verdict + " in " + std::to_string(verdicts[verdict]);
    };
    text += " is";
    add("too sure", " ");
    add("too unsure", verdicts["too sure"] > 0 ? " and " : " ");
    text += " of " + std::to_string(tested) + " tests (worst: " + worst->metric.words + " on " +
            grid.streams()[worst->stream] + ", " + Number(worst->mean, 2) + " where " +
            Number(worst->dof, 0) + " is expected, " + PValueText(worst->p_holm) + ")";
  }
  if (others > 0) {
    clauses.push_back(
        (clauses.empty() ? "the covariances of all " : "the covariances of the other ") +
        std::to_string(others) + " are refuted in none of " + std::to_string(tests_of_others) +
        " tests");
  }
  if (clauses.empty()) return "No NEES can be tested: it takes runs with one on two inputs.";
  return SentencesOf(clauses);
}

std::vector<std::string> ReasonsOf(const StudyCell& cell) {
  std::vector<std::string> reasons;
  for (const StudyRun* run : cell.runs) {
    if (run->failed) reasons.push_back(run->reason);
  }
  return reasons;
}

std::string FailureSentences(const StudyGrid& grid, const StudyTableOptions& options) {
  int runs = 0;
  int failed = 0;
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      runs += static_cast<int>(grid.cell(s, a).runs.size());
      failed += grid.cell(s, a).failed();
    }
  }
  const std::string of_runs = std::to_string(runs) + " runs";
  if (failed == 0) return "None of " + of_runs + " failed.";
  // Any metric will do: failures are paired before values are looked at.
  StudyTableOptions quick = options;
  quick.bootstrap_resamples = 0;
  const MetricComparison comparison = CompareArms(grid, MetricOf("coverage_share"), quick);
  std::vector<double> p_values;
  for (const ArmComparison& arms : comparison.arms) {
    p_values.push_back(arms.overall().paired.failure_p_value);
  }
  const std::vector<double> adjusted = HolmAdjusted(p_values);
  std::vector<std::string> clauses;
  for (std::size_t i = 0; i < comparison.arms.size(); ++i) {
    if (!(adjusted[i] <= options.alpha)) continue;
    const ArmComparison& arms = comparison.arms[i];
    const PairedComparison& paired = arms.overall().paired;
    const bool first = paired.only_first_failed > paired.only_second_failed;
    const int most = std::max(paired.only_first_failed, paired.only_second_failed);
    clauses.push_back((first ? arms.first : arms.second) + " fails more often than " +
                      (first ? arms.second : arms.first) + " (alone in " + std::to_string(most) +
                      " pairs, the other alone in " +
                      std::to_string(paired.only_first_failed + paired.only_second_failed - most) +
                      "; " + PValueText(adjusted[i]) + ")");
  }
  if (clauses.empty()) {
    return std::to_string(failed) + " of " + of_runs +
           " failed, and it is not shown that one fails more often than another.";
  }
  return SentencesOf(clauses);
}

}  // namespace

StudyTable NeesTable(const StudyGrid& grid, const std::vector<Metric>& metrics,
                     const StudyTableOptions& options) {
  std::vector<NeesCell> cells;
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    if (IsChaosStream(options, grid.streams()[s])) continue;
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      for (const Metric& metric : metrics) {
        NeesCell cell = MakeNeesCell(grid.cell(s, a), metric);
        cell.stream = s;
        cell.arm = a;
        if (cell.runs > 0 && cell.dof > 0.0) {
          cell.band = MeanChiSquaredBand(cell.dof, cell.inputs, 1.0 - options.alpha);
          if (cell.inputs > 1) {
            cell.p_value = MeanChiSquaredPValue(cell.mean, cell.dof, cell.inputs);
          }
        }
        if (cell.runs > 0) cells.push_back(std::move(cell));
      }
    }
  }
  std::vector<double> p_values;
  for (const NeesCell& cell : cells) p_values.push_back(cell.p_value);
  const std::vector<double> adjusted = HolmAdjusted(p_values);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i].p_holm = adjusted[i];

  StudyTable table;
  table.name = "nees";
  table.title = "NEES, mean over runs, and where consistent runs have it";
  table.columns = {{.title = "run with", .is_text = true},
                   {.title = "of", .is_text = true},
                   {.title = "runs"},
                   {.title = "inputs"},
                   {.title = "expected"},
                   {.title = "mean", .spread = "1 standard error"},
                   {.title = "band, low end"},
                   {.title = "high end"},
                   {.title = "p (Holm)"},
                   {.title = "verdict", .is_text = true}};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const NeesCell& cell = cells[i];
    if (i == 0 || cells[i - 1].stream != cell.stream) {
      table.rows.push_back({.section = grid.streams()[cell.stream], .cells = {}});
    }
    TableCell mean = NumberCell(cell.mean, 2);
    mean.low = cell.mean - cell.standard_error;
    mean.high = cell.mean + cell.standard_error;
    table.rows.push_back(
        {.section = "",
         .cells = {TextCell(grid.arms()[cell.arm].name), TextCell(cell.metric.words),
                   NumberCell(cell.runs, 0), NumberCell(cell.inputs, 0), NumberCell(cell.dof, 0),
                   std::move(mean), NumberCell(cell.band.low, 2), NumberCell(cell.band.high, 2),
                   PValueCell(cell.p_holm), TextCell(NeesVerdict(cell, options.alpha))}});
  }
  table.verdict = NeesSentences(grid, cells, options.alpha);
  table.foot = {
      "inputs: of the runs, different; runs on one recording share its noise and are one value, "
      "their "
      "mean",
      "band: where the mean over as many inputs lies for consistent runs with probability " +
          Number(1.0 - options.alpha, 2) +
          ", as if each run were one instant; a run's own value is its mean over time, which "
          "scatters less, so that a mean outside is a finding and one inside proves less",
      "p (Holm): chi-squared test of both sides, corrected over this table; NEES is of the "
      "estimate "
      "without alignment, and a failed run has none"};
  return table;
}

StudyTable FailureTable(const StudyGrid& grid, const StudyTableOptions& options) {
  StudyTable table;
  table.name = "failures";
  table.title = "failures";
  table.columns = {{.title = "run with", .is_text = true},
                   {.title = "runs"},
                   {.title = "failed"},
                   {.title = "failure rate", .unit = "%", .spread = "95 % interval"},
                   {.title = "commonest reason", .is_text = true}};
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    table.rows.push_back({.section = grid.streams()[s], .cells = {}});
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      const StudyCell& cell = grid.cell(s, a);
      const int runs = static_cast<int>(cell.runs.size());
      if (runs == 0) continue;
      TableCell rate = NumberCell(100.0 * cell.failed() / runs, 1);
      const Band interval = WilsonInterval(cell.failed(), runs);
      rate.low = 100.0 * interval.low;
      rate.high = 100.0 * interval.high;
      table.rows.push_back({.section = "",
                            .cells = {TextCell(grid.arms()[a].name), NumberCell(runs, 0),
                                      NumberCell(cell.failed(), 0), std::move(rate),
                                      TextCell(CommonestReason(ReasonsOf(cell)))}});
    }
  }
  table.verdict = FailureSentences(grid, options);
  table.foot = {
      "interval: Wilson's, as if each run had input of its own; who fails more often: McNemar's "
      "exact test of the pairs over "
      "all streams, Holm over the comparisons"};
  return table;
}

}  // namespace duet
