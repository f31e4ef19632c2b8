#include "experiments/study/study_records.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "common/config/config_sources.h"
#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "evaluation/statistics.h"
#include "evaluation/text_table.h"
#include "experiments/configuration.h"
#include "experiments/manifest_reader.h"
#include "experiments/settings_foot.h"
#include "experiments/study/record_version.h"
#include "experiments/study/run_evaluation.h"
#include "experiments/study/study_run.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlanHeader = "#id,stream_id,stream,estimator,setting,perturbation,seed\n";

/// Fills a run in from its record, which must be of the records' version; false where there is
/// none.
bool ReadRecordOf(const fs::path& folder, std::optional<RecordVersion>* version, StudyRun* run) {
  const fs::path record = RecordFolderOf(folder, run->id);
  if (!fs::exists(record)) {
    run->failed = true;
    const fs::path failure = FailureFile(folder, run->id);
    run->reason =
        fs::exists(failure) ? ReadTextFile(failure) : "there is no record: it did not run";
    while (run->reason.ends_with('\n')) run->reason.pop_back();
    return false;
  }
  const RunEvaluation evaluation = ReadEvaluation(record);
  run->failed = evaluation.failed;
  run->reason = evaluation.reason;
  run->metrics = evaluation.metrics;
  for (auto& cost : CostOfRecord(record)) run->metrics.push_back(std::move(cost));
  const fs::path file = record / "manifest.json";
  const ManifestReader manifest(ReadTextFile(file), file.string());
  run->tracks_sha256 = manifest.Text("tracks_sha256");
  const RecordVersion own{manifest.Text("version"), manifest.Text("commit")};
  if (!*version) *version = own;
  if (!(own == **version)) {
    throw InputError(record.string(), 0, "",
                     "was made by " + own.Text() + ", others by " + (*version)->Text() +
                         "; results of two are not mixed");
  }
  return true;
}

std::string Count(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

const double* FindValue(const StudyRun& run, const std::string& key) {
  for (const auto& [name, value] : run.metrics) {
    if (name == key) return &value;
  }
  return nullptr;
}

/// The cells of one estimator and setting.
struct FootGroup {
  std::string estimator;
  std::string setting;
  std::vector<fs::path> records;  ///< different ones, in their order
  std::vector<fs::path> ran;      ///< those of them that did not fail
};

std::vector<FootGroup> FootGroups(const StudyFolder& folder) {
  std::vector<FootGroup> groups;
  for (std::size_t i = 0; i < folder.result.runs.size(); ++i) {
    const StudyRun& run = folder.result.runs[i];
    const fs::path& record = folder.record_of_run[i];
    if (record.empty()) continue;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const FootGroup& g) {
      return g.estimator == run.estimator && g.setting == run.setting;
    });
    if (group == groups.end()) group = groups.insert(group, {run.estimator, run.setting, {}, {}});
    if (std::find(group->records.begin(), group->records.end(), record) != group->records.end()) {
      continue;
    }
    group->records.push_back(record);
    if (!run.failed) group->ran.push_back(record);
  }
  return groups;
}

/// In one line, as a person reads it.
std::string ValueText(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kScalar) return node.scalar;
  std::string text;
  for (const YamlNode& item : node.items) text += (text.empty() ? "" : ", ") + ValueText(item);
  for (const YamlNode::Entry& entry : node.entries) {
    text += (text.empty() ? "" : ", ") + entry.key + ": " + ValueText(entry.value);
  }
  return node.kind == YamlNode::Kind::kNull ? "null" : "[" + text + "]";
}

/// "shared.calibration.t_d.state: estimated, ..."
std::string KeysText(const std::vector<StudyKey>& keys) {
  std::string text;
  for (const StudyKey& key : keys) {
    text += (text.empty() ? "" : ", ") + key.key + ": " + ValueText(key.value);
  }
  return text;
}

/// What a setting or perturbation changes; that of a study's only one is below every run alike.
void AddChange(const char* axis, const StudyChange& change, std::vector<std::string>* foot) {
  std::string text = KeysText(change.set);
  for (const auto& [estimator, keys] : change.only) {
    text += (text.empty() ? "" : "; ") + ("for " + estimator + " alone ") + KeysText(keys);
  }
  if (!text.empty()) foot->push_back(std::string(axis) + " " + change.name + ": " + text);
}

/// What each stream was seen by and for how long, from its first record.
void AddStreams(const StudyFolder& folder, std::vector<std::string>* foot) {
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < folder.result.runs.size(); ++i) {
    const std::string& stream = folder.result.runs[i].stream;
    if (folder.record_of_run[i].empty()) continue;
    if (std::find(seen.begin(), seen.end(), stream) != seen.end()) continue;
    seen.push_back(stream);
    const fs::path file = folder.record_of_run[i] / "manifest.json";
    const auto manifest = nlohmann::json::parse(ReadTextFile(file), nullptr, false);
    if (!manifest.is_object() || !manifest.contains("dataset")) continue;
    const auto& dataset = manifest["dataset"];
    const auto cameras = dataset.find("cameras");
    const double* duration = FindValue(folder.result.runs[i], "truth.duration_s");
    std::string text = stream + ":";
    if (cameras != dataset.end() && cameras->is_array()) {
      text += cameras->size() == 1 ? " camera" : " cameras";
      for (const auto& camera : *cameras) text += " " + camera.dump();
    }
    if (duration != nullptr) text += ", truth over " + FormatFixed(*duration, 1) + " s of a run";
    foot->push_back(text);
  }
}

