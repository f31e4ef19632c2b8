#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/metrics.h"
#include "evaluation/published.h"
#include "evaluation/statistics.h"
#include "evaluation/study_table_parts.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

/// Of a sequence's way; starts a second later leave out less.
constexpr double kLeastPart = 0.8;
constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

double PublishedValue(const PublishedNumbers& numbers, const std::string& sequence,
                      double PublishedRow::*field) {
  for (const PublishedRow& row : numbers.rows) {
    if (row.sequence == sequence) return row.*field;
  }
  return kNotGiven;
}

/// Sequences of which something is published, in the order in which they are first named.
std::vector<std::string> PublishedNames(const Published& published) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const auto& sequences : published.sequences) {
    for (const SequenceRow& row : sequences.rows) add(row.sequence);
  }
  for (const auto& numbers : published.numbers) {
    for (const PublishedRow& row : numbers.rows) add(row.sequence);
  }
  return names;
}

std::optional<std::size_t> StreamNamed(const StudyGrid& grid, const std::string& name) {
  const auto found = std::find(grid.streams().begin(), grid.streams().end(), name);
  if (found == grid.streams().end()) return std::nullopt;
  return static_cast<std::size_t>(found - grid.streams().begin());
}

double MedianOfCell(const StudyGrid& grid, std::size_t stream, std::size_t arm,
                    const Metric& metric) {
  return Summarize(grid.cell(stream, arm).Values(metric.key)).median;
}

/// How much of the published sequence the study's recording has, by the way of its truth; 1 where
/// one of the two is not known.
double PartOfSequence(const StudyGrid& grid, std::size_t stream, const Published& published,
                      const std::string& sequence) {
  double way_m = 0.0;
  for (std::size_t a = 0; a < grid.arms().size(); ++a) {
    for (const double value : grid.cell(stream, a).Values("truth.way_m")) {
      way_m = std::fmax(way_m, value);
    }
  }
  for (const PublishedSequences& sequences : published.sequences) {
    for (const SequenceRow& row : sequences.rows) {
      if (row.sequence == sequence && way_m > 0.0) return way_m / row.length_m;
    }
  }
  return 1.0;
}

std::string SequencesText(int count) {
  return std::to_string(count) + (count == 1 ? " sequence" : " sequences");
}

/// The thesis's table 8.1, of one of its two errors.
StudyTable ErrorsBesidePublished(const StudyGrid& grid, const Published& published,
                                 const Metric& metric, double PublishedRow::*field,
                                 const std::vector<std::string>& sequences) {
  StudyTable table;
  table.name = "published." + metric.key;
  table.title = metric.Title() + " beside published numbers";
  table.columns.push_back({.title = "sequence", .is_text = true});
  for (const StudyArm& arm : grid.arms())
    table.columns.push_back({.title = arm.name, .group = "Duet, median"});
  std::vector<const PublishedNumbers*> with_field;
  for (const PublishedNumbers& numbers : published.numbers) {
    if (std::none_of(numbers.rows.begin(), numbers.rows.end(),
                     [&](const PublishedRow& row) { return std::isfinite(row.*field); })) {
      continue;
    }
    with_field.push_back(&numbers);
    table.columns.push_back({.title = numbers.name, .group = "published"});
    table.foot.push_back(numbers.name + ": " + numbers.covers +
                         "; alignment: " + numbers.alignment + "; source: " + numbers.source +
                         (numbers.note.empty() ? "" : "; " + numbers.note));
  }
  // The mean is over the sequences that were run: a mean over others says nothing beside it.
  std::vector<double> sums(table.columns.size() - 1, 0.0);
  int run = 0;
  int pieces = 0;
  for (const std::string& sequence : sequences) {
    TableRow row;
    const std::optional<std::size_t> stream = StreamNamed(grid, sequence);
    const double part = stream ? PartOfSequence(grid, *stream, published, sequence) : 0.0;
    // What is published is of the whole sequence: a piece of it is another.
    const bool whole = part >= kLeastPart;
    row.cells.push_back(TextCell(
        stream && !whole ? sequence + " (" + Number(100.0 * part, 0) + " % of it)" : sequence));
    for (std::size_t a = 0; a < grid.arms().size(); ++a) {
      row.cells.push_back(
          NumberCell(stream ? MedianOfCell(grid, *stream, a, metric) : kNotGiven, 3));
    }
    for (const PublishedNumbers* numbers : with_field) {
      row.cells.push_back(NumberCell(PublishedValue(*numbers, sequence, field), 3));
    }
    if (stream && !whole) ++pieces;
    if (stream && whole) {
      ++run;
      for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += row.cells[c + 1].value;
    }
    table.rows.push_back(std::move(row));
  }
  const std::string beside =
      "published numbers stand beside these and not in one ranking, because their alignments, "
      "starts and cameras differ" +
      (pieces == 0
           ? std::string()
           : ", and " + SequencesText(pieces) + " run in part only, of which they say nothing");
  if (run == 0) {
    table.verdict = "No sequence was run whole: " + beside + ".";
    return table;
  }
  TableRow mean;
  mean.cells.push_back(TextCell("mean of the " + std::to_string(run) + " run whole"));
  for (const double sum : sums) mean.cells.push_back(NumberCell(sum / run, 3));
  table.rows.push_back(std::move(mean));
  std::string own;
  for (std::size_t a = 0; a < grid.arms().size(); ++a) {
    own += (a == 0 ? "" : ", ") + grid.arms()[a].name + " " + Number(sums[a] / run, 3) + " " +
           metric.unit;
  }
  table.verdict = "Over the " + SequencesText(run) + " of " + std::to_string(sequences.size()) +
                  " that were run whole the mean is: " + own + "; " + beside + ".";
  return table;
}

