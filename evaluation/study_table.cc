#include "evaluation/study_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/sha256.h"
#include "evaluation/metrics.h"
#include "evaluation/published.h"
#include "evaluation/statistics.h"
#include "evaluation/study_comparison.h"
#include "evaluation/study_grid.h"
#include "evaluation/study_table_parts.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

/// Up to so many arms stand side by side, as papers have them; more stand below one another.
constexpr std::size_t kMostWideArms = 3;

std::vector<TableCell> CellsOfArm(const StudyCell& cell, const Metric& metric) {
  std::vector<double> values = cell.Values(metric.key);
  // Signed errors that cancel are not accurate.
  if (metric.better == Better::kNearZero) {
    for (double& value : values) value = std::abs(value);
  }
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

/// Marks best and second among the medians at `at` of `rows`' cells. One that covers less than the
/// best coverage beside it is not marked.
void MarkBest(const Metric& metric, double coverage_tolerance, std::vector<TableCell*> medians,
              const std::vector<double>& coverages) {
  if (metric.better == Better::kNeither) return;
  double best_coverage = 0.0;
  for (const double coverage : coverages) best_coverage = std::fmax(best_coverage, coverage);
  std::vector<std::pair<double, TableCell*>> ranked;
  int with_value = 0;
  for (std::size_t i = 0; i < medians.size(); ++i) {
    if (!std::isfinite(medians[i]->value)) continue;
    ++with_value;
    if (coverages[i] < best_coverage - coverage_tolerance) continue;
    ranked.emplace_back(metric.Score(medians[i]->value), medians[i]);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (with_value < 2 || ranked.empty()) return;
  // Nobody is better where all are equal.
  if (ranked.size() > 1 && ranked.front().first == ranked.back().first) return;
  TableMark mark = TableMark::kBest;
  for (std::size_t i = 0; i < ranked.size() && mark != TableMark::kNone; ++i) {
    if (i > 0 && ranked[i].first > ranked[i - 1].first) {
      // Where two share the first place there is no second.
      mark = mark == TableMark::kBest && i == 1 ? TableMark::kSecondBest : TableMark::kNone;
    }
    ranked[i].second->mark = mark;
  }
}

void MarkStream(const StudyGrid& grid, std::size_t stream, const Metric& metric,
                double coverage_tolerance, const std::vector<TableCell*>& medians) {
  std::vector<double> coverages;
  for (std::size_t a = 0; a < grid.arms().size(); ++a) {
    // Coverage itself is the metric that tells who covers less.
    coverages.push_back(metric.key == "coverage_share"
                            ? 1.0
                            : Summarize(grid.cell(stream, a).Values("coverage_share")).median);
  }
  MarkBest(metric, coverage_tolerance, medians, coverages);
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
    MarkStream(grid, s, metric, options.coverage_tolerance, medians);
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
    MarkStream(grid, s, metric, options.coverage_tolerance, medians);
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
      Number(options.coverage_tolerance, 2) + " less than another is not marked best");
  if (metric.better == Better::kNearZero) {
    table.foot.push_back("the median is of the magnitude of the error");
  }
  return table;
}

TableCell EffectCell(double value, const Band& interval, int decimals) {
  TableCell cell = NumberCell(value, decimals);
  cell.low = interval.low;
  cell.high = interval.high;
  return cell;
}

StudyTable PairedTable(const MetricComparison& comparison, const StudyTableOptions& options) {
  const Metric& metric = comparison.metric;
  StudyTable table;
  table.name = metric.key + ".paired";
  table.title = metric.Title() + ": pairs on the same stream and seed";
  table.columns = {{.title = "stream", .is_text = true},
                   {.title = "pairs"},
                   {.title = "one failed"},
                   {.title = "ratio", .spread = "95 % interval"},
                   {.title = "difference", .unit = metric.unit, .spread = "95 % interval"},
                   {.title = "p"},
                   {.title = "p (Holm)"},
                   {.title = "better", .is_text = true}};
  for (const ArmComparison& arms : comparison.arms) {
    table.rows.push_back({.section = arms.first + " / " + arms.second, .cells = {}});
    for (const ComparisonRow& row : arms.rows) {
      const PairedComparison& paired = row.paired;
      table.rows.push_back(
          {.section = "",
           .cells = {TextCell(row.stream.empty() ? "all streams" : row.stream),
                     NumberCell(paired.pairs, 0),
                     TextCell(std::to_string(paired.only_first_failed) + " : " +
                              std::to_string(paired.only_second_failed)),
                     EffectCell(paired.ratio, paired.ratio_interval, 3),
                     EffectCell(paired.difference, paired.difference_interval, metric.decimals),
                     PValueCell(std::isnan(row.p_holm) ? row.p_holm : paired.test.p_value),
                     PValueCell(row.p_holm), TextCell(DecisionText(arms, row.decision))}});
    }
  }
  table.verdict = VerdictSentence(comparison);
  table.foot = {
      "ratio, difference: first / second, first - second, Hodges-Lehmann estimates of the pairs of "
      "which both ran, with BCa bootstrap intervals (" +
          std::to_string(options.bootstrap_resamples) + " resamples within each stream)",
      "p: Wilcoxon's signed-rank test of the pairs, of both sides, zeros by Pratt's rule; a pair "
      "of "
      "which one run failed has the largest rank of all, to the other's favour; one of which both "
      "failed is left out; exact up to 50 pairs; all streams: these streams, not others like them",
      "runs on identical input (starts or jitter on one recording) are one pair, of their medians; "
      "streams of one pair each are resampled together",
      "p (Holm): corrected over the " + std::to_string(comparison.tests) +
          " tests of this table; better where it is at most " + Number(options.alpha, 2)};
  const auto few = [](const ComparisonRow& row) {
    return row.paired.pairs >= kMinBootstrapValues && row.paired.pairs < 20;
  };
  if (std::any_of(comparison.arms.begin(), comparison.arms.end(), [&](const ArmComparison& arms) {
        return std::any_of(arms.rows.begin(), arms.rows.end(), few);
      })) {
    table.foot.push_back(
        "intervals of fewer than 20 pairs are too short: they hold the truth in about 92 of 100 "
        "cases with 10 pairs, in 88 with 6; the test is exact");
  }
  for (const ArmComparison& arms : comparison.arms) {
    if (std::isnan(arms.chaos_floor)) continue;
    table.foot.push_back("chaos floor of " + arms.first + " / " + arms.second +
                         ": two runs that differ by pixel jitter alone typically differ by " +
                         (arms.overall().paired.is_ratio
                              ? "a factor of " + Number(arms.chaos_floor, 3)
                              : Number(arms.chaos_floor, metric.decimals) +
                                    (metric.unit.empty() ? "" : " " + metric.unit)) +
                         "; smaller differences are no verdict");
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
  foot.push_back(
      "study " + grid.study().name + ": made from " + std::to_string(ids.size()) +
      " records, those of runs.csv; SHA-256 of their sorted ids, one a line: " + Sha256Hex(lines));
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
    table.verdict = VerdictSentence(comparison);
    tables.push_back(std::move(table));
    if (!comparison.arms.empty()) tables.push_back(PairedTable(comparison, options));
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
