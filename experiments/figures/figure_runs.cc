#include "experiments/figures/figure_runs.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/figures/figure_style.h"
#include "experiments/study/record_version.h"
#include "experiments/study/study_records.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostExamples = 6;

std::string RecordingName(const fs::path& dataset) {
  const fs::path folder = dataset.lexically_normal();
  const fs::path name = folder.filename().empty() ? folder.parent_path() : folder;
  return (name.filename() == "mav0" ? name.parent_path() : name).filename().string();
}

bool IsRun(const fs::path& folder) {
  return fs::exists(folder / "manifest.json") && fs::exists(folder / "states.csv");
}

// A plain record: its stream is the recording it ran on.
FigureRun PlainRun(const fs::path& folder, const nlohmann::ordered_json& manifest) {
  FigureRun run{.folder = folder, .study = {}, .where = {}, .label = {}};
  run.where.estimator = JsonText(manifest, "backend");
  if (const auto dataset = manifest.find("dataset"); dataset != manifest.end()) {
    run.where.stream = RecordingName(JsonText(*dataset, "path"));
    run.where.stream_id = JsonText(*dataset, "fingerprint_sha256");
  }
  return run;
}

// A record of a study: where it stands in the grid is said by its study.json.
FigureRun StudyRecord(const fs::path& folder) {
  const fs::path file = folder / "study.json";
  const nlohmann::ordered_json json = ReadJsonFile(file);
  FigureRun run{
      .folder = folder, .study = folder.parent_path().parent_path(), .where = {}, .label = {}};
  StudyRun& where = run.where;
  for (const auto& [key, value] :
       {std::pair{"stream", &where.stream}, std::pair{"estimator", &where.estimator},
        std::pair{"setting", &where.setting}, std::pair{"perturbation", &where.perturbation}}) {
    *value = JsonText(json, key);
    if (value->empty()) throw InputError(file, 0, key, "is missing; expected a text");
  }
  const auto seed = json.find("seed");
  if (seed == json.end() || !seed->is_number_integer()) {
    throw InputError(file, 0, "seed", "is missing; expected an integer");
  }
  where.seed = seed->get<int>();
  where.stream_id = JsonText(json, "stream_id");
  return run;
}

void ReadOutcome(const nlohmann::ordered_json& manifest, StudyRun* where) {
  where->tracks_sha256 = JsonText(manifest, "tracks_sha256");
  if (const auto outcome = manifest.find("outcome"); outcome != manifest.end()) {
    where->failed = JsonText(*outcome, "status") != "done";
    where->reason = JsonText(*outcome, "reason");
  }
}

FigureRun ReadRun(const fs::path& folder) {
  const nlohmann::ordered_json manifest = ReadJsonFile(folder / "manifest.json");
  FigureRun run =
      fs::exists(folder / "study.json") ? StudyRecord(folder) : PlainRun(folder, manifest);
  run.where.id = folder.filename();
  ReadOutcome(manifest, &run.where);
  return run;
}

std::vector<fs::path> FoldersIn(const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() && IsRun(entry.path())) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

// The grid's own order is not in the folder's names.
bool BeforeInGrid(const FigureRun& a, const FigureRun& b) {
  const auto key = [](const FigureRun& run) {
    const StudyRun& where = run.where;
    return std::tie(where.stream, where.setting, where.perturbation, where.seed, where.estimator);
  };
  return key(a) < key(b);
}

// As the study's own tables: results of two versions are not drawn together.
void RequireOneVersion(const std::vector<FigureRun>& runs) {
  std::optional<RecordVersion> first;
  for (const FigureRun& run : runs) {
    if (!run.has_record()) continue;
    const RecordVersion version = VersionOf(run.folder);
    if (!first) first = version;
    if (version == *first) continue;
    throw InputError(run.folder, 0, "",
                     "was made by " + version.Text() + ", others by " + first->Text() +
                         "; results of two are not mixed");
  }
}

