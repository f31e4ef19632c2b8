#include "experiments/study/tuning_file.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>

#include "backends/factory.h"
#include "common/config/yaml_map.h"
#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/random.h"
#include "evaluation/metrics.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr const char* kShared = "shared";
constexpr std::uint64_t kSearchSeed = 1;
/// Streams of random numbers that one trial may use for a search's dimension.
constexpr std::uint64_t kMostDimensions = 64;
constexpr int kMostDraws = 10000;

using Search = std::map<std::string, std::vector<TuningDimension>>;  // by estimator, and `shared`

const YamlNode& Required(const YamlNode& root, const std::string& key, const std::string& file,
                         const std::string& expected) {
  const YamlNode* node = root.Find(key);
  if (node == nullptr) throw InputError(file, 0, key, "is missing; expected " + expected);
  return *node;
}

int ReadBudget(const YamlNode& root, const std::string& file) {
  const YamlNode& node = Required(root, "budget", file, "the number of trials of each estimator");
  const std::optional<int> budget = AsInteger(node);
  if (!budget || *budget < 2 || *budget > 10000) {
    throw InputError(file, node.line, "budget", "expected an integer from 2 to 10000");
  }
  return *budget;
}

SeedRange ReadReportSeeds(const YamlNode& root, const std::string& file, const SeedRange& seeds) {
  const YamlNode& node = Required(root, "report_seeds", file, "the seeds of the report, A..B");
  const SeedRange report =
      ParseSeeds(AsText(node).value_or(Describe(node)), file, node.line, "report_seeds");
  if (report.first <= seeds.last && seeds.first <= report.last) {
    throw InputError(file, node.line, "report_seeds",
                     "has seeds that the search has too: what was tuned on a seed is not judged on "
                     "it");
  }
  return report;
}

std::string ReadObjective(const YamlNode& root, const std::string& file) {
  const YamlNode& node = Required(root, "objective", file, "a metric");
  std::string key = AsText(node).value_or("");
  const std::optional<Metric> metric = FindMetric(key);
  if (!metric) {
    throw InputError(file, node.line, "objective",
                     "no metric is called '" + key + "'" + DidYouMean(key, MetricKeys()));
  }
  if (metric->better == Better::kNeither || (metric->is_nees() && !(metric->expected > 0.0))) {
    throw InputError(file, node.line, "objective",
                     "'" + key + "' does not tell which of two values is the better one");
  }
  return key;
}

/// True where two recordings share an instant.
bool SpansOverlap(const StudyStream& a, const StudyStream& b) {
  const auto end = [](const StudyStream& stream, double start_s) {
    return stream.duration_s > 0.0 ? start_s + stream.duration_s
                                   : std::numeric_limits<double>::infinity();
  };
  for (const double start_a : a.starts_s) {
    for (const double start_b : b.starts_s) {
      if (start_a < end(b, start_b) && start_b < end(a, start_a)) return true;
    }
  }
  return false;
}

/// What was tuned on an input is not judged on it; a recording is the same on every seed.
void CheckReportStreams(const TuningFile& tuning, const std::string& file, int line) {
  const StudyFile& study = tuning.study;
  const auto& of_report = tuning.report_streams.empty() ? study.streams : tuning.report_streams;
  const auto seeds_of = [](const StudyStream& stream, const SeedRange& seeds) {
    return stream.simulation_seed ? SeedRange{*stream.simulation_seed, *stream.simulation_seed}
                                  : seeds;
  };
  for (StudyStream report : of_report) {
    MakePathsAbsolute(file, "", &report);
    for (StudyStream search : study.streams) {
      MakePathsAbsolute(file, "", &search);
      const SeedRange a = seeds_of(report, tuning.report_seeds);
      const SeedRange b = seeds_of(search, study.seeds);
      const bool same =
          report.simulated()
              ? report.simulate == search.simulate && a.first <= b.last && b.first <= a.last
              : report.dataset == search.dataset && SpansOverlap(report, search);
      if (!same) continue;
      throw InputError(
          file, line, "report_streams",
          "'" + report.name +
              "' of the report is what the search runs on: what was tuned on it is "
              "not judged on it; expected other recordings, other parts of them (starts_s, "
              "duration_s), or other seeds of a simulation");
    }
  }
}

