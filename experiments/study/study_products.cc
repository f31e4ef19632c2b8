#include "experiments/study/study_products.h"

#include <set>

#include "common/support/text_file.h"
#include "experiments/manifest.h"
#include "experiments/study/record_version.h"
#include "experiments/study/study_tables.h"
#include "experiments/study/tuning_result.h"

namespace duet {

namespace fs = std::filesystem;

std::vector<std::pair<std::string, std::string>> StudyTexts(const StudyFolder& folder) {
  const std::vector<StudyTable> tables = MakeStudyTables(folder.result, TableOptionsOf(folder));
  std::vector<std::pair<std::string, std::string>> texts = TableTexts(tables);
  texts.emplace_back("runs.csv", RunsCsv(folder.result));
  std::string summary = StudySummaryText(folder.result, folder.study.metrics) + "\n";
  std::set<std::string> said;
  for (const StudyTable& table : tables) {
    if (!table.verdict.empty() && said.insert(table.verdict).second) {
      summary += table.verdict + "\n";
    }
  }
  texts.emplace_back("summary.txt", summary);
  if (IsTuningFolder(folder.path)) {
    for (auto& text : TuningTexts(folder)) texts.push_back(std::move(text));
  }
  return texts;
}

void WriteStudyProducts(const fs::path& folder, bool quick, const std::string& command_line,
                        const StudyFinish& finish) {
  const StudyFolder study = ReadStudyFolder(folder);
  for (const auto& [name, text] : StudyTexts(study)) {
    MakeFolder((folder / name).parent_path());
    ReplaceTextFile(folder / name, text);
  }

  if (finish) finish(study);
  Manifest manifest = StartManifest(command_line);
  int failed = 0;
  for (const StudyRun& run : study.result.runs) failed += run.failed ? 1 : 0;
  manifest["study"] = study.result.name;
  manifest["quick"] = quick;
  manifest["outcome"] = {
      {"status", "done"}, {"runs", study.result.runs.size()}, {"failed", failed}};
  WriteManifest(manifest, folder);
}

}  // namespace duet
