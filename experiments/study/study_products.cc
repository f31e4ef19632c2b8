#include "experiments/study/study_products.h"

#include "common/support/text_file.h"
#include "experiments/manifest.h"
#include "experiments/study/record_version.h"
#include "experiments/study/tuning_result.h"

namespace duet {

namespace fs = std::filesystem;

std::vector<std::pair<std::string, std::string>> StudyTexts(const StudyFolder& folder) {
  std::vector<std::pair<std::string, std::string>> texts = {
      {"runs.csv", RunsCsv(folder.result)},
      {"summary.txt", StudySummaryText(folder.result, folder.study.metrics)}};
  if (IsTuningFolder(folder.path)) {
    for (auto& text : TuningTexts(folder)) texts.push_back(std::move(text));
  }
  return texts;
}

void WriteStudyProducts(const fs::path& folder, bool quick, const std::string& command_line) {
  const StudyFolder study = ReadStudyFolder(folder);
  for (const auto& [name, text] : StudyTexts(study)) {
    MakeFolder((folder / name).parent_path());
    ReplaceTextFile(folder / name, text);
  }

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
