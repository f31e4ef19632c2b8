#include "evaluation/study_gains.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "evaluation/signed_rank.h"
#include "evaluation/study_pairs.h"
#include "evaluation/study_table_parts.h"

namespace duet {
namespace {

constexpr double kNoGain = std::numeric_limits<double>::quiet_NaN();
/// Of one that fails with the change alone; with the baseline alone it is the negative.
constexpr double kWorstGain = std::numeric_limits<double>::infinity();

/// Arms of two estimators, each with the change and with the baseline.
struct GainArms {
  std::size_t first_changed = 0;
  std::size_t first_baseline = 0;
  std::size_t second_changed = 0;
  std::size_t second_baseline = 0;
};

bool HasLogarithms(const StudyGrid& grid, const Metric& metric) {
  if (metric.better != Better::kLower) return false;
  const auto& runs = grid.study().runs;
  return std::all_of(runs.begin(), runs.end(), [&](const StudyRun& run) {
    const double value = MetricValue(run, metric.key);
    return run.failed || !std::isfinite(value) || value > 0.0;
  });
}

const StudyRun* RunOfSeed(const StudyCell& cell, int seed) {
  const auto found = std::find_if(cell.runs.begin(), cell.runs.end(),
                                  [&](const StudyRun* run) { return run->seed == seed; });
  return found == cell.runs.end() ? nullptr : *found;
}

/// The smaller, the better; infinite where only one of the two runs failed.
double GainOf(const StudyRun& changed, const StudyRun& baseline, const Metric& metric, bool ratio) {
  if (changed.failed && baseline.failed) return kNoGain;
  if (changed.failed) return kWorstGain;
  if (baseline.failed) return -kWorstGain;
  const double with = MetricValue(changed, metric.key);
  const double without = MetricValue(baseline, metric.key);
  if (!std::isfinite(with) || !std::isfinite(without)) return kNoGain;
  return ratio ? with / without : metric.Score(with) - metric.Score(without);
}

PairedRuns PairOfGains(double first, double second) {
  // Neither of the two has a gain where one has none.
  if (std::isnan(first) || std::isnan(second)) return {kNoGain, kNoGain, false, false};
  return {first, second, first == kWorstGain || second == -kWorstGain,
          second == kWorstGain || first == -kWorstGain};
}

StreamPairs GainPairs(const StudyGrid& grid, std::size_t stream, const GainArms& arms,
                      const Metric& metric, bool ratio) {
  StreamPairs pairs;
  for (const StudyRun* changed : grid.cell(stream, arms.first_changed).runs) {
    const StudyRun* baseline = RunOfSeed(grid.cell(stream, arms.first_baseline), changed->seed);
    const StudyRun* other = RunOfSeed(grid.cell(stream, arms.second_changed), changed->seed);
    const StudyRun* other_baseline =
        RunOfSeed(grid.cell(stream, arms.second_baseline), changed->seed);
    if (baseline == nullptr || other == nullptr || other_baseline == nullptr) continue;
    AddPair(InputOf(*changed),
            PairOfGains(GainOf(*changed, *baseline, metric, ratio),
                        GainOf(*other, *other_baseline, metric, ratio)),
            &pairs);
  }
  return pairs;
}

/// How the median coverage changes, so that who gains by covering less is seen to.
double CoverageChange(const StudyGrid& grid, const std::vector<std::size_t>& streams,
                      std::size_t changed, std::size_t baseline) {
  return MedianCoverage(grid, streams, changed) - MedianCoverage(grid, streams, baseline);
}

bool BothHaveGains(const PairedRuns& pair) {
  return !pair.first_failed && !pair.second_failed && std::isfinite(pair.first) &&
         std::isfinite(pair.second);
}

double MeanGain(const std::vector<std::vector<PairedRuns>>& strata, double PairedRuns::*side,
                bool ratio) {
  std::vector<double> values;
  for (const auto& stratum : strata) {
    for (const PairedRuns& pair : stratum) {
      if (BothHaveGains(pair)) values.push_back(ratio ? std::log(pair.*side) : pair.*side);
    }
  }
  if (values.empty()) return kNoGain;
  return ratio ? std::exp(HodgesLehmann(values)) : HodgesLehmann(values);
}

/// As of runs themselves: what an estimator's gains on a chaos stream typically differ by, of the
/// two the larger.
double ChaosFloorOfGains(const StudyGrid& grid, const GainArms& arms, const Metric& metric,
                         bool ratio, const StudyTableOptions& options) {
  double floor = kNoGain;
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    if (!IsChaosStream(options, grid.streams()[s])) continue;
    std::vector<double> first;
    std::vector<double> second;
    for (const InputPairs& of_input : GainPairs(grid, s, arms, metric, ratio)) {
      for (const PairedRuns& pair : of_input.pairs) {
        if (!BothHaveGains(pair)) continue;
        first.push_back(ratio ? std::log(pair.first) : pair.first);
        second.push_back(ratio ? std::log(pair.second) : pair.second);
      }
    }
    floor = std::fmax(floor, std::fmax(MedianPairDifference(first), MedianPairDifference(second)));
  }
  return ratio ? std::exp(floor) : floor;
}

GainComparison CompareTwoGains(const StudyGrid& grid, const GainArms& arms, const Metric& metric,
                               bool ratio, const StudyTableOptions& options) {
  std::vector<ComparedStream> streams;
  std::vector<StreamPairs> pairs;
  std::vector<std::size_t> indices;
  for (std::size_t s = 0; s < grid.streams().size(); ++s) {
    if (IsChaosStream(options, grid.streams()[s])) continue;
    pairs.push_back(GainPairs(grid, s, arms, metric, ratio));
    if (pairs.back().empty()) continue;
    indices.push_back(s);
    streams.push_back({grid.streams()[s], pairs.back(),
                       CoverageChange(grid, {s}, arms.first_changed, arms.first_baseline),
                       CoverageChange(grid, {s}, arms.second_changed, arms.second_baseline)});
  }
  // Differences of scores are compared as they are: they have signs of their own.
  Metric of_gains = metric;
  if (!ratio) of_gains.better = Better::kNeither;
  GainComparison gain;
  gain.arms = CompareStreams(streams, of_gains, options);
  if (gain.arms.rows.size() > 1) {
    gain.arms.rows.back().first_coverage =
        CoverageChange(grid, indices, arms.first_changed, arms.first_baseline);
    gain.arms.rows.back().second_coverage =
        CoverageChange(grid, indices, arms.second_changed, arms.second_baseline);
  }
  const std::vector<std::vector<PairedRuns>> strata = EachInputOnce(pairs);
  gain.first_gain = MeanGain(strata, &PairedRuns::first, ratio);
  gain.second_gain = MeanGain(strata, &PairedRuns::second, ratio);
  gain.arms.chaos_floor = ChaosFloorOfGains(grid, arms, metric, ratio, options);
  return gain;
}

/// "t_d estimated instead of t_d fixed (10 ms)"
std::string ChangeText(const StudyGrid& grid, const StudyArm& arm, const std::string& baseline,
                       ComparedAxis axis) {
  const bool settings = axis == ComparedAxis::kSettings;
  const auto other = [&](const StudyArm& a) { return settings ? a.perturbation : a.setting; };
  const bool varies = std::any_of(grid.arms().begin(), grid.arms().end(), [&](const StudyArm& a) {
    return other(a) != other(grid.arms().front());
  });
  return ComparedName(arm, axis) + " instead of " + baseline +
         (varies ? " (" + other(arm) + ")" : "");
}

}  // namespace