std::vector<TuningDimension> ReadDimensions(const YamlNode& node, const std::string& file,
                                            const std::string& group) {
  std::vector<TuningDimension> dimensions;
  const std::string path = "search." + group;
  if (node.kind != YamlNode::Kind::kMap) {
    throw InputError(file, node.line, path, "expected keys, each with a list of values");
  }
  for (const YamlNode::Entry& entry : node.entries) {
    const std::string section = entry.key.substr(0, entry.key.find('.'));
    const bool fits = group == kShared ? section == "shared" || section == "initialization"
                                       : section == group || section == "shared";
    if (!fits) throw InputError(file, entry.line, path + "." + entry.key, "has no place here");
    if (entry.value.kind != YamlNode::Kind::kSequence || entry.value.items.size() < 2) {
      throw InputError(file, entry.line, path + "." + entry.key,
                       "expected a list of at least two values, got " + Describe(entry.value));
    }
    dimensions.push_back({entry.key, entry.value.items, file});
  }
  return dimensions;
}

Search ReadSearch(const YamlNode& root, const std::string& file,
                  const std::vector<std::string>& estimators) {
  const YamlNode& node = Required(root, "search", file, "what is searched over");
  std::vector<std::string> known = estimators;
  known.emplace_back(kShared);
  Search search;
  for (const YamlNode::Entry& entry : node.entries) {
    if (std::find(known.begin(), known.end(), entry.key) == known.end()) {
      throw InputError(file, entry.line, "search." + entry.key,
                       "unknown key" + DidYouMean(entry.key, known));
    }
    search[entry.key] = ReadDimensions(entry.value, file, entry.key);
  }
  return search;
}

/// The dimensions of one estimator: those that all share come first.
std::vector<TuningDimension> DimensionsOf(const Search& search, const std::string& estimator) {
  std::vector<TuningDimension> dimensions;
  for (const std::string& group : {std::string(kShared), estimator}) {
    const auto found = search.find(group);
    if (found == search.end()) continue;
    dimensions.insert(dimensions.end(), found->second.begin(), found->second.end());
  }
  return dimensions;
}

void CheckSize(const std::vector<TuningDimension>& dimensions, const std::string& estimator,
               int budget, const std::string& file) {
  double combinations = 1.0;
  for (const TuningDimension& each : dimensions) {
    combinations *= static_cast<double>(each.values.size());
  }
  if (dimensions.size() > kMostDimensions / 2) {
    throw InputError(file, 0, "search." + estimator, "has too many keys");
  }
  // The defaults need not be among them.
  if (combinations < budget) {
    throw InputError(file, 0, "budget",
                     estimator + " has fewer combinations than that: effort would not be equal");
  }
}

