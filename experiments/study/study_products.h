#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/study/study_records.h"

namespace duet {

/// The texts that a study's folder holds besides its records and that are made of these alone, by
/// their path in it: runs.csv, summary.txt and, where tables are made, tables/*. The one place
/// where they join in; duet verify makes them again and compares.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> StudyTexts(
    const StudyFolder& folder);

/// What is made of a study besides, at its end: figures, report. Returns their files, by their
/// paths in the folder.
using StudyFinish = std::function<std::vector<std::string>(const StudyFolder& folder)>;

/// The files that `finish` has made when the study was last done, with their SHA-256; empty where
/// it has not been done.
[[nodiscard]] std::map<std::string, std::string> ReadProducts(const std::filesystem::path& folder);
/// The same from the text of a manifest.json; `file` is for errors. Throws InputError, also for a
/// file that is not within the folder.
[[nodiscard]] std::map<std::string, std::string> ParseProducts(std::string_view text,
                                                               const std::string& file);

/// Writes the texts, calls `finish`, then writes the manifest, which lists what `finish` made. What
/// an earlier study of this folder made and this one does not (tables of other metrics, figures
/// that are no longer asked for) is removed; files of others stay. Throws InputError and
/// OutputError.
void WriteStudyProducts(const std::filesystem::path& folder, bool quick,
                        const std::string& command_line, const StudyFinish& finish);

}  // namespace duet
