#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "evaluation/study_result.h"

namespace duet {

/// A table of a study: numbers, what they are of, and one sentence that says what they mean. The
/// same table is written for a terminal, as CSV, Markdown and LaTeX.

enum class TableMark { kNone, kBest, kSecondBest };

struct TableCell {
  /// Shown instead of the number where it is not empty; CSV has the number where there is one.
  std::string text;
  double value = std::numeric_limits<double>::quiet_NaN();
  /// Its spread, as the column says; NaN: none.
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
  int decimals = 3;
  bool is_blank = false;  ///< without text or number nothing is shown, instead of "-"
  TableMark mark = TableMark::kNone;
};

struct TableColumn {
  std::string title;
  std::string unit = {};    ///< of its numbers; empty: none
  std::string group = {};   ///< stands over columns beside one another that share it
  std::string spread = {};  ///< of its cells: "quartiles", "95 % interval"; empty: none
  bool is_text = false;     ///< left-aligned
};

struct TableRow {
  std::string section;  ///< not empty: a line over the rows after it, without cells
  std::vector<TableCell> cells;
};

struct StudyTable {
  std::string name;   ///< of its files: "ate.position_m.paired"
  std::string title;  ///< "position error (ATE) [m], median [quartiles]"
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
  std::string
      verdict;  ///< who is better, by how much, how sure: a sentence a comparison, a line each
  std::vector<std::string> foot;  ///< how to read it, what was switched on, from which records
};

/// What the pairs differ in that the paired tables test.
enum class ComparedAxis { kEstimators, kSettings, kPerturbations };
/// "estimators", "settings", "perturbations"; throws InputError for another name.
[[nodiscard]] ComparedAxis ComparedAxisFromName(const std::string& name);

struct Published;  // evaluation/published.h

struct StudyTableOptions {
  /// Keys of evaluation/metrics.h, in the order of the tables.
  std::vector<std::string> metrics = {"ate.position_m", "ate.orientation_deg", "coverage_share",
                                      "nees.pose"};
  ComparedAxis compare = ComparedAxis::kEstimators;
  /// The setting or perturbation that the others are compared with; empty: the grid's first.
  std::string baseline;
  /// Streams whose runs differ by pixel jitter only: what differences mean nothing (DESIGN.md
  /// section 5.6). They are in no comparison.
  std::vector<std::string> chaos_streams;
  /// The probability of any wrong "better" in a table.
  double alpha = 0.05;
  /// An estimator that covers less than the other by more than this is not called more accurate.
  double coverage_tolerance = 0.02;
  /// One that fails in a larger share of its runs than another by more than this is not marked as
  /// best or second, whatever the runs say that are left.
  double failure_tolerance = 0.1;
  int bootstrap_resamples = 2000;
  /// Of published numbers to stand beside (ReadPublished); none where it is not given.
  std::shared_ptr<const Published> published;
};

/// Every table of a study, from its records alone:
///   METRIC          for each metric but NEES: streams x (estimator, setting, perturbation), median
///                   [quartiles] of the runs that did not fail, runs, failures, coverage; best and
///                   second of each stream marked, failed runs ranking worst
///   METRIC.paired   who is better: pairs on the same stream and seed (evaluation/paired_test.h),
///                   for each stream and over all of them, p-values corrected by Holm over the
///                   table
///   METRIC.gains    where settings or perturbations are compared with a baseline: which of two
///                   estimators gains more by each (evaluation/study_gains.h), likewise corrected
///   nees            NEES with its chi-squared band, where such a metric is asked for
///   sensitivity     whether the verdict depends on alignment and segment length, where the records
///                   have more than one measure of an error
///   published.METRIC, sequences   beside options.published, where streams have their sequences'
///                   names
///   failures        how often each fails, with Wilson's interval, and McNemar's test
/// Throws InputError for a metric, baseline or chaos stream that there is not, and for a study
/// without runs.
[[nodiscard]] std::vector<StudyTable> MakeStudyTables(const StudyResult& study,
                                                      const StudyTableOptions& options = {});

/// The first table of a study, for its summary: what `tables` say, and each stream and (estimator,
/// setting, perturbation) with its runs, failures, and one number a metric: what the metric's own
/// table shows (median of the runs that did not fail; of signed errors the median magnitude; of
/// NEES the mean over inputs), to the metric's digits. Throws InputError for a metric that there is
/// not.
[[nodiscard]] StudyTable SummaryTable(const StudyResult& study,
                                      const std::vector<std::string>& metrics,
                                      const std::vector<StudyTable>& tables);

/// A sentence or a foot in lines that a terminal shows whole (100 columns), the later ones
/// indented.
[[nodiscard]] std::string ParagraphText(const std::string& text);
/// A verdict's sentences; empty where it is.
[[nodiscard]] std::vector<std::string> SentencesOfVerdict(const std::string& verdict);

/// For a terminal: aligned, best marked `*`, second `+`.
[[nodiscard]] std::string TableText(const StudyTable& table);
/// For programs: title, verdict and foot as lines that begin with '#', one line of column names,
/// full precision; a spread has two columns of its own, a mark one; a section is the first column.
[[nodiscard]] std::string TableCsv(const StudyTable& table);
/// GitHub's; best bold, second in italics.
[[nodiscard]] std::string TableMarkdown(const StudyTable& table);
/// A `table` environment for \input; needs \usepackage{booktabs,graphicx}. Best bold, second
/// underlined; shrunk to the line where it is wider.
[[nodiscard]] std::string TableLatex(const StudyTable& table);

}  // namespace duet
