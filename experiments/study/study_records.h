#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/study_result.h"
#include "evaluation/study_table.h"
#include "experiments/study/study_plan.h"

namespace duet {

/// True where a folder is one of duet study.
[[nodiscard]] bool IsStudyFolder(const std::filesystem::path& folder);

/// A study's folder as its records tell: the grid of plan.csv, each cell with what its record
/// holds. A cell without a record has failed, with what is known of its end as the reason.
struct StudyFolder {
  std::filesystem::path path;
  StudyFile study;  ///< of study.yaml: metrics, figures, what is compared with what
  StudyResult result;
  std::vector<std::filesystem::path> record_of_run;  ///< of result.runs; empty: there is none
};
/// Throws InputError where the folder is no study's, or a record is spoilt or of another version
/// than the others.
[[nodiscard]] StudyFolder ReadStudyFolder(const std::filesystem::path& folder);
[[nodiscard]] StudyResult ReadStudy(const std::filesystem::path& folder);

/// The cells of plan.csv, without what came of them.
[[nodiscard]] std::vector<StudyRun> ReadPlan(const std::filesystem::path& folder);
/// The same from its text; `file` is for errors. Throws InputError.
[[nodiscard]] std::vector<StudyRun> ParsePlan(std::string_view text, const std::string& file);

/// plan.csv: one row a cell, `id,stream_id,stream,estimator,setting,perturbation,seed`.
[[nodiscard]] std::string PlanCsv(const StudyPlan& plan);
/// runs.csv (docs/formats.md).
[[nodiscard]] std::string RunsCsv(const StudyResult& result);
/// Medians over the runs that did not fail: one row for each stream, estimator, setting and
/// perturbation; and what `tables` say. `metrics`: empty for a choice.
[[nodiscard]] StudyTable StudySummaryTable(const StudyResult& result,
                                           const std::vector<std::string>& metrics,
                                           const std::vector<StudyTable>& tables);

/// How runs ended that left no record: failures/<id> of a study's folder.
[[nodiscard]] std::filesystem::path FailureFile(const std::filesystem::path& folder,
                                                const std::string& id);

}  // namespace duet
