#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/exit_status.h"
#include "experiments/study/study_plan.h"

namespace duet {

/// runs/<id> of the folder.
[[nodiscard]] std::filesystem::path RecordFolderOf(const std::filesystem::path& study_folder,
                                                   const std::string& id);

/// Runs one cell of the grid into its record, complete or not at all, with its stream before it
/// where that is missing; nothing to do where the record is there, one that is damaged
/// (DamageOfRecord) is replaced. Several processes may do the
/// same at the same time: one record is kept. kDone also where the estimator failed, which the
/// record says; kInterrupted. Throws InputError and OutputError.
[[nodiscard]] ExitStatus RunStudyRun(const StudyPlan& plan, const PlannedRun& run,
                                     const std::filesystem::path& study_folder,
                                     const std::string& command_line);

/// What study.json of a record says.
struct StudyRecordInfo {
  std::string id;
  std::string determined_by;
  std::string stream_id;
  std::string stream_sha256;  ///< of the stream.json that was run on
  /// SHA-256 of each canonical file of the record, by name.
  std::vector<std::pair<std::string, std::string>> files;
  std::map<std::string, std::uintmax_t> bytes;  ///< their sizes
  bool unchanged = false;  ///< study.json gives the hash of itself that it holds
};
[[nodiscard]] StudyRecordInfo ReadRecordInfo(const std::filesystem::path& record);
/// The same from its text; `file` is for errors. Throws InputError.
[[nodiscard]] StudyRecordInfo ParseRecordInfo(std::string_view text, const std::string& file);

/// What a record of this version lacks (a file that is missing or of another size, a study.json or
/// manifest.json that can't be read), in words; empty for a whole one. Looks at sizes, not at what
/// the files hold: duet verify does. Throws InputError for a record of another version.
[[nodiscard]] std::string DamageOfRecord(const std::filesystem::path& record);

/// The names of the canonical files that a record may hold, study.json left out.
[[nodiscard]] const std::vector<std::string>& CanonicalFiles();

}  // namespace duet
