#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

/// Derives everything again: ids of streams and runs from the lines that determine them, a run's
/// settings from its config.yaml, the hashes of streams from their tracks and of records from their
/// files, evaluations from records and streams, and every text of the folder from the records.
/// Throws InputError where the folder is no study's.
[[nodiscard]] StudyVerification VerifyStudy(const std::filesystem::path& folder);

}  // namespace duet
