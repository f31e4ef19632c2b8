#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "evaluation/metrics.h"
#include "evaluation/paired_test.h"
#include "evaluation/study_grid.h"
#include "evaluation/study_table.h"

namespace duet {

/// What in a study is paired with what, and which pairs are independent observations.

/// The arm's name on the axis that is compared.
[[nodiscard]] const std::string& ComparedName(const StudyArm& arm, ComparedAxis axis);
/// True where two arms are equal on the other two axes.
[[nodiscard]] bool SameBut(const StudyArm& a, const StudyArm& b, ComparedAxis axis);
/// options.baseline, else the grid's first name on the axis. Throws InputError where nothing is
/// called so.
[[nodiscard]] std::string BaselineOf(const StudyGrid& grid, const StudyTableOptions& options);

/// Pairs on one input: several starts or pixel jitter on one recording, one stream by two names.
struct InputPairs {
  std::string input;  ///< InputOf of its runs
  std::vector<PairedRuns> pairs;
};
/// The pairs of one stream, in the order of its runs.
using StreamPairs = std::vector<InputPairs>;

/// Adds a pair to those on its input.
void AddPair(const std::string& input, const PairedRuns& pair, StreamPairs* stream);

/// Runs of the two cells with the same seed.
[[nodiscard]] StreamPairs PairsOf(const StudyCell& first, const StudyCell& second,
                                  const Metric& metric);

/// One pair an input, the only one that is independent of others: medians of those that ran; failed
/// is who failed in more than half of them.
[[nodiscard]] std::vector<PairedRuns> OnePairAnInput(const StreamPairs& stream);

/// The strata of a test over all streams. An input that several streams have (a recording that is
/// listed twice) counts once, in the first of them; streams that are left without a pair have an
/// empty stratum.
[[nodiscard]] std::vector<std::vector<PairedRuns>> EachInputOnce(
    std::span<const StreamPairs> streams);

}  // namespace duet
