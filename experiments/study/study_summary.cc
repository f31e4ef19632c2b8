// StudySummaryText: a study's numbers in one table.

#include <cmath>
#include <map>

#include "evaluation/statistics.h"
#include "evaluation/text_table.h"
#include "experiments/study/study_records.h"

namespace duet {
namespace {

struct SummaryCell {
  std::string stream, estimator, setting, perturbation;
  int runs = 0;
  int failed = 0;
  std::vector<std::vector<double>> values;  // one a metric
};

/// In the order in which they come.
std::vector<SummaryCell> CellsOf(const StudyResult& result,
                                 const std::vector<std::string>& metrics) {
  std::vector<SummaryCell> cells;
  std::map<std::string, std::size_t> index;
  for (const StudyRun& run : result.runs) {
    const std::string key =
        run.stream + "\n" + run.perturbation + "\n" + run.setting + "\n" + run.estimator;
    const auto [found, is_new] = index.emplace(key, cells.size());
    if (is_new) {
      cells.push_back({run.stream, run.estimator, run.setting, run.perturbation, 0, 0, {}});
      cells.back().values.resize(metrics.size());
    }
    SummaryCell& cell = cells[found->second];
    ++cell.runs;
    if (run.failed) {
      ++cell.failed;
      continue;
    }
    for (const auto& [key_of_metric, value] : run.metrics) {
      for (std::size_t i = 0; i < metrics.size(); ++i) {
        if (metrics[i] == key_of_metric) cell.values[i].push_back(value);
      }
    }
  }
  return cells;
}

int DecimalsFor(double value) {
  const double size = std::abs(value);
  return size >= 100.0 ? 1 : size >= 1.0 ? 2 : 4;
}

}  // namespace

std::string StudySummaryText(const StudyResult& result, const std::vector<std::string>& metrics) {
  const std::vector<std::string> shown =
      metrics.empty() ? std::vector<std::string>{"ate.position_m", "ate.orientation_deg",
                                                 "coverage_share", "frame_ms.median"}
                      : metrics;
  std::vector<std::string> header = {"median of the runs", "runs", "failed"};
  header.insert(header.end(), shown.begin(), shown.end());
  TextTable table(header);
  std::string section;
  for (const SummaryCell& cell : CellsOf(result, shown)) {
    const std::string title = cell.stream + ", " + cell.perturbation;
    if (title != section) table.AddSection(title);
    section = title;
    std::vector<std::string> row = {"  " + cell.setting + ", " + cell.estimator,
                                    std::to_string(cell.runs), std::to_string(cell.failed)};
    for (const std::vector<double>& values : cell.values) {
      const double median = Summarize(values).median;
      row.push_back(Number(median, DecimalsFor(median)));
    }
    table.AddRow(row);
  }
  std::string text = result.name + (result.question.empty() ? "" : ": " + result.question) + "\n\n";
  text += table.Text() + "\n";
  for (const std::string& line : result.foot) text += line + "\n";
  return text;
}

}  // namespace duet
