#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/study/study_file.h"

namespace duet {

/// One setting that is searched over, and the values that it may take.
struct TuningDimension {
  std::string key;
  std::vector<YamlNode> values;
  std::string file;
};

/// Equal-effort tuning: the same number of settings is tried for each estimator, on seeds or
/// recordings that the report does not contain. The file is a study's (docs/studies.md) with
/// `tuning` in place of `study`, without settings, and with the keys below.
struct TuningFile {
  StudyFile study;  ///< of the search: its settings are the trials
  int budget = 0;   ///< trials of each estimator, the defaults (trial 0) among them
  std::string objective;
  SeedRange report_seeds;  ///< of the studies that the result is for; disjoint from the search's
  std::vector<StudyStream> report_streams;  ///< likewise; empty: the search's, on the other seeds
};

/// Trial 0 changes nothing; the others draw each setting's value with equal chances (random search:
/// Bergstra and Bengio, JMLR 2012), without drawing a combination twice. What the estimators search
/// together (`shared` keys) has the same values in the same trial. The same file gives the same
/// trials. Throws InputError as ParseStudyFile does, and where an estimator has fewer combinations
/// than the budget or none left for a trial's shared values, the objective is no metric that tells
/// better from worse, the seeds overlap, or the report has a recording (or a simulation of one
/// seed) that the search has too.
[[nodiscard]] TuningFile ParseTuningFile(std::string_view yaml, const std::filesystem::path& file,
                                         bool quick);

/// The streams of a list as `streams:` of a study has it. Throws InputError.
[[nodiscard]] std::vector<StudyStream> StreamsOfYaml(const YamlNode& list,
                                                     const std::filesystem::path& file);

}  // namespace duet
