#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "experiments/study/study_records.h"

namespace duet {

/// The texts that a study's folder holds besides its records and that are made of these alone, by
/// their path in it: runs.csv, summary.txt and, where tables are made, tables/*. The one place
/// where they join in; duet verify makes them again and compares.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> StudyTexts(
    const StudyFolder& folder);

/// Writes them and what else is made (figures, report), then the manifest.
/// Throws InputError and OutputError.
void WriteStudyProducts(const std::filesystem::path& folder, bool quick,
                        const std::string& command_line);

}  // namespace duet
