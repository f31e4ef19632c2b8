#include "common/support/logging.h"
#include "experiments/study/run_evaluation.h"
#include "experiments/study/study_plan.h"
#include "experiments/study/study_products.h"
#include "experiments/study/study_run.h"
#include "experiments/study/study_stream.h"
#include "test/fuzz/fuzz_reader.h"

namespace {

template <class Read>
void Try(const Read& read) {
  try {
    read();
  } catch (const duet::InputError&) {
  }
}

}  // namespace

// evaluation.json and study.json of a record, stream.json, recordings.json and the products in
// manifest.json of a study: every text is given to each of their readers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    Try([&] { (void)duet::ParseEvaluation(text, "f"); });
    Try([&] { (void)duet::ParseRecordInfo(text, "f"); });
    Try([&] { (void)duet::ParseStreamInfo(text, "f"); });
    Try([&] {
      for (const auto& [key, recording] : duet::ParseRecordings(text, "f")) {
        CHECK_GE(recording.frames, 0) << key;
      }
    });
    Try([&] {
      for (const auto& [name, hash] : duet::ParseProducts(text, "f")) {
        CHECK(name.find("..") != 0 && name.front() != '/') << name;
      }
    });
  });
}
