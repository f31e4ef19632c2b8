#include "evaluation/study_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "evaluation/holm.h"
#include "evaluation/statistics.h"
#include "evaluation/study_table_parts.h"

namespace duet {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

double MedianOrNaN(const std::vector<double>& values) {
  return values.empty() ? kNoNumber : Summarize(values).median;
}

/// The name of the axis that is compared, and of the rest.
const std::string& ComparedName(const StudyArm& arm, ComparedAxis axis) {
  return axis == ComparedAxis::kEstimators ? arm.estimator
         : axis == ComparedAxis::kSettings ? arm.setting
                                           : arm.perturbation;
}

bool SameBut(const StudyArm& a, const StudyArm& b, ComparedAxis axis) {
  return (axis == ComparedAxis::kEstimators || a.estimator == b.estimator) &&
         (axis == ComparedAxis::kSettings || a.setting == b.setting) &&
         (axis == ComparedAxis::kPerturbations || a.perturbation == b.perturbation);
}

std::string Baseline(const StudyGrid& grid, const StudyTableOptions& options) {
  std::vector<std::string> names;
  for (const StudyArm& arm : grid.arms()) {
    names.push_back(ComparedName(arm, options.compare));
  }
  if (options.baseline.empty()) return names.empty() ? "" : names.front();
  if (std::find(names.begin(), names.end(), options.baseline) == names.end()) {
    throw InputError("", 0, "baseline",
                     "nothing in the study is called \"" + options.baseline + "\"" +
                         DidYouMean(options.baseline, names));
  }
  return options.baseline;
}

/// Indices of the arms of each comparison.
std::vector<std::pair<std::size_t, std::size_t>> ComparedArms(const StudyGrid& grid,
                                                              const StudyTableOptions& options) {
  const bool each_with_each = options.compare == ComparedAxis::kEstimators;
  const std::string baseline = each_with_each ? "" : Baseline(grid, options);
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

/// One pair of what several runs on identical input say: starts or pixel jitter on one recording
/// are no independent observations of who is better. Medians of those that ran; failed is who
/// failed in more than half of them.
PairedRuns OnePairOf(const std::vector<PairedRuns>& pairs) {
  if (pairs.size() == 1) return pairs.front();
  std::vector<double> first;
  std::vector<double> second;
  std::size_t first_failed = 0;
  std::size_t second_failed = 0;
  for (const PairedRuns& pair : pairs) {
    first_failed += pair.first_failed ? 1 : 0;
    second_failed += pair.second_failed ? 1 : 0;
    if (pair.first_failed || pair.second_failed) continue;
    if (!std::isfinite(pair.first) || !std::isfinite(pair.second)) continue;
    first.push_back(pair.first);
    second.push_back(pair.second);
  }
  return {MedianOrNaN(first), MedianOrNaN(second), 2 * first_failed > pairs.size(),
          2 * second_failed > pairs.size()};
}

/// Runs of the two cells with the same seed, those on identical input as one pair, in the order of
/// the first cell.
std::vector<PairedRuns> PairsOf(const StudyCell& first, const StudyCell& second,
                                const Metric& metric) {
  std::map<int, const StudyRun*> by_seed;
  for (const StudyRun* run : second.runs) by_seed.emplace(run->seed, run);
  std::vector<std::vector<PairedRuns>> by_input;
  std::map<std::string, std::size_t> index;
  for (const StudyRun* run : first.runs) {
    const auto other = by_seed.find(run->seed);
    if (other == by_seed.end()) continue;
    // Where the input is not known each run has its own.
    const std::string input =
        run->stream_id.empty() ? "seed " + std::to_string(run->seed) : run->stream_id;
    const auto [found, is_new] = index.emplace(input, by_input.size());
    if (is_new) by_input.emplace_back();
    by_input[found->second].push_back({MetricValue(*run, metric.key),
                                       MetricValue(*other->second, metric.key), run->failed,
                                       other->second->failed});
  }
  std::vector<PairedRuns> pairs;
  for (const auto& of_input : by_input) pairs.push_back(OnePairOf(of_input));
  return pairs;
}

/// Streams of one pair each are the observations themselves: they are resampled together.
std::vector<std::vector<PairedRuns>> Resampled(std::vector<std::vector<PairedRuns>> strata) {
  std::vector<PairedRuns> single;
  for (const auto& stratum : strata) {
    if (stratum.size() == 1) single.push_back(stratum.front());
  }
  std::erase_if(strata, [](const auto& stratum) { return stratum.size() == 1; });
  if (!single.empty()) strata.push_back(std::move(single));
  return strata;
}

/// The median difference between two runs of the cell: of logarithms where `ratio`.
double ChaosOf(const StudyCell& cell, const Metric& metric, bool ratio) {
  const std::vector<double> values = cell.Values(metric.key);
  std::vector<double> differences;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double difference = std::abs(ratio ? std::log(values[i] / values[j])
                                               : metric.Score(values[i]) - metric.Score(values[j]));
      if (std::isfinite(difference)) differences.push_back(difference);
    }
  }
  return MedianOrNaN(differences);
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

double CoverageOf(const StudyGrid& grid, const std::vector<std::size_t>& streams, std::size_t arm) {
  std::vector<double> values;
  for (const std::size_t s : streams) {
    const std::vector<double> more = grid.cell(s, arm).Values("coverage_share");
    values.insert(values.end(), more.begin(), more.end());
  }
  return MedianOrNaN(values);
}

bool BelowChaosFloor(const ComparisonRow& row, double floor) {
  if (std::isnan(floor)) return false;
  // Failures are no matter of chaos.
  if (row.paired.only_first_failed != row.paired.only_second_failed) return false;
  return row.paired.is_ratio ? std::abs(std::log(row.paired.ratio)) < std::log(floor)
                             : std::abs(row.paired.difference) < floor;
}

Decision Decide(const ComparisonRow& row, double chaos_floor, const Metric& metric,
                const StudyTableOptions& options) {
  if (row.paired.informative() == 0 && row.paired.test.zeros > 0) return Decision::kEqual;
  if (std::ldexp(1.0, 1 - row.paired.informative()) > options.alpha) return Decision::kTooFew;
  if (!(row.p_holm <= options.alpha)) return Decision::kNothing;
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
  ArmComparison arms;
  arms.first = grid.arms()[first].name;
  arms.second = grid.arms()[second].name;
  PairedOptions paired_options;
  paired_options.bootstrap.resamples = options.bootstrap_resamples;
  std::vector<std::vector<PairedRuns>> strata;
  std::vector<std::size_t> streams;
  const auto add_row = [&](std::string name, std::span<const std::vector<PairedRuns>> pairs,
                           const std::vector<std::size_t>& of_streams) {
    ComparisonRow row;
    row.stream = std::move(name);
    row.paired = ComparePairs(pairs, metric, paired_options);
    row.first_coverage = CoverageOf(grid, of_streams, first);
    row.second_coverage = CoverageOf(grid, of_streams, second);
    arms.rows.push_back(std::move(row));
  };
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    if (IsChaosStream(options, grid.streams()[s])) continue;
    std::vector<PairedRuns> pairs = PairsOf(grid.cell(s, first), grid.cell(s, second), metric);
    if (pairs.empty()) continue;
    add_row(grid.streams()[s], {&pairs, 1}, {s});
    strata.push_back(std::move(pairs));
    streams.push_back(s);
  }
  if (strata.size() > 1) add_row("", Resampled(strata), streams);
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
  std::vector<double> p_values;
  for (const ArmComparison& arms : comparison.arms) {
    for (const ComparisonRow& row : arms.rows) {
      const bool tested = row.paired.informative() > 0 || row.paired.test.zeros > 0;
      p_values.push_back(tested ? row.paired.test.p_value : kNoNumber);
      if (tested) ++comparison.tests;
    }
  }
  const std::vector<double> adjusted = HolmAdjusted(p_values);
  std::size_t i = 0;
  for (ArmComparison& arms : comparison.arms) {
    for (ComparisonRow& row : arms.rows) {
      row.p_holm = adjusted[i++];
      const bool same_kind = row.paired.is_ratio == arms.overall().paired.is_ratio;
      row.decision = Decide(row, same_kind ? arms.chaos_floor : kNoNumber, metric, options);
    }
  }
  return comparison;
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
