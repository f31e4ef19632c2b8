#pragma once

#include <string>
#include <vector>

#include "evaluation/metrics.h"
#include "evaluation/study_grid.h"
#include "evaluation/study_table.h"

namespace duet {

struct ArmComparison;     // evaluation/study_comparison.h
struct MetricComparison;  // evaluation/study_comparison.h
struct MetricGains;       // evaluation/study_gains.h

/// The tables that MakeStudyTables puts together, and what they share.

[[nodiscard]] TableCell TextCell(std::string text);
[[nodiscard]] TableCell NumberCell(double value, int decimals);
/// Four digits, "<0.0001" below.
[[nodiscard]] TableCell PValueCell(double p);
[[nodiscard]] bool IsChaosStream(const StudyTableOptions& options, const std::string& stream);

/// METRIC.paired: every comparison of arms, its rows, verdict and how to read it. `comparison` has
/// arms.
[[nodiscard]] StudyTable PairedTable(const MetricComparison& comparison,
                                     const StudyTableOptions& options);
/// How to read estimates, intervals, p-values, the family that Holm's correction is over, and
/// streams on the same input.
[[nodiscard]] std::vector<std::string> PairedFoot(const MetricComparison& comparison,
                                                  const StudyTableOptions& options);

/// ": two runs that differ by pixel jitter alone typically differ by ..."; `what`: "runs".
[[nodiscard]] std::string ChaosFloorText(const ArmComparison& arms, const Metric& metric,
                                         const char* what);

/// METRIC.gains: which estimator gains more by a change from the baseline.
[[nodiscard]] StudyTable GainsTable(const MetricGains& gains, const StudyTableOptions& options);

/// NEES of every stream and arm: the mean over its inputs (runs on identical input are one value,
/// their mean) beside the band in which the mean of as many consistent runs lies with probability
/// 1 - alpha, and the test of it, corrected by Holm over the table. A run's own value is its mean
/// over time: instants of one run depend on one another, by an unknown amount, so that the band is
/// that of one instant a run (as if all instants of a run were one), which is too wide rather than
/// too narrow. A value outside is a finding; one inside proves less than it would for independent
/// instants.
[[nodiscard]] StudyTable NeesTable(const StudyGrid& grid, const std::vector<Metric>& metrics,
                                   const StudyTableOptions& options);

/// Failures of every stream and arm with Wilson's interval, the commonest reason, and whether one
/// arm fails more often than another (McNemar's exact test over all streams, Holm over the pairs of
/// arms that are compared).
[[nodiscard]] StudyTable FailureTable(const StudyGrid& grid, const StudyTableOptions& options);

/// Whether the verdict depends on how position and orientation errors are measured: alignments and
/// lengths of segments, as far as the records have them. None where they have one measure of each.
[[nodiscard]] std::vector<StudyTable> SensitivityTables(const StudyGrid& grid,
                                                        const StudyTableOptions& options);

}  // namespace duet
