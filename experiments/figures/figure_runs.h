#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "evaluation/study_result.h"
#include "experiments/figures/figure.h"
#include "experiments/figures/figures.h"
#include "experiments/figures/run_choice.h"

namespace duet {

/// One run record that a figure may be made from.
struct FigureRun {
  /// Of the record; empty for a cell of a study's grid that has left none (it counts as failed).
  std::filesystem::path folder;
  std::filesystem::path study;  ///< the folder of the study that it is of; empty: none
  StudyRun where;               ///< metrics are not filled in; plain records: docs/figures.md
  /// For legends: the estimator, and every further coordinate in which the runs found differ.
  std::string label;

  [[nodiscard]] bool has_record() const { return !folder.empty(); }
};

/// What a figure may draw, in the order of the folders and, of a study, of its grid.
struct FoundRuns {
  std::vector<FigureRun> found;   ///< all in the folders
  std::vector<FigureRun> chosen;  ///< those of them that figures are made of; one has a record
  RunChoice choice;
};

/// The run records in folders that may be studies (runs/<id>), of `duet compare` (one folder an
/// estimator) or of one run, in their order; runs that failed too. Throws InputError for a folder
/// that is none of these, naming what it expected, and for a choice as ChosenRuns does.
[[nodiscard]] FoundRuns FindRuns(const FigureInput& input);

/// Those of `found` that a choice leaves (run_choice.cc). Of records that are of no study the
/// stream is the recording's name, and seed, setting and perturbation do not exist. Throws
/// InputError for an unknown name, naming the nearest, where no run with a record is left, and
/// where one of several names has no run among them.
[[nodiscard]] std::vector<FigureRun> ChosenRuns(const std::vector<FigureRun>& found,
                                                const RunChoice& choice);
/// Throws InputError where a name of the choice has no run among these.
void RequireEachChosen(const std::vector<FigureRun>& drawn, const RunChoice& choice);

/// What a figure over time shows of many: the runs on the same stream, setting, perturbation and
/// seed as the first chosen that has a record; of plain records those on the first one's recording.
/// Runs that failed are in it as far as they went. At most six.
[[nodiscard]] std::vector<FigureRun> ExampleRuns(const FoundRuns& runs);

/// Which runs statistics are over: those chosen on the first one's stream, setting and
/// perturbation, whatever their seed; of plain records the first of each estimator on each
/// recording.
[[nodiscard]] std::vector<FigureRun> RunsOfFirstGroup(const FoundRuns& runs);

/// For a figure's notes, of a study: which of its streams, settings, perturbations and seeds (and,
/// where some are left out, estimators) are drawn, and of how many found: "Drawn: stream room (of
/// 3), seed 1 (of 8)." Empty of plain records.
[[nodiscard]] std::string DrawnNote(const FoundRuns& runs, const std::vector<FigureRun>& drawn);

/// For a figure's notes: "5 of 8 runs of window failed: left out." Empty where none of `runs` did.
[[nodiscard]] std::string FailedNote(const std::vector<FigureRun>& runs, const std::string& so);

/// The cells where ExampleRuns are taken from, those without a record too.
[[nodiscard]] std::vector<FigureRun> ExampleCells(const FoundRuns& runs);

/// Adds a note that is not empty.
void AddNote(std::string note, Figure* figure);

/// Estimators in the order of their first runs.
[[nodiscard]] std::vector<std::string> EstimatorsOf(const std::vector<FigureRun>& runs);

/// manifest.json, or another JSON file of a record. Throws InputError.
[[nodiscard]] nlohmann::ordered_json ReadJsonFile(const std::filesystem::path& file);

/// A text of it; empty where it is not there.
[[nodiscard]] std::string JsonText(const nlohmann::ordered_json& json, const std::string& key);

/// The looks of runs that are drawn together: the estimators' own where each is there once.
[[nodiscard]] std::vector<Look> LooksOf(const std::vector<FigureRun>& runs);

/// "1 run", "2 runs".
[[nodiscard]] std::string CountOfRuns(int count);

/// For the files' comments: path, program's version and commit, tracks.
[[nodiscard]] std::string DescribeSource(const FigureRun& run);
[[nodiscard]] std::vector<std::string> DescribeSources(const std::vector<FigureRun>& runs);

}  // namespace duet