/// The thesis's table 7.1: what is published of a sequence, and what its truth says.
StudyTable SequencesTable(const StudyGrid& grid, const PublishedSequences& sequences) {
  struct Property {
    const char* metric;
    double SequenceRow::*field;
  };
  constexpr Property kProperties[] = {{"truth.way_m", &SequenceRow::length_m},
                                      {"truth.duration_s", &SequenceRow::duration_s},
                                      {"truth.speed_m_per_s", &SequenceRow::speed_m_per_s},
                                      {"truth.rate_rad_per_s", &SequenceRow::rate_rad_per_s}};
  StudyTable table;
  table.name = "sequences";
  table.title = "sequences: what their truth says, and " + sequences.name;
  table.columns.push_back({.title = "sequence", .is_text = true});
  for (const Property& property : kProperties) {
    const Metric metric = MetricOf(property.metric);
    table.columns.push_back({.title = "truth", .unit = metric.unit, .group = metric.words});
    table.columns.push_back({.title = "published", .unit = metric.unit, .group = metric.words});
  }
  table.columns.push_back({.title = "remark", .is_text = true});
  double largest = 0.0;
  double smallest = std::numeric_limits<double>::infinity();
  int compared = 0;
  for (const SequenceRow& sequence : sequences.rows) {
    TableRow row;
    row.cells.push_back(TextCell(sequence.sequence));
    const std::optional<std::size_t> stream = StreamNamed(grid, sequence.sequence);
    for (const Property& property : kProperties) {
      const Metric metric = MetricOf(property.metric);
      // The truth is the same for every run, unless it starts later: the longest counts.
      double own = kNotGiven;
      for (std::size_t a = 0; stream && a < grid.arms().size(); ++a) {
        for (const double value : grid.cell(*stream, a).Values(metric.key)) {
          own = std::fmax(own, value);
        }
      }
      const double theirs = sequence.*property.field;
      row.cells.push_back(NumberCell(own, metric.decimals));
      row.cells.push_back(NumberCell(theirs, metric.decimals));
      if (property.field == &SequenceRow::length_m && std::isfinite(own)) {
        ++compared;
        largest = std::fmax(largest, own / theirs);
        smallest = std::fmin(smallest, own / theirs);
      }
    }
    row.cells.push_back(TextCell(sequence.remark));
    table.rows.push_back(std::move(row));
  }
  table.verdict = compared == 0
                      ? "No run has the metrics of its truth."
                      : "Of " + SequencesText(compared) + " run, the truth's way is " +
                            Number(100.0 * smallest, 0) +
                            (compared == 1 ? std::string() : " to " + Number(100.0 * largest, 0)) +
                            " % of the published length.";
  table.foot = {"published: " + sequences.source,
                "truth: its way in steps of 0.1 s, of the span that is evaluated"};
  return table;
}

}  // namespace

std::vector<StudyTable> PublishedTables(const StudyGrid& grid, const Published& published) {
  const std::vector<std::string> sequences = PublishedNames(published);
  std::vector<StudyTable> tables;
  if (std::none_of(sequences.begin(), sequences.end(), [&](const std::string& sequence) {
        return StreamNamed(grid, sequence).has_value();
      })) {
    return tables;
  }
  if (!published.numbers.empty()) {
    tables.push_back(ErrorsBesidePublished(grid, published, MetricOf("ate.position_m"),
                                           &PublishedRow::position_rmse_m, sequences));
    tables.push_back(ErrorsBesidePublished(grid, published, MetricOf("ate.orientation_deg"),
                                           &PublishedRow::orientation_rmse_deg, sequences));
  }
  for (const PublishedSequences& of_sequences : published.sequences) {
    tables.push_back(SequencesTable(grid, of_sequences));
  }
  return tables;
}

}  // namespace duet
