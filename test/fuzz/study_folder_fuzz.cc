#include "common/support/logging.h"
#include "experiments/study/study_products.h"
#include "experiments/study/study_records.h"
#include "experiments/study/tuning_result.h"
#include "test/fuzz/fuzz_reader.h"

namespace {

/// A record's metrics: of the runs in turn the defaults' better and worse, and none.
void FillIn(duet::StudyResult* result, const std::string& objective) {
  int number = 0;
  for (duet::StudyRun& run : result->runs) {
    run.failed = number % 5 == 4;
    if (number % 3 != 2) run.metrics = {{objective, 0.1 * (number % 7)}, {"coverage_share", 1.0}};
    ++number;
  }
}

}  // namespace

// study.yaml, plan.csv and tuning.yaml of one folder, which may contradict each other.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    duet::StudyFolder folder;
    folder.study = duet::ParseStudyFile(duet::TakeFirstPart(&text), "/no folder/f", false);
    folder.result.name = folder.study.name;
    folder.result.runs = duet::ParsePlan(duet::TakeFirstPart(&text), "p");
    CHECK(!folder.result.runs.empty());
    const duet::TuningReport report = duet::ParseTuningYaml(text, "/no folder/t");
    FillIn(&folder.result, report.objective);
    for (const auto& [name, made] : duet::TuningTexts(folder, report)) CHECK(!made.empty()) << name;
    CHECK(!duet::RunsCsv(folder.result).empty());
    CHECK(!duet::StudySummaryTable(folder.result, folder.study.metrics, {}).rows.empty());
  });
}
