#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/study/study_records.h"
#include "experiments/study/tuning_file.h"

namespace duet {

/// What one trial of a search came to, against the defaults (trial 0) on the same streams and
/// seeds.
struct TuningTrial {
  std::string estimator;
  std::string setting;
  int runs = 0;
  int failed = 0;
  int without = 0;         ///< did not fail, but do not hold the objective
  double coverage = 0.0;   ///< median share of the runs that did not fail
  double objective = 0.0;  ///< its median over them
  /// Geometric mean of the objective over the defaults' on the same stream and seed, over those
  /// that neither failed on: below 1 is better. Of a metric that is better when higher, the
  /// defaults' over its own; of a signed error by magnitudes; of a NEES the factor that it is from
  /// its expectation, on either side, over the defaults' factor.
  double ratio = 0.0;
};

/// Trials by estimator, in the order of the study's settings. Throws InputError for an objective
/// that is no metric, or that no run of the defaults holds.
[[nodiscard]] std::vector<TuningTrial> TuningTrials(const StudyResult& result,
                                                    const std::string& objective);

/// The best trial of an estimator: least failures, then the smallest ratio among those that cover
/// as much as the defaults (0.02 less at most); the defaults where nothing is better.
[[nodiscard]] const TuningTrial& BestTrial(const std::vector<TuningTrial>& trials,
                                           const std::string& estimator);

/// tuning.yaml of a search's folder: the objective and what the report runs on.
struct TuningReport {
  std::string objective;
  SeedRange seeds{1, 1};
  std::vector<StudyStream> streams;  ///< empty: the search's
};
[[nodiscard]] std::string TuningYaml(const TuningFile& tuning);
/// Back; `file` is for errors. Throws InputError.
[[nodiscard]] TuningReport ParseTuningYaml(std::string_view yaml,
                                           const std::filesystem::path& file);
[[nodiscard]] bool IsTuningFolder(const std::filesystem::path& folder);

/// What is made of a search's records: search.csv (every trial with its values), search.txt (what
/// won and what it bought) and report.yaml (a study of the defaults against what won, on the
/// report's seeds). Throws InputError where plan.csv lacks an estimator of the study, or has a
/// setting that the study has not.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> TuningTexts(
    const StudyFolder& folder);
/// The same with what its tuning.yaml says.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> TuningTexts(
    const StudyFolder& folder, const TuningReport& report);

}  // namespace duet
