#include "experiments/study/study_products.h"

#include <cstdio>

#include "common/support/text_file.h"
#include "experiments/manifest.h"
#include "experiments/study/record_version.h"

namespace duet {

namespace fs = std::filesystem;

std::vector<std::pair<std::string, std::string>> StudyTexts(const StudyFolder& folder) {
  return {{"runs.csv", RunsCsv(folder.result)},
          {"summary.txt", StudySummaryText(folder.result, folder.study.metrics)}};
}

void WriteStudyProducts(const fs::path& folder, bool quick, const std::string& command_line) {
  const StudyFolder study = ReadStudyFolder(folder);
  for (const auto& [name, text] : StudyTexts(study)) {
    MakeFolder((folder / name).parent_path());
    ReplaceTextFile(folder / name, text);
  }
  std::fputs(ReadTextFile(folder / "summary.txt").c_str(), stdout);

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
