#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/study_result.h"
#include "evaluation/study_table.h"
#include "experiments/report/run_curves.h"

namespace duet {

struct ReportRun {
  StudyRun run;
  std::filesystem::path record;
  std::string program;  ///< version and commit that made the record
  std::string settings_sha256;
  /// Its estimate is shown as it is; otherwise it is first laid onto the truth.
  bool started_from_truth = false;
  std::optional<RunCurves> curves;  ///< thinned
};

struct ReportFigure {
  std::string name;   ///< of its file, without the ending
  std::string title;  ///< what it shows
  std::string media_type;
  std::string bytes;
};

/// Text that stands as it is, in letters of one width.
struct ReportText {
  std::string title;
  std::string text;
};

/// What a report shows. Everything in it comes from records.
struct Report {
  std::string kind;  ///< "study", "comparison", "run"
  std::string title;
  std::string question;
  std::vector<std::string> summary;  ///< sentences, the first of them the most important
  StudyTable overview;               ///< of a study: all of it in one table; else without columns
  std::vector<StudyTable> tables;
  std::vector<ReportText> texts;
  std::vector<ReportFigure> figures;
  std::vector<ReportRun> runs;
  std::vector<std::string> foot;
};

/// Bytes that a report may have; curves are thinned to what is left of them.
inline constexpr std::size_t kMostReportBytes = 4'800'000;

/// How many instants of each run leave the page below kMostReportBytes; `report` without curves. At
/// least 60: the page of very many runs is larger.
[[nodiscard]] std::size_t InstantsThatFit(const Report& report);

/// The report of a study's folder, of a `duet compare` folder or of a run record. Throws
/// InputError.
[[nodiscard]] Report ReadReport(const std::filesystem::path& folder);

/// The page: one HTML file that needs no other, and no network. The same report gives the same
/// bytes.
[[nodiscard]] std::string ReportPage(const Report& report);

/// Both: writes the page of a folder, complete or not at all, and gives its bytes; a file of that
/// name is replaced. Throws InputError and OutputError.
std::size_t WriteReport(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace duet
