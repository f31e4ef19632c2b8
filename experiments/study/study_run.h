#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "experiments/exit_status.h"
#include "experiments/study/study_plan.h"

namespace duet {

/// runs/<id> of the folder.
[[nodiscard]] std::filesystem::path RecordFolderOf(const std::filesystem::path& study_folder,
                                                   const std::string& id);

/// Runs one cell of the grid into its record, complete or not at all, with its stream before it
/// where that is missing; nothing to do where the record is there. Several processes may do the
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
  /// SHA-256 of each canonical file of the record, by name.
  std::vector<std::pair<std::string, std::string>> files;
};
[[nodiscard]] StudyRecordInfo ReadRecordInfo(const std::filesystem::path& record);

/// The names of the canonical files that a record may hold, study.json left out.
[[nodiscard]] const std::vector<std::string>& CanonicalFiles();

}  // namespace duet