/// The trials' changes of one estimator, the defaults left out.
std::vector<std::vector<StudyKey>> DrawTrials(const std::vector<TuningDimension>& dimensions,
                                              std::size_t shared, int trials,
                                              const std::string& estimator,
                                              const std::string& file) {
  std::set<std::vector<int>> drawn;
  std::vector<std::vector<StudyKey>> changes;
  for (int trial = 1; trial <= trials; ++trial) {
    std::vector<int> choice(dimensions.size());
    bool is_new = false;
    // Only the estimator's own values are drawn again, so that the shared ones stay shared; where
    // there are none of its own, all are, for every estimator alike.
    for (int draw = 0; draw < kMostDraws; ++draw) {
      for (std::size_t d = 0; d < dimensions.size(); ++d) {
        const bool redrawn = d >= shared || shared == dimensions.size();
        Random random(kSearchSeed,
                      1 + static_cast<std::uint64_t>(trial) * kMostDimensions + d +
                          (redrawn ? static_cast<std::uint64_t>(draw) * 1'000'000'000 : 0));
        choice[d] = random.Index(static_cast<int>(dimensions[d].values.size()));
      }
      is_new = drawn.insert(choice).second;
      if (is_new) break;
    }
    if (!is_new) {
      throw InputError(file, 0, "budget",
                       estimator + " has no combination left for trial " + std::to_string(trial) +
                           ", whose shared values are drawn; expected a smaller budget, or more "
                           "values of its own");
    }
    std::vector<StudyKey>& keys = changes.emplace_back();
    for (std::size_t d = 0; d < dimensions.size(); ++d) {
      const TuningDimension& dimension = dimensions[d];
      keys.push_back(
          {dimension.key, dimension.values[static_cast<std::size_t>(choice[d])], dimension.file});
    }
  }
  return changes;
}

std::string TrialName(int trial) {
  return trial == 0 ? "default" : "trial " + std::to_string(trial);
}

}  // namespace

std::vector<StudyStream> StreamsOfYaml(const YamlNode& list, const fs::path& file) {
  YamlNode study = ParseYaml("study: streams\nstreams: []\n", file.string());
  for (YamlNode::Entry& entry : study.entries) {
    if (entry.key == "streams") entry.value = list;
  }
  return StudyOfYaml(std::move(study), file, /*quick=*/false).streams;
}

TuningFile ParseTuningFile(std::string_view yaml, const fs::path& path, bool quick) {
  const std::string file = path.string();
  YamlNode root = ParseYaml(yaml, file);
  if (root.kind != YamlNode::Kind::kMap) throw InputError(file, 0, "", "expected keys with values");
  const std::set<std::string> own = {"budget", "objective", "report_seeds", "report_streams",
                                     "search"};
  // quick may change the search too.
  YamlNode tuning = root;
  if (const YamlNode* changes = quick ? root.Find("quick") : nullptr) {
    for (const YamlNode::Entry& entry : changes->entries) {
      if (!own.contains(entry.key)) continue;
      std::erase_if(tuning.entries, [&](const auto& other) { return other.key == entry.key; });
      tuning.entries.push_back(entry);
    }
  }
  YamlNode as_study = root;
  const auto drop_own = [&](YamlNode* node) {
    std::erase_if(node->entries, [&](const auto& entry) { return own.contains(entry.key); });
  };
  drop_own(&as_study);
  for (YamlNode::Entry& entry : as_study.entries) {
    if (entry.key == "quick") drop_own(&entry.value);
    if (entry.key == "study" || entry.key == "settings" || entry.key == "compare" ||
        entry.key == "baseline") {
      throw InputError(file, entry.line, entry.key, "has no place in the file of a tuning");
    }
    if (entry.key == "tuning") entry.key = "study";
  }
  (void)Required(root, "tuning", file, "the tuning's name");

  TuningFile result;
  result.study = StudyOfYaml(std::move(as_study), path, quick);
  StudyFile& study = result.study;
  result.budget = ReadBudget(tuning, file);
  result.report_seeds = ReadReportSeeds(tuning, file, study.seeds);
  const YamlNode* streams = tuning.Find("report_streams");
  if (streams != nullptr) result.report_streams = StreamsOfYaml(*streams, path);
  CheckReportStreams(result, file, streams == nullptr ? 0 : streams->line);
  result.objective = ReadObjective(tuning, file);
  if (std::find(study.metrics.begin(), study.metrics.end(), result.objective) ==
      study.metrics.end()) {
    study.metrics.insert(study.metrics.begin(), result.objective);
  }
  const Search search = ReadSearch(tuning, file, study.estimators);
  const auto shared = search.find(kShared);
  const std::size_t shared_count = shared == search.end() ? 0 : shared->second.size();
  study.settings.clear();
  for (int trial = 0; trial < result.budget; ++trial) {
    study.settings.push_back({TrialName(trial), {}, {}});
  }
  for (const std::string& estimator : study.estimators) {
    const std::vector<TuningDimension> dimensions = DimensionsOf(search, estimator);
    CheckSize(dimensions, estimator, result.budget, file);
    const auto trials = DrawTrials(dimensions, shared_count, result.budget - 1, estimator, file);
    for (std::size_t i = 0; i < trials.size(); ++i)
      study.settings[i + 1].only[estimator] = trials[i];
  }
  study.compare = StudyCompare::kSettings;
  study.baseline = TrialName(0);
  return result;
}

}  // namespace duet
