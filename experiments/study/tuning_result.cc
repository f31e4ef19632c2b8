#include "experiments/study/tuning_result.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "evaluation/metrics.h"
#include "evaluation/statistics.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr double kCoverageTolerance = 0.02;

std::optional<double> MetricOfRun(const StudyRun& run, const std::string& key) {
  for (const auto& [name, value] : run.metrics) {
    if (name == key) return value;
  }
  return std::nullopt;
}

std::string PairOf(const StudyRun& run) {
  return run.estimator + "\n" + run.stream + "\n" + run.perturbation + "\n" +
         std::to_string(run.seed);
}

/// The logarithm of how many times worse than `base` a value is; nothing where there is no such
/// factor.
std::optional<double> LogRatio(const Metric& metric, double value, double base) {
  const auto log_of_quotient = [](double a, double b) -> std::optional<double> {
    if (a == b) return 0.0;
    if (!(a > 0.0) || !(b > 0.0)) return std::nullopt;
    return std::log(a / b);
  };
  switch (metric.better) {
    case Better::kHigher:
      return log_of_quotient(base, value);
    case Better::kNearZero:
      return log_of_quotient(std::abs(value), std::abs(base));
    case Better::kNearExpected: {
      const double log_ratio = metric.Score(value) - metric.Score(base);
      return std::isfinite(log_ratio) ? std::optional(log_ratio) : std::nullopt;
    }
    case Better::kLower:
    case Better::kNeither:
      return log_of_quotient(value, base);
  }
  return std::nullopt;
}

double Median(std::vector<double> values) { return Summarize(std::move(values)).median; }

const StudyChange& SettingOf(const StudyFile& study, const std::string& name) {
  for (const StudyChange& setting : study.settings) {
    if (setting.name == name) return setting;
  }
  throw InputError(study.file, 0, "settings", "has no '" + name + "', which plan.csv has");
}

/// "msckf.max_clones=12 msckf.gate=false"
std::string KeysText(const StudyFile& study, const TuningTrial& trial) {
  const StudyChange& setting = SettingOf(study, trial.setting);
  const auto only = setting.only.find(trial.estimator);
  if (only == setting.only.end()) return "as they are";
  std::string text;
  for (const StudyKey& key : only->second) {
    text += (text.empty() ? "" : " ") + key.key + "=" + key.value.scalar;
  }
  return text;
}

std::string SearchCsv(const StudyFile& study, const std::vector<TuningTrial>& trials) {
  std::string text = "estimator,trial,runs,failed,without,coverage,objective,ratio,settings\n";
  for (const TuningTrial& trial : trials) {
    text += trial.estimator + "," + trial.setting + "," + std::to_string(trial.runs) + "," +
            std::to_string(trial.failed) + "," + std::to_string(trial.without) + "," +
            FormatNumber(trial.coverage) + "," + FormatNumber(trial.objective) + "," +
            FormatNumber(trial.ratio) + "," + KeysText(study, trial) + "\n";
  }
  return text;
}

std::string SearchText(const StudyFile& study, const std::vector<TuningTrial>& trials,
                       const std::string& objective) {
  std::string text = study.name + ": " + std::to_string(study.settings.size()) +
                     " settings of each estimator, judged by " + objective + " on seeds " +
                     std::to_string(study.seeds.first) + " to " + std::to_string(study.seeds.last) +
                     "\n";
  for (const std::string& estimator : study.estimators) {
    const TuningTrial& best = BestTrial(trials, estimator);
    text += estimator + ": " + best.setting + " (" + KeysText(study, best) + "), " + objective +
            " at " + FormatFixed(best.ratio, 3) + " of the defaults' (below 1 is better); " +
            std::to_string(best.failed) + " of " + std::to_string(best.runs) + " runs failed\n";
  }
  return text + "On inputs that the search has not seen the gain is smaller: run report.yaml.\n";
}

std::string ReportYaml(const StudyFile& study, const std::vector<TuningTrial>& trials,
                       const SeedRange& seeds, std::vector<StudyStream> streams) {
  StudyFile report = study;
  report.name = study.name + " report";
  report.question = "What does tuning buy on inputs that the search has not seen?";
  report.seeds = seeds;
  if (!streams.empty()) report.streams = std::move(streams);
  if (!report.published.empty()) report.published = "published";  // beside it
  report.settings = {{"default", {}, {}}, {"tuned", {}, {}}};
  for (const std::string& estimator : study.estimators) {
    const StudyChange& best = SettingOf(study, BestTrial(trials, estimator).setting);
    const auto only = best.only.find(estimator);
    if (only != best.only.end()) report.settings[1].only[estimator] = only->second;
  }
  report.baseline = "default";
  report.compare = StudyCompare::kSettings;
  return StudyYaml(report);
}

}  // namespace

