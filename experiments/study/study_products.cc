#include "experiments/study/study_products.h"

#include <cstdio>

#include "common/support/text_file.h"
#include "experiments/manifest.h"
#include "experiments/study/study_records.h"

namespace duet {

void WriteStudyProducts(const StudyFile& study, const StudyChoices& choices) {
  const StudyFolder folder = ReadStudyFolder(choices.out);
  const StudyResult& result = folder.result;
  ReplaceTextFile(choices.out / "runs.csv", RunsCsv(result));
  const std::string summary = StudySummaryText(result, study.metrics);
  ReplaceTextFile(choices.out / "summary.txt", summary);
  std::fputs(summary.c_str(), stdout);

  Manifest manifest = StartManifest(choices.command_line);
  int failed = 0;
  for (const StudyRun& run : result.runs) failed += run.failed ? 1 : 0;
  manifest["study"] = study.name;
  manifest["quick"] = choices.quick;
  manifest["outcome"] = {{"status", "done"}, {"runs", result.runs.size()}, {"failed", failed}};
  WriteManifest(manifest, choices.out);
}

}  // namespace duet
