#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/study/study_records.h"

namespace duet {

/// What a study's folder was found to be.
struct StudyVerification {
  int runs = 0;     ///< records that were looked at
  int streams = 0;  ///< likewise
  /// A line each: what is missing, what has changed, what is from another version.
  std::vector<std::string> problems;
  /// What is there besides and harms nothing.
  std::vector<std::string> notes;
};

/// What a study's folder holds besides its texts, derived again: path in the folder and text.
using StudyDerivation =
    std::function<std::vector<std::pair<std::string, std::string>>(const StudyFolder& folder)>;

/// Derives everything again: the plan from study.yaml, ids of streams and runs from the lines that
/// determine them, a run's settings from its config.yaml, the hashes of streams and records from
/// their files, evaluations from records and streams, every text of the folder from the records,
/// and what `derive` gives; pictures are held against the hashes that manifest.json lists. What a
/// stream was simulated or tracked from is not run again, nor are the estimators. Throws InputError
/// where the folder is no study's.
[[nodiscard]] StudyVerification VerifyStudy(const std::filesystem::path& folder,
                                            const StudyDerivation& derive = nullptr);

}  // namespace duet
