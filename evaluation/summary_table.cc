#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "evaluation/metrics.h"
#include "evaluation/statistics.h"
#include "evaluation/study_grid.h"
#include "evaluation/study_table_parts.h"

namespace duet {
namespace {

/// The same number as in the metric's own table: of NEES the mean over inputs, of an error with a
/// sign the median magnitude.
double SummaryValue(const StudyCell& cell, const Metric& metric) {
  if (metric.is_nees()) return Summarize(cell.MeansByInput(metric.key)).mean;
  return Summarize(cell.Magnitudes(metric)).median;
}

}  // namespace

StudyTable SummaryTable(const StudyResult& study, const std::vector<std::string>& metrics,
                        const std::vector<StudyTable>& tables) {
  std::vector<Metric> shown;
  for (const std::string& key : metrics) shown.push_back(MetricOf(key));
  StudyTable table;
  table.name = "summary";
  table.title = study.name + (study.question.empty() ? "" : ": " + study.question);
  table.columns = {{.title = "run with", .is_text = true}, {.title = "runs"}, {.title = "failed"}};
  bool any_nees = false;
  bool any_signed = false;
  for (const Metric& metric : shown) {
    table.columns.push_back({.title = metric.words, .unit = metric.unit});
    any_nees = any_nees || metric.is_nees();
    any_signed = any_signed || metric.better == Better::kNearZero;
  }
  const StudyGrid grid(study);
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    table.rows.push_back({.section = grid.streams()[s], .cells = {}});
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      const StudyCell& cell = grid.cell(s, a);
      if (cell.runs.empty()) continue;
      TableRow row;
      row.cells = {TextCell(grid.arms()[a].name),
                   NumberCell(static_cast<double>(cell.runs.size()), 0),
                   NumberCell(cell.failed(), 0)};
      for (const Metric& metric : shown) {
        row.cells.push_back(NumberCell(SummaryValue(cell, metric), metric.decimals));
      }
      table.rows.push_back(std::move(row));
    }
  }
  std::set<std::string> said;  // a metric's two tables have the same verdict
  for (const StudyTable& of : tables) {
    if (of.verdict.empty() || !said.insert(of.verdict).second) continue;
    table.verdict += (table.verdict.empty() ? "" : "\n") + of.verdict;
  }
  table.foot = {std::string("medians over the runs that did not fail") +
                (any_signed ? "; of errors with a sign, of their magnitudes" : "") +
                (any_nees ? "; of NEES the mean" : "")};
  table.foot.insert(table.foot.end(), study.foot.begin(), study.foot.end());
  return table;
}

}  // namespace duet
