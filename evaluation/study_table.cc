#include "evaluation/study_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/sha256.h"
#include "evaluation/metrics.h"
#include "evaluation/published.h"
#include "evaluation/statistics.h"
#include "evaluation/study_comparison.h"
#include "evaluation/study_gains.h"
#include "evaluation/study_grid.h"
#include "evaluation/study_table_parts.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

/// Up to so many arms stand side by side, as papers have them; more stand below one another.
constexpr std::size_t kMostWideArms = 3;

std::vector<TableCell> CellsOfArm(const StudyCell& cell, const Metric& metric) {
  const std::vector<double> values = cell.Magnitudes(metric);
  const ErrorSummary summary = Summarize(values);
  TableCell median = NumberCell(summary.median, metric.decimals);
  if (values.size() > 1) {
    median.low = summary.p25;
    median.high = summary.p75;
  }
  std::vector<TableCell> cells = {median, TextCell(cell.FailedText())};
  if (metric.key != "coverage_share") {
    cells.push_back(NumberCell(Summarize(cell.Values("coverage_share")).median, 3));
  }
  return cells;
}

std::vector<TableColumn> ColumnsOfArm(const Metric& metric, const std::string& group) {
  std::vector<TableColumn> columns = {
      {.title = "median", .unit = metric.unit, .group = group, .spread = "quartiles"},
      {.title = "failed", .group = group}};
  if (metric.key != "coverage_share") columns.push_back({.title = "coverage", .group = group});
  return columns;
}

/// An arm in a stream's contest.
struct Contestant {
  TableCell* median = nullptr;
  /// The median score of all runs, a failed one's being the worst: infinite where half of them
  /// failed. It is not the median that is shown, which is of those that did not fail.
  double score = std::numeric_limits<double>::infinity();
  double coverage = std::numeric_limits<double>::quiet_NaN();
  double failed_share = 0.0;
};

/// Marks best and second among the contestants' medians. One that covers less, or fails more often,
/// than the best of the others in that is not marked.
void MarkBest(std::vector<Contestant> contestants, const StudyTableOptions& options) {
  double best_coverage = 0.0;
  double least_failed = 1.0;
  for (const Contestant& one : contestants) {
    best_coverage = std::fmax(best_coverage, one.coverage);
    least_failed = std::fmin(least_failed, one.failed_share);
  }
  std::erase_if(contestants,
                [](const Contestant& one) { return !std::isfinite(one.median->value); });
  if (contestants.size() < 2) return;
  std::erase_if(contestants, [&](const Contestant& one) {
    return one.coverage < best_coverage - options.coverage_tolerance ||
           one.failed_share > least_failed + options.failure_tolerance || !std::isfinite(one.score);
  });
  if (contestants.empty()) return;
  std::stable_sort(contestants.begin(), contestants.end(),
                   [](const Contestant& a, const Contestant& b) { return a.score < b.score; });
  // Nobody is better where all are equal.
  if (contestants.size() > 1 && contestants.front().score == contestants.back().score) return;
  TableMark mark = TableMark::kBest;
  for (std::size_t i = 0; i < contestants.size() && mark != TableMark::kNone; ++i) {
    if (i > 0 && contestants[i].score > contestants[i - 1].score) {
      // Where two share the first place there is no second.
      mark = mark == TableMark::kBest && i == 1 ? TableMark::kSecondBest : TableMark::kNone;
    }
    contestants[i].median->mark = mark;
  }
}

double MedianScoreOfAll(const StudyCell& cell, const Metric& metric) {
  std::vector<double> scores;
  for (const double value : cell.Values(metric.key)) scores.push_back(metric.Score(value));
  if (scores.empty()) return std::numeric_limits<double>::infinity();
  // Finite, so that the quantile between two of them is a number.
  constexpr double kWorst = std::numeric_limits<double>::max() / 4.0;
  scores.insert(scores.end(), static_cast<std::size_t>(cell.failed()), kWorst);
  const double median = Summarize(scores).median;
  return median < kWorst / 4.0 ? median : std::numeric_limits<double>::infinity();
}