std::optional<MetricGains> CompareGains(const StudyGrid& grid, const Metric& metric,
                                        const StudyTableOptions& options) {
  if (options.compare == ComparedAxis::kEstimators || metric.better == Better::kNeither) {
    return std::nullopt;
  }
  const std::string baseline = BaselineOf(grid, options);
  const std::vector<StudyArm>& arms = grid.arms();
  const auto baseline_of = [&](std::size_t arm) -> std::optional<std::size_t> {
    for (std::size_t b = 0; b < arms.size(); ++b) {
      if (ComparedName(arms[b], options.compare) == baseline &&
          SameBut(arms[arm], arms[b], options.compare)) {
        return b;
      }
    }
    return std::nullopt;
  };
  MetricGains gains;
  gains.is_ratio = HasLogarithms(grid, metric);
  gains.comparison.metric = metric;
  gains.comparison.alpha = options.alpha;
  for (std::size_t a = 0; a < arms.size(); ++a) {
    if (ComparedName(arms[a], options.compare) == baseline) continue;
    for (std::size_t b = a + 1; b < arms.size(); ++b) {
      if (!SameBut(arms[a], arms[b], ComparedAxis::kEstimators)) continue;
      const std::optional<std::size_t> first_baseline = baseline_of(a);
      const std::optional<std::size_t> second_baseline = baseline_of(b);
      if (!first_baseline || !second_baseline) continue;
      GainComparison gain = CompareTwoGains(grid, {a, *first_baseline, b, *second_baseline}, metric,
                                            gains.is_ratio, options);
      if (gain.arms.rows.empty()) continue;
      gain.change = ChangeText(grid, arms[a], baseline, options.compare);
      gain.arms.first = arms[a].estimator;
      gain.arms.second = arms[b].estimator;
      gains.comparison.arms.push_back(gain.arms);
      gains.changes.push_back(std::move(gain));
    }
  }
  DecideAll(options, &gains.comparison);
  if (gains.comparison.tests == 0) return std::nullopt;
  for (std::size_t i = 0; i < gains.changes.size(); ++i) {
    gains.changes[i].arms = gains.comparison.arms[i];
  }
  return gains;
}

}  // namespace duet
