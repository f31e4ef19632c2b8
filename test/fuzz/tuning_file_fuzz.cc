#include "common/support/logging.h"
#include "experiments/study/tuning_file.h"
#include "experiments/study/tuning_result.h"
#include "test/fuzz/fuzz_reader.h"

// Every estimator has as many trials as the budget says, and what the search's folder keeps of the
// report reads back.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    for (const bool quick : {true, false}) {
      duet::TuningFile tuning;
      try {
        tuning = duet::ParseTuningFile(text, "/no folder/f", quick);
      } catch (const duet::InputError&) {
        continue;
      }
      CHECK_EQ(static_cast<int>(tuning.study.settings.size()), tuning.budget);
      try {
        const duet::TuningReport report =
            duet::ParseTuningYaml(duet::TuningYaml(tuning), "/no folder/g");
        CHECK_EQ(report.objective, tuning.objective);
        CHECK_EQ(report.seeds.last, tuning.report_seeds.last);
        CHECK_EQ(duet::StreamsYaml(report.streams), duet::StreamsYaml(tuning.report_streams));
      } catch (const duet::InputError& error) {
        LOG(FATAL) << error.what();
      }
    }
  });
}
