#pragma once

#include <filesystem>
#include <functional>
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

/// What is made of a study besides, at its end: figures, report.
using StudyFinish = std::function<void(const StudyFolder& folder)>;

/// Writes the texts, calls `finish`, then writes the manifest. Throws InputError and OutputError.
void WriteStudyProducts(const std::filesystem::path& folder, bool quick,
                        const std::string& command_line, const StudyFinish& finish);

}  // namespace duet