void MarkStream(const StudyGrid& grid, std::size_t stream, const Metric& metric,
                const StudyTableOptions& options, const std::vector<TableCell*>& medians) {
  if (metric.better == Better::kNeither) return;
  std::vector<Contestant> contestants;
  for (std::size_t a = 0; a < grid.arms().size(); ++a) {
    const StudyCell& cell = grid.cell(stream, a);
    // Coverage itself is the metric that tells who covers less.
    const double coverage =
        metric.key == "coverage_share" ? 1.0 : Summarize(cell.Values("coverage_share")).median;
    const double runs = std::max(1.0, static_cast<double>(cell.runs.size()));
    contestants.push_back(
        {medians[a], MedianScoreOfAll(cell, metric), coverage, cell.failed() / runs});
  }
  MarkBest(std::move(contestants), options);
}

/// The arms side by side, and the mean of their medians over the streams.
void AddWideRows(const StudyGrid& grid, const Metric& metric, const StudyTableOptions& options,
                 StudyTable* table) {
  table->columns.push_back({.title = "stream", .is_text = true});
  for (const StudyArm& arm : grid.arms()) {
    for (TableColumn& column : ColumnsOfArm(metric, arm.name)) {
      table->columns.push_back(std::move(column));
    }
  }
  std::vector<double> sums(grid.arms().size(), 0.0);
  int streams = 0;
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    TableRow row;
    row.cells.push_back(TextCell(grid.streams()[s]));
    std::vector<std::size_t> median_at;
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      median_at.push_back(row.cells.size());
      for (TableCell& cell : CellsOfArm(grid.cell(s, a), metric)) {
        row.cells.push_back(std::move(cell));
      }
    }
    std::vector<TableCell*> medians;
    for (const std::size_t at : median_at) medians.push_back(&row.cells[at]);
    MarkStream(grid, s, metric, options, medians);
    if (!IsChaosStream(options, grid.streams()[s])) {
      ++streams;
      for (std::size_t a = 0; a < sums.size(); ++a) sums[a] += medians[a]->value;
    }
    table->rows.push_back(std::move(row));
  }
  if (streams < 2) return;
  TableRow mean;
  mean.cells.push_back(TextCell("mean of " + std::to_string(streams) + " streams"));
  for (const double sum : sums) {
    mean.cells.push_back(NumberCell(sum / streams, metric.decimals));
    while ((mean.cells.size() - 1) % ((table->columns.size() - 1) / sums.size()) != 0) {
      mean.cells.push_back(TextCell(""));
    }
  }
  table->rows.push_back(std::move(mean));
}

void AddLongRows(const StudyGrid& grid, const Metric& metric, const StudyTableOptions& options,
                 StudyTable* table) {
  table->columns.push_back({.title = "run with", .is_text = true});
  for (TableColumn& column : ColumnsOfArm(metric, "")) table->columns.push_back(std::move(column));
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    table->rows.push_back({.section = grid.streams()[s], .cells = {}});
    const std::size_t first = table->rows.size();
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      TableRow row;
      row.cells.push_back(TextCell(grid.arms()[a].name));
      for (TableCell& cell : CellsOfArm(grid.cell(s, a), metric)) {
        row.cells.push_back(std::move(cell));
      }
      table->rows.push_back(std::move(row));
    }
    std::vector<TableCell*> medians;
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      medians.push_back(&table->rows[first + a].cells[1]);
    }
    MarkStream(grid, s, metric, options, medians);
  }
}

StudyTable MetricTable(const StudyGrid& grid, const Metric& metric,
                       const StudyTableOptions& options) {
  StudyTable table;
  table.name = metric.key;
  table.title = metric.Title() + ", median [quartiles] over the runs that did not fail";
  if (grid.arms().size() <= kMostWideArms) {
    AddWideRows(grid, metric, options, &table);
  } else {
    AddLongRows(grid, metric, options, &table);
  }
  table.foot.push_back(
      "failed: of how many runs; coverage: median share of the span; one that covers " +
      Number(options.coverage_tolerance, 2) + " less than another, or fails in " +
      Number(100.0 * options.failure_tolerance, 0) +
      " % more of its runs, is not marked; failed runs rank worst");
  if (metric.better == Better::kNearZero) {
    table.foot.push_back("the median is of the magnitude of the error");
  }
  return table;
}

