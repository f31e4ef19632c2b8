#pragma once

#include <string>
#include <utility>
#include <vector>

#include "evaluation/study_table.h"
#include "experiments/study/study_records.h"

namespace duet {

/// What a study's file asks of its tables. Published numbers are those that the folder has
/// (published/*.csv). Throws InputError.
[[nodiscard]] StudyTableOptions TableOptionsOf(const StudyFolder& folder);

/// tables/NAME.{txt,csv,md,tex} of every table, by their path in the folder.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> TableTexts(
    const std::vector<StudyTable>& tables);

}  // namespace duet
