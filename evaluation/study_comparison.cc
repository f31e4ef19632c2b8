#include "evaluation/study_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "evaluation/holm.h"
#include "evaluation/statistics.h"
#include "evaluation/study_table_parts.h"

namespace duet {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

double MedianOrNaN(const std::vector<double>& values) {
  return values.empty() ? kNoNumber : Summarize(values).median;
}

/// Indices of the arms of each comparison.
std::vector<std::pair<std::size_t, std::size_t>> ComparedArms(const StudyGrid& grid,
                                                              const StudyTableOptions& options) {
  const bool each_with_each = options.compare == ComparedAxis::kEstimators;
  const std::string baseline = each_with_each ? "" : BaselineOf(grid, options);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < grid.arms().size(); ++a) {
    for (std::size_t b = each_with_each ? a + 1 : 0; b < grid.arms().size(); ++b) {
      if (a == b || !SameBut(grid.arms()[a], grid.arms()[b], options.compare)) continue;
      if (each_with_each || ComparedName(grid.arms()[b], options.compare) == baseline) {
        pairs.emplace_back(a, b);
      }
    }
  }
  return pairs;
}

/// Streams of one pair each are the observations themselves: they are resampled together.
std::vector<std::vector<PairedRuns>> Resampled(std::vector<std::vector<PairedRuns>> strata) {
  std::vector<PairedRuns> single;
  for (const auto& stratum : strata) {
    if (stratum.size() == 1) single.push_back(stratum.front());
  }
  std::erase_if(strata, [](const auto& stratum) { return stratum.size() <= 1; });
  if (!single.empty()) strata.push_back(std::move(single));
  return strata;
}

/// The median difference between two runs of the cell: of logarithms where `ratio`.
double ChaosOf(const StudyCell& cell, const Metric& metric, bool ratio) {
  std::vector<double> values = cell.Values(metric.key);
  for (double& value : values) value = ratio ? std::log(value) : metric.Score(value);
  return MedianPairDifference(values);
}

double ChaosFloor(const StudyGrid& grid, std::size_t first, std::size_t second,
                  const Metric& metric, bool ratio, const StudyTableOptions& options) {
  double floor = kNoNumber;
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    if (!IsChaosStream(options, grid.streams()[s])) continue;
    for (const std::size_t arm : {first, second}) {
      floor = std::fmax(floor, ChaosOf(grid.cell(s, arm), metric, ratio));
    }
  }
  return ratio ? std::exp(floor) : floor;
}

bool BelowChaosFloor(const ComparisonRow& row, double floor) {
  if (std::isnan(floor)) return false;
  // Failures are no matter of chaos.
  if (row.paired.only_first_failed != row.paired.only_second_failed) return false;
  return row.paired.is_ratio ? std::abs(std::log(row.paired.ratio)) < std::log(floor)
                             : std::abs(row.paired.difference) < floor;
}

Decision Decide(const ComparisonRow& row, double chaos_floor, const MetricComparison& comparison,
                const StudyTableOptions& options) {
  const Metric& metric = comparison.metric;
  if (row.paired.informative() == 0 && row.paired.test.zeros > 0) return Decision::kEqual;
  if (!(row.p_holm <= comparison.alpha)) {
    return CanShow(row.paired.informative(), comparison.first_step_alpha()) ? Decision::kNothing
                                                                            : Decision::kTooFew;
  }
  if (metric.better == Better::kNeither) return Decision::kNoDirection;
  if (BelowChaosFloor(row, chaos_floor)) return Decision::kBelowChaos;
  const bool first = row.paired.direction() < 0.0;
  const double gap =
      first ? row.second_coverage - row.first_coverage : row.first_coverage - row.second_coverage;
  if (metric.key != "coverage_share" && gap > options.coverage_tolerance) {
    return Decision::kCoversLess;
  }
  return first ? Decision::kFirstBetter : Decision::kSecondBetter;
}

ArmComparison CompareTwoArms(const StudyGrid& grid, std::size_t first, std::size_t second,
                             const Metric& metric, const StudyTableOptions& options) {
  std::vector<ComparedStream> streams;
  std::vector<std::size_t> indices;
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    if (IsChaosStream(options, grid.streams()[s])) continue;
    StreamPairs pairs = PairsOf(grid.cell(s, first), grid.cell(s, second), metric);
    if (pairs.empty()) continue;
    indices.push_back(s);
    streams.push_back({grid.streams()[s], std::move(pairs), MedianCoverage(grid, {s}, first),
                       MedianCoverage(grid, {s}, second)});
  }
  ArmComparison arms = CompareStreams(streams, metric, options);
  arms.first = grid.arms()[first].name;
  arms.second = grid.arms()[second].name;
  if (arms.rows.size() > 1) {
    arms.rows.back().first_coverage = MedianCoverage(grid, indices, first);
    arms.rows.back().second_coverage = MedianCoverage(grid, indices, second);
  }
  if (!arms.rows.empty()) {
    arms.chaos_floor =
        ChaosFloor(grid, first, second, metric, arms.overall().paired.is_ratio, options);
  }
  return arms;
}

}  // namespace