void CheckNames(const StudyGrid& grid, const StudyTableOptions& options) {
  if (grid.streams().empty()) throw InputError("the study has no runs");
  for (const std::string& chaos : options.chaos_streams) {
    const auto& streams = grid.streams();
    if (std::find(streams.begin(), streams.end(), chaos) == streams.end()) {
      throw InputError("no stream of the study is called \"" + chaos + "\"" +
                       DidYouMean(chaos, streams));
    }
  }
}

bool AnyRunHas(const StudyResult& study, const std::string& metric) {
  return std::any_of(study.runs.begin(), study.runs.end(), [&](const StudyRun& run) {
    return !run.failed && std::isfinite(MetricValue(run, metric));
  });
}

/// What belongs to every table: what was switched on, and the records.
std::vector<std::string> CommonFoot(const StudyGrid& grid, const StudyTableOptions& options) {
  std::vector<std::string> foot = grid.study().foot;
  for (const std::string& chaos : options.chaos_streams) {
    foot.push_back(chaos + ": runs that differ by pixel jitter only; in no comparison");
  }
  std::vector<std::string> ids;
  for (const StudyRun& run : grid.study().runs) ids.push_back(run.id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::string lines;
  for (const std::string& id : ids) lines += id + "\n";
  foot.push_back("study " + grid.study().name + ": made from " + std::to_string(ids.size()) +
                 " different runs, those of runs.csv; SHA-256 of their sorted ids, one a line: " +
                 Sha256Hex(lines));
  return foot;
}

}  // namespace

TableCell TextCell(std::string text) {
  TableCell cell;
  cell.text = std::move(text);
  cell.is_blank = true;
  return cell;
}

TableCell NumberCell(double value, int decimals) {
  TableCell cell;
  cell.value = value;
  cell.decimals = decimals;
  return cell;
}

TableCell PValueCell(double p) {
  TableCell cell = NumberCell(p, 4);
  if (p < 0.0001) cell.text = "<0.0001";
  return cell;
}

bool IsChaosStream(const StudyTableOptions& options, const std::string& stream) {
  return std::find(options.chaos_streams.begin(), options.chaos_streams.end(), stream) !=
         options.chaos_streams.end();
}

ComparedAxis ComparedAxisFromName(const std::string& name) {
  if (name == "estimators") return ComparedAxis::kEstimators;
  if (name == "settings") return ComparedAxis::kSettings;
  if (name == "perturbations") return ComparedAxis::kPerturbations;
  throw InputError("", 0, "compare",
                   "expected estimators, settings or perturbations, got \"" + name + "\"" +
                       DidYouMean(name, {"estimators", "settings", "perturbations"}));
}

std::vector<StudyTable> MakeStudyTables(const StudyResult& study,
                                        const StudyTableOptions& options) {
  const StudyGrid grid(study);
  CheckNames(grid, options);
  std::vector<StudyTable> tables;
  std::vector<Metric> nees;
  for (const std::string& key : options.metrics) {
    const Metric metric = MetricOf(key);
    if (metric.is_nees()) {
      nees.push_back(metric);
      continue;
    }
    StudyTable table = MetricTable(grid, metric, options);
    if (!AnyRunHas(study, key)) {
      table.verdict = "No run that did not fail has a " + metric.words + ".";
      tables.push_back(std::move(table));
      continue;
    }
    const MetricComparison comparison = CompareArms(grid, metric, options);
    table.verdict = VerdictSentences(comparison);
    tables.push_back(std::move(table));
    if (!comparison.arms.empty()) tables.push_back(PairedTable(comparison, options));
    if (const auto gains = CompareGains(grid, metric, options)) {
      tables.push_back(GainsTable(*gains, options));
    }
  }
  if (!nees.empty()) tables.push_back(NeesTable(grid, nees, options));
  tables.push_back(FailureTable(grid, options));
  for (StudyTable& table : SensitivityTables(grid, options)) tables.push_back(std::move(table));
  if (options.published != nullptr) {
    for (StudyTable& table : PublishedTables(grid, *options.published)) {
      tables.push_back(std::move(table));
    }
  }
  const std::vector<std::string> foot = CommonFoot(grid, options);
  for (StudyTable& table : tables) {
    table.foot.insert(table.foot.end(), foot.begin(), foot.end());
  }
  return tables;
}

}  // namespace duet