// The cells of a study's grid, by its plan.csv where it has one (cells may share a record), else (a
// folder made by hand) by what its records say.
std::vector<FigureRun> StudyRuns(const fs::path& folder) {
  std::vector<FigureRun> runs;
  if (!fs::exists(folder / "plan.csv")) {
    for (const fs::path& record : FoldersIn(folder / "runs")) runs.push_back(ReadRun(record));
    std::stable_sort(runs.begin(), runs.end(), BeforeInGrid);
    return runs;
  }
  for (StudyRun& cell : ReadPlan(folder)) {
    const fs::path record = folder / "runs" / cell.id;
    FigureRun run{.folder = {}, .study = folder, .where = std::move(cell), .label = {}};
    if (IsRun(record)) {
      run.folder = record;
      ReadOutcome(ReadJsonFile(record / "manifest.json"), &run.where);
    } else {
      run.where.failed = true;
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

const FigureRun& FirstWithRecord(const std::vector<FigureRun>& runs) {
  const auto found =
      std::find_if(runs.begin(), runs.end(), [](const FigureRun& run) { return run.has_record(); });
  return found == runs.end() ? runs.front() : *found;
}

void LabelRuns(std::vector<FigureRun>* runs) {
  std::set<std::string> streams, settings, perturbations;
  std::set<int> seeds;
  for (const FigureRun& run : *runs) {
    streams.insert(run.where.stream);
    settings.insert(run.where.setting);
    perturbations.insert(run.where.perturbation);
    seeds.insert(run.where.seed);
  }
  for (FigureRun& run : *runs) {
    run.label = run.where.estimator;
    if (settings.size() > 1) run.label += ", " + run.where.setting;
    if (perturbations.size() > 1) run.label += ", " + run.where.perturbation;
    if (streams.size() > 1) run.label += ", " + run.where.stream;
    if (seeds.size() > 1) run.label += ", seed " + std::to_string(run.where.seed);
  }
}

bool OnOneRecording(const FigureRun& a, const FigureRun& b) {
  return a.where.stream == b.where.stream && a.where.stream_id == b.where.stream_id;
}

// Of plain records the same estimator on the same recording: apart by their folders' names.
void TellPlainRunsApart(std::vector<FigureRun>* runs) {
  const auto alike = [](const FigureRun& a, const FigureRun& b) {
    return OnOneRecording(a, b) && a.where.estimator == b.where.estimator;
  };
  for (const FigureRun& a : *runs) {
    const bool twice = std::any_of(runs->begin(), runs->end(), [&](const FigureRun& b) {
      return &a != &b && a.study.empty() && b.study.empty() && alike(a, b);
    });
    if (!twice) continue;
    for (FigureRun& run : *runs) {
      if (!run.study.empty()) continue;
      const bool of_compare = run.folder.filename() == run.where.estimator;
      run.where.setting = (of_compare ? run.folder.parent_path() : run.folder).filename().string();
    }
    return;
  }
}

}  // namespace

std::string JsonText(const nlohmann::ordered_json& json, const std::string& key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

nlohmann::ordered_json ReadJsonFile(const fs::path& file) {
  try {
    return nlohmann::ordered_json::parse(ReadTextFile(file));
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(file, 0, "", std::string("expected JSON: ") + error.what());
  }
}

FoundRuns FindRuns(const FigureInput& input) {
  std::vector<FigureRun> runs;
  for (const fs::path& folder : input.folders) {
    if (!fs::exists(folder)) throw InputError(folder, 0, "", "does not exist; expected a folder");
    if (IsRun(folder)) {
      runs.push_back(ReadRun(fs::absolute(folder).lexically_normal()));
      runs.back().folder = folder;
      continue;
    }
    std::vector<FigureRun> found;
    if (fs::is_directory(folder / "runs")) {
      found = StudyRuns(folder);
      RequireOneVersion(found);
      if (std::none_of(found.begin(), found.end(),
                       [](const FigureRun& run) { return run.has_record(); })) {
        found.clear();
      }
    } else {
      for (const fs::path& record : FoldersIn(folder)) found.push_back(ReadRun(record));
    }
    if (found.empty()) {
      throw InputError(folder, 0, "",
                       "has no run record; expected the folder of a study (runs/<id>), of duet "
                       "compare or of duet run");
    }
    runs.insert(runs.end(), found.begin(), found.end());
  }
  if (runs.empty()) {
    throw InputError("", 0, "--runs",
                     "expected the folder of a study, of duet compare or of duet run");
  }
  TellPlainRunsApart(&runs);
  std::vector<FigureRun> chosen = ChosenRuns(runs, input.choice);
  LabelRuns(&chosen);
  return {.found = std::move(runs), .chosen = std::move(chosen), .choice = input.choice};
}

std::vector<FigureRun> ExampleCells(const FoundRuns& runs) {
  std::vector<FigureRun> cells;
  const FigureRun& first = FirstWithRecord(runs.chosen);
  for (const FigureRun& run : runs.chosen) {
    const bool same = run.study.empty() ? run.where.stream == first.where.stream
                                        : run.where.stream == first.where.stream &&
                                              run.where.setting == first.where.setting &&
                                              run.where.perturbation == first.where.perturbation &&
                                              run.where.seed == first.where.seed;
    if (same && run.study.empty() == first.study.empty()) cells.push_back(run);
  }
  RequireEachChosen(cells, runs.choice);
  return cells;
}

std::vector<FigureRun> ExampleRuns(const FoundRuns& runs) {
  std::vector<FigureRun> examples;
  for (const FigureRun& run : ExampleCells(runs)) {
    if (run.has_record() && examples.size() < kMostExamples) examples.push_back(run);
  }
  LabelRuns(&examples);
  return examples;
}

std::vector<FigureRun> RunsOfFirstGroup(const FoundRuns& runs) {
  std::vector<FigureRun> group;
  const StudyRun& first = FirstWithRecord(runs.chosen).where;
  for (const FigureRun& run : runs.chosen) {
    const bool again = std::any_of(group.begin(), group.end(), [&run](const FigureRun& other) {
      return OnOneRecording(run, other) && run.where.estimator == other.where.estimator;
    });
    const bool of_group = run.study.empty() ? !again
                                            : run.where.stream == first.stream &&
                                                  run.where.setting == first.setting &&
                                                  run.where.perturbation == first.perturbation;
    if (of_group) group.push_back(run);
  }
  RequireEachChosen(group, runs.choice);
  LabelRuns(&group);
  return group;
}

std::string DrawnNote(const FoundRuns& runs, const std::vector<FigureRun>& drawn) {
  if (drawn.empty() || drawn.front().study.empty()) return "";
  std::string note;
  for (const RunCoordinate& coordinate : RunCoordinates()) {
    std::set<std::string> of_all, of_drawn;
    for (const FigureRun& run : runs.found) of_all.insert(coordinate.value(run.where));
    for (const FigureRun& run : drawn) of_drawn.insert(coordinate.value(run.where));
    const std::string count = std::to_string(of_all.size());
    if (of_all.size() == 1 && *of_all.begin() == coordinate.silent) continue;
    const bool of_estimators = coordinate.chosen == &RunChoice::estimators;
    if (of_estimators && of_drawn.size() == of_all.size()) continue;  // the legend has them all
    note += note.empty() ? "Drawn: " : ", ";
    if (of_drawn.size() == 1) {
      note += std::string(coordinate.name) + " " + *of_drawn.begin();
      if (of_all.size() > 1) note += " (of " + count + ")";
    } else {
      if (of_drawn.size() < of_all.size()) note += std::to_string(of_drawn.size()) + " of ";
      note += count + " " + coordinate.name + "s";
    }
  }
  return note + ".";
}

std::string FailedNote(const std::vector<FigureRun>& runs, const std::string& so) {
  std::string note;
  for (const std::string& estimator : EstimatorsOf(runs)) {
    int all = 0;
    int failed = 0;
    for (const FigureRun& run : runs) {
      if (run.where.estimator != estimator) continue;
      ++all;
      failed += run.where.failed ? 1 : 0;
    }
    if (failed == 0) continue;
    note += (note.empty() ? "" : ", ") + std::to_string(failed) + " of " + CountOfRuns(all) +
            " of " + estimator;
  }
  return note.empty() ? "" : note + " failed: " + so + ".";
}

void AddNote(std::string note, Figure* figure) {
  if (!note.empty()) figure->notes.push_back(std::move(note));
}

std::vector<std::string> EstimatorsOf(const std::vector<FigureRun>& runs) {
  std::vector<std::string> names;
  for (const FigureRun& run : runs) {
    if (std::find(names.begin(), names.end(), run.where.estimator) == names.end()) {
      names.push_back(run.where.estimator);
    }
  }
  return names;
}

std::vector<Look> LooksOf(const std::vector<FigureRun>& runs) {
  const bool each_once = EstimatorsOf(runs).size() == runs.size();
  std::vector<Look> looks;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    looks.push_back(each_once ? LookOfEstimator(runs[n].where.estimator, n) : LookOf(n));
  }
  return looks;
}

std::string CountOfRuns(int count) {
  return std::to_string(count) + (count == 1 ? " run" : " runs");
}

std::string DescribeSource(const FigureRun& run) {
  if (!run.has_record()) return "runs/" + run.where.id + " (" + run.label + "): no record";
  const nlohmann::ordered_json manifest = ReadJsonFile(run.folder / "manifest.json");
  std::string text =
      run.study.empty() ? run.folder.lexically_normal().string() : "runs/" + run.where.id;
  text += " (" + run.label + "): duet " + JsonText(manifest, "version") + " " +
          JsonText(manifest, "commit");
  if (!run.where.tracks_sha256.empty()) {
    text += ", tracks " + run.where.tracks_sha256.substr(0, 16);
  }
  return text;
}

std::vector<std::string> DescribeSources(const std::vector<FigureRun>& runs) {
  std::vector<std::string> sources;
  for (const FigureRun& run : runs) sources.push_back(DescribeSource(run));
  return sources;
}

}  // namespace duet
