#include "evaluation/study_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "evaluation/statistics.h"

namespace duet {
namespace {

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
  return {Summarize(first).median, Summarize(second).median, 2 * first_failed > pairs.size(),
          2 * second_failed > pairs.size()};
}

}  // namespace

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

std::string BaselineOf(const StudyGrid& grid, const StudyTableOptions& options) {
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

void AddPair(const std::string& input, const PairedRuns& pair, StreamPairs* stream) {
  auto found = std::find_if(stream->begin(), stream->end(),
                            [&](const InputPairs& of_input) { return of_input.input == input; });
  if (found == stream->end()) found = stream->insert(found, {input, {}});
  found->pairs.push_back(pair);
}

StreamPairs PairsOf(const StudyCell& first, const StudyCell& second, const Metric& metric) {
  std::map<int, const StudyRun*> by_seed;
  for (const StudyRun* run : second.runs) by_seed.emplace(run->seed, run);
  StreamPairs stream;
  for (const StudyRun* run : first.runs) {
    const auto other = by_seed.find(run->seed);
    if (other == by_seed.end()) continue;
    AddPair(InputOf(*run),
            {MetricValue(*run, metric.key), MetricValue(*other->second, metric.key), run->failed,
             other->second->failed},
            &stream);
  }
  return stream;
}

std::vector<PairedRuns> OnePairAnInput(const StreamPairs& stream) {
  std::vector<PairedRuns> pairs;
  for (const InputPairs& of_input : stream) pairs.push_back(OnePairOf(of_input.pairs));
  return pairs;
}

std::vector<std::vector<PairedRuns>> EachInputOnce(std::span<const StreamPairs> streams) {
  std::vector<StreamPairs> merged(streams.size());
  std::map<std::string, std::size_t> stream_of;
  for (std::size_t s = 0; s < streams.size(); ++s) {
    for (const InputPairs& of_input : streams[s]) {
      const std::size_t first = stream_of.emplace(of_input.input, s).first->second;
      for (const PairedRuns& pair : of_input.pairs) {
        AddPair(of_input.input, pair, &merged[first]);
      }
    }
  }
  std::vector<std::vector<PairedRuns>> strata;
  for (const StreamPairs& stream : merged) strata.push_back(OnePairAnInput(stream));
  return strata;
}

}  // namespace duet