MetricComparison CompareArms(const StudyGrid& grid, const Metric& metric,
                             const StudyTableOptions& options) {
  MetricComparison comparison;
  comparison.metric = metric;
  comparison.alpha = options.alpha;
  for (const auto& [first, second] : ComparedArms(grid, options)) {
    ArmComparison arms = CompareTwoArms(grid, first, second, metric, options);
    if (!arms.rows.empty()) comparison.arms.push_back(std::move(arms));
  }
  DecideAll(options, &comparison);
  return comparison;
}

double MedianCoverage(const StudyGrid& grid, const std::vector<std::size_t>& streams,
                      std::size_t arm) {
  std::vector<double> values;
  for (const std::size_t s : streams) {
    const std::vector<double> more = grid.cell(s, arm).Values("coverage_share");
    values.insert(values.end(), more.begin(), more.end());
  }
  return MedianOrNaN(values);
}

ArmComparison CompareStreams(const std::vector<ComparedStream>& streams, const Metric& metric,
                             const StudyTableOptions& options) {
  PairedOptions paired_options;
  paired_options.bootstrap.resamples = options.bootstrap_resamples;
  std::vector<StreamPairs> pairs;
  for (const ComparedStream& stream : streams) pairs.push_back(stream.pairs);
  const std::vector<std::vector<PairedRuns>> strata = EachInputOnce(pairs);
  ArmComparison arms;
  for (std::size_t s = 0; s < streams.size(); ++s) {
    const std::vector<PairedRuns> own = OnePairAnInput(streams[s].pairs);
    arms.rows.push_back({.stream = streams[s].name,
                         .repeats = strata[s].empty(),
                         .paired = ComparePairs({&own, 1}, metric, paired_options),
                         .first_coverage = streams[s].first_coverage,
                         .second_coverage = streams[s].second_coverage});
  }
  if (streams.size() > 1) {
    arms.rows.push_back(
        {.stream = "", .paired = ComparePairs(Resampled(strata), metric, paired_options)});
  }
  return arms;
}

void DecideAll(const StudyTableOptions& options, MetricComparison* comparison) {
  std::vector<double> p_values;
  comparison->tests = 0;
  for (const ArmComparison& arms : comparison->arms) {
    for (const ComparisonRow& row : arms.rows) {
      const bool tested = row.paired.informative() > 0 || row.paired.test.zeros > 0;
      p_values.push_back(tested ? row.paired.test.p_value : kNoNumber);
      if (tested) ++comparison->tests;
    }
  }
  const std::vector<double> adjusted = HolmAdjusted(p_values);
  std::size_t i = 0;
  for (ArmComparison& arms : comparison->arms) {
    for (ComparisonRow& row : arms.rows) {
      row.p_holm = adjusted[i++];
      const bool same_kind = row.paired.is_ratio == arms.overall().paired.is_ratio;
      row.decision = Decide(row, same_kind ? arms.chaos_floor : kNoNumber, *comparison, options);
    }
  }
}

double MedianPairDifference(const std::vector<double>& values) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double difference = std::abs(values[i] - values[j]);
      if (std::isfinite(difference)) differences.push_back(difference);
    }
  }
  return MedianOrNaN(differences);
}

int ArmComparison::streams() const {
  const auto end = rows.begin() + static_cast<std::ptrdiff_t>(single_rows());
  return static_cast<int>(
      std::count_if(rows.begin(), end, [](const ComparisonRow& row) { return !row.repeats; }));
}

std::string DecisionText(const ArmComparison& arms, Decision decision) {
  switch (decision) {
    case Decision::kFirstBetter:
      return arms.first;
    case Decision::kSecondBetter:
      return arms.second;
    case Decision::kNothing:
      return "nothing shown";
    case Decision::kEqual:
      return "equal";
    case Decision::kTooFew:
      return "too few pairs";
    case Decision::kBelowChaos:
      return "below the chaos floor";
    case Decision::kCoversLess:
      return "covers less";
    case Decision::kNoDirection:
      return "differ";
  }
  return "";
}

}  // namespace duet
