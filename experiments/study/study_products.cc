#include "experiments/study/study_products.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "common/support/input_error.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"
#include "experiments/manifest.h"
#include "experiments/study/record_version.h"
#include "experiments/study/study_tables.h"
#include "experiments/study/tuning_result.h"

namespace duet {

namespace fs = std::filesystem;

namespace {

void Remove(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw OutputError(file.string(), "cannot be removed: " + error.message());
}

/// Products are removed before new ones are made: nothing else may be.
bool IsWithinFolder(const fs::path& name) {
  return !name.empty() && name.is_relative() && name.has_filename() &&
         std::none_of(name.begin(), name.end(),
                      [](const fs::path& part) { return part == ".." || part == "."; });
}

/// tables/ is the study's own: whatever it does not make is of an earlier one.
void RemoveStaleTables(const fs::path& folder,
                       const std::vector<std::pair<std::string, std::string>>& texts) {
  std::set<std::string> made;
  for (const auto& [name, text] : texts) made.insert(name);
  std::error_code ignored;
  std::vector<fs::path> stale;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "tables", ignored)) {
    const std::string name = "tables/" + entry.path().filename().string();
    if (entry.is_regular_file() && !made.contains(name)) stale.push_back(entry.path());
  }
  for (const fs::path& file : stale) Remove(file);
}

}  // namespace

std::map<std::string, std::string> ReadProducts(const fs::path& folder) {
  const fs::path file = folder / "manifest.json";
  if (!fs::exists(file)) return {};
  return ParseProducts(ReadTextFile(file), file.string());
}

std::map<std::string, std::string> ParseProducts(std::string_view text, const std::string& file) {
  std::map<std::string, std::string> products;
  try {
    products = Manifest::parse(text).value("products", products);
  } catch (const nlohmann::ordered_json::exception& error) {
    throw InputError(file, 0, "", std::string("is no manifest: ") + error.what());
  }
  for (const auto& [name, hash] : products) {
    if (IsWithinFolder(name)) continue;
    throw InputError(file, 0, "products." + name, "expected a file within the folder");
  }
  return products;
}

std::vector<std::pair<std::string, std::string>> StudyTexts(const StudyFolder& folder) {
  const std::vector<StudyTable> tables = MakeStudyTables(folder.result, TableOptionsOf(folder));
  std::vector<std::pair<std::string, std::string>> texts = TableTexts(tables);
  texts.emplace_back("runs.csv", RunsCsv(folder.result));
  texts.emplace_back("summary.txt",
                     TableText(StudySummaryTable(folder.result, folder.study.metrics, tables)));
  if (IsTuningFolder(folder.path)) {
    for (auto& text : TuningTexts(folder)) texts.push_back(std::move(text));
  }
  return texts;
}

void WriteStudyProducts(const fs::path& folder, bool quick, const std::string& command_line,
                        const StudyFinish& finish) {
  const StudyFolder study = ReadStudyFolder(folder);
  const auto texts = StudyTexts(study);
  RemoveStaleTables(folder, texts);
  for (const auto& [name, text] : texts) {
    MakeFolder((folder / name).parent_path());
    ReplaceTextFile(folder / name, text);
  }
  // Before new ones are made: the report shows what is there.
  for (const auto& [name, hash] : ReadProducts(folder)) Remove(folder / name);
  std::vector<std::string> products;
  if (finish) products = finish(study);

  Manifest manifest = StartManifest(command_line);
  int failed = 0;
  for (const StudyRun& run : study.result.runs) failed += run.failed ? 1 : 0;
  manifest["study"] = study.result.name;
  manifest["quick"] = quick;
  manifest["outcome"] = {
      {"status", "done"}, {"runs", study.result.runs.size()}, {"failed", failed}};
  manifest["products"] = Manifest::object();
  for (const std::string& name : products) {
    manifest["products"][name] = Sha256Hex(ReadTextFile(folder / name));
  }
  WriteManifest(manifest, folder);
}

}  // namespace duet