std::vector<TuningTrial> TuningTrials(const StudyResult& result, const std::string& objective) {
  CHECK(!result.runs.empty());
  const Metric metric = MetricOf(objective);
  const std::string defaults = result.runs.front().setting;
  std::map<std::string, double> of_defaults;
  std::vector<std::string> estimators;
  std::vector<std::string> settings;
  const auto note = [](const std::string& name, std::vector<std::string>* names) {
    if (std::find(names->begin(), names->end(), name) == names->end()) names->push_back(name);
  };
  for (const StudyRun& run : result.runs) {
    note(run.estimator, &estimators);
    note(run.setting, &settings);
    const std::optional<double> value = MetricOfRun(run, objective);
    if (run.setting == defaults && !run.failed && value) of_defaults[PairOf(run)] = *value;
  }
  const bool is_held =
      std::any_of(result.runs.begin(), result.runs.end(),
                  [&](const StudyRun& run) { return run.failed || MetricOfRun(run, objective); });
  if (!is_held) {
    throw InputError("", 0, "objective",
                     "no run holds '" + objective +
                         "'; expected a metric that they have (of a calibration: one that is "
                         "estimated)");
  }
  std::vector<TuningTrial> trials;
  for (const std::string& estimator : estimators) {
    for (const std::string& setting : settings) {
      TuningTrial& trial = trials.emplace_back();
      trial.estimator = estimator;
      trial.setting = setting;
      std::vector<double> values;
      std::vector<double> coverages;
      double log_ratio = 0.0;
      int pairs = 0;
      for (const StudyRun& run : result.runs) {
        if (run.estimator != estimator || run.setting != setting) continue;
        ++trial.runs;
        const std::optional<double> value = MetricOfRun(run, objective);
        if (run.failed || !value) {
          ++(run.failed ? trial.failed : trial.without);
          continue;
        }
        values.push_back(*value);
        coverages.push_back(MetricOfRun(run, "coverage_share").value_or(0.0));
        const auto base = of_defaults.find(PairOf(run));
        if (base == of_defaults.end()) continue;
        const std::optional<double> log_of_pair = LogRatio(metric, *value, base->second);
        if (!log_of_pair) continue;
        log_ratio += *log_of_pair;
        ++pairs;
      }
      trial.objective = Median(values);
      trial.coverage = Median(coverages);
      trial.ratio =
          pairs > 0 ? std::exp(log_ratio / pairs) : std::numeric_limits<double>::infinity();
    }
  }
  return trials;
}

const TuningTrial& BestTrial(const std::vector<TuningTrial>& trials, const std::string& estimator) {
  const TuningTrial* defaults = nullptr;
  const TuningTrial* best = nullptr;
  for (const TuningTrial& trial : trials) {
    if (trial.estimator != estimator) continue;
    if (defaults == nullptr) {
      defaults = best = &trial;
      continue;
    }
    const bool covers = trial.coverage >= defaults->coverage - kCoverageTolerance;
    const bool is_better =
        trial.failed < best->failed || (trial.failed == best->failed && trial.ratio < best->ratio);
    if (is_better && covers) best = &trial;
  }
  CHECK(best != nullptr) << "no trial of " << estimator;
  return *best;
}

std::string TuningYaml(const TuningFile& tuning) {
  std::string text = "# A search's folder: study.yaml has the trials.\nobjective: " +
                     QuotedYaml(tuning.objective) +
                     "\nreport_seeds: " + std::to_string(tuning.report_seeds.first) + ".." +
                     std::to_string(tuning.report_seeds.last) + "\n";
  if (!tuning.report_streams.empty()) {
    text += "report_streams:\n" + StreamsYaml(tuning.report_streams);
  }
  return text;
}

bool IsTuningFolder(const fs::path& folder) { return fs::exists(folder / "tuning.yaml"); }

TuningReport ParseTuningYaml(std::string_view yaml, const fs::path& file) {
  const YamlNode root = ParseYaml(yaml, file.string());
  const YamlNode* objective = root.Find("objective");
  const YamlNode* seeds = root.Find("report_seeds");
  if (objective == nullptr || seeds == nullptr) {
    throw InputError(file.string(), 0, "", "expected objective and report_seeds");
  }
  TuningReport report;
  report.objective = objective->scalar;
  if (!FindMetric(report.objective)) {
    throw InputError(file.string(), objective->line, "objective",
                     "no metric is called '" + report.objective + "'");
  }
  report.seeds = ParseSeeds(seeds->scalar, file.string(), seeds->line, "report_seeds");
  if (const YamlNode* list = root.Find("report_streams"))
    report.streams = StreamsOfYaml(*list, file);
  return report;
}

std::vector<std::pair<std::string, std::string>> TuningTexts(const StudyFolder& folder) {
  const fs::path file = folder.path / "tuning.yaml";
  return TuningTexts(folder, ParseTuningYaml(ReadTextFile(file), file));
}

std::vector<std::pair<std::string, std::string>> TuningTexts(const StudyFolder& folder,
                                                             const TuningReport& report) {
  for (const std::string& estimator : folder.study.estimators) {
    const bool runs = std::any_of(folder.result.runs.begin(), folder.result.runs.end(),
                                  [&](const StudyRun& run) { return run.estimator == estimator; });
    if (runs) continue;
    throw InputError(folder.study.file, 0, "estimators",
                     "has " + estimator + ", of which plan.csv has no run");
  }
  const std::vector<TuningTrial> trials = TuningTrials(folder.result, report.objective);
  return {{"search.csv", SearchCsv(folder.study, trials)},
          {"search.txt", SearchText(folder.study, trials, report.objective)},
          {"report.yaml", ReportYaml(folder.study, trials, report.seeds, report.streams)}};
}

}  // namespace duet