/// What was switched on in the records of each estimator and setting, what the settings and
/// perturbations change, and what the streams are.
void AddFoot(const StudyFolder& folder, std::vector<std::string>* foot) {
  std::optional<RecordVersion> version;
  for (const FootGroup& group : FootGroups(folder)) {
    const fs::path& record = group.records.front();
    if (!version) version = VersionOf(record);
    ConfigSources sources;
    sources.AddFile(record / "config.yaml");
    Configuration configuration;
    configuration.Read(&sources);
    std::string line = group.estimator + ", " + group.setting + ":";
    for (const auto& [title, value] : SettingsFoot(sources.values(), group.estimator, group.ran)) {
      line += (line.back() == ':' ? " " : ", ") + title + " " + value;
    }
    foot->push_back(line);
  }
  for (const StudyChange& setting : folder.study.settings) AddChange("setting", setting, foot);
  for (const StudyChange& change : folder.study.perturbations) {
    AddChange("perturbation", change, foot);
  }
  AddStreams(folder, foot);
  std::set<fs::path> records(folder.record_of_run.begin(), folder.record_of_run.end());
  records.erase(fs::path());
  foot->push_back(Count(records.size(), "record") + " for " +
                  Count(folder.result.runs.size(), "cell") + " of the grid" +
                  (version ? ", by " + version->Text() : ""));
}

/// What an id is: it names a folder of runs/ or streams/, and nothing outside of them.
std::string FolderName(const CsvReader& reader, int column) {
  constexpr std::size_t kLongest = 64;
  std::string id(reader.Text(column));
  const bool fits = std::all_of(id.begin(), id.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  });
  if (id.empty() || id.size() > kLongest || !fits) {
    reader.Fail(column, "expected an id of at most 64 letters and digits");
  }
  return id;
}

std::string NameIn(const CsvReader& reader, int column) {
  if (reader.Text(column).empty()) reader.Fail(column, "is empty; expected a name");
  return std::string(reader.Text(column));
}

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// Every key of any run; those of later runs stand behind the key that they follow there.
std::vector<std::string> MetricColumns(const StudyResult& result) {
  std::vector<std::string> columns;
  for (const StudyRun& run : result.runs) {
    auto behind = columns.begin();
    for (const auto& [key, value] : run.metrics) {
      const auto found = std::find(columns.begin(), columns.end(), key);
      behind = (found == columns.end() ? columns.insert(behind, key) : found) + 1;
    }
  }
  return columns;
}

}  // namespace

fs::path FailureFile(const fs::path& folder, const std::string& id) {
  return folder / "failures" / id;
}

std::vector<StudyRun> ReadPlan(const fs::path& folder) {
  const fs::path file = folder / "plan.csv";
  return ParsePlan(ReadTextFile(file), file.string());
}

std::vector<StudyRun> ParsePlan(std::string_view text, const std::string& file) {
  CsvReader reader(text, file,
                   {{"id", "stream_id", "stream", "estimator", "setting", "perturbation", "seed"}});
  std::vector<StudyRun> runs;
  while (reader.Next()) {
    StudyRun& run = runs.emplace_back();
    run.id = FolderName(reader, 0);
    run.stream_id = FolderName(reader, 1);
    run.stream = NameIn(reader, 2);
    run.estimator = NameIn(reader, 3);
    run.setting = NameIn(reader, 4);
    run.perturbation = NameIn(reader, 5);
    const std::uint64_t seed = reader.Unsigned(6);
    if (seed > std::numeric_limits<int>::max()) reader.Fail(6, "expected the seed of a run");
    run.seed = static_cast<int>(seed);
  }
  reader.RequireRows();
  return runs;
}

bool IsStudyFolder(const fs::path& folder) {
  return fs::exists(folder / "plan.csv") && fs::exists(folder / "study.yaml");
}

StudyFolder ReadStudyFolder(const fs::path& folder) {
  if (!IsStudyFolder(folder)) {
    throw InputError(folder.string(), 0, "", "has no plan.csv; expected the folder of duet study");
  }
  StudyFolder study;
  study.path = folder;
  study.study = ReadStudyFile(folder / "study.yaml", /*quick=*/false);
  study.result.name = study.study.name;
  study.result.question = study.study.question;
  study.result.runs = ReadPlan(folder);
  std::optional<RecordVersion> version;
  for (StudyRun& run : study.result.runs) {
    const bool there = ReadRecordOf(folder, &version, &run);
    study.record_of_run.push_back(there ? RecordFolderOf(folder, run.id) : fs::path());
  }
  AddFoot(study, &study.result.foot);
  return study;
}

StudyResult ReadStudy(const fs::path& folder) { return ReadStudyFolder(folder).result; }

std::string PlanCsv(const StudyPlan& plan) {
  std::string text = kPlanHeader;
  for (const PlannedRun& run : plan.runs) {
    const StudyFile& study = plan.study;
    text += run.id + "," + plan.InputOf(run).id + "," + plan.StreamOf(run).name + "," +
            run.estimator + "," + study.settings[static_cast<std::size_t>(run.setting)].name + "," +
            study.perturbations[static_cast<std::size_t>(run.perturbation)].name + "," +
            std::to_string(run.seed) + "\n";
  }
  return text;
}

std::string RunsCsv(const StudyResult& result) {
  const std::vector<std::string> columns = MetricColumns(result);
  std::string text = "id,stream,estimator,setting,perturbation,seed,failed,reason";
  for (const std::string& column : columns) text += "," + column;
  text += "\n";
  for (const StudyRun& run : result.runs) {
    text += run.id + "," + run.stream + "," + run.estimator + "," + run.setting + "," +
            run.perturbation + "," + std::to_string(run.seed) + "," + (run.failed ? "1" : "0") +
            "," + Quoted(run.reason);
    for (const std::string& column : columns) {
      const double* value = FindValue(run, column);
      text += "," + (value == nullptr ? "" : FormatNumber(*value));
    }
    text += "\n";
  }
  return text;
}

}  // namespace duet
