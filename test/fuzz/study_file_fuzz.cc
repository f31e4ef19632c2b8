#include "common/support/logging.h"
#include "experiments/study/study_file.h"
#include "test/fuzz/fuzz_reader.h"

// What a study's folder keeps of a study says the same as its file. The folder of the file is not
// there, so that no path in it leads anywhere.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    for (const bool quick : {true, false}) {
      duet::StudyFile study;
      try {
        study = duet::ParseStudyFile(text, "/no folder/f", quick);
      } catch (const duet::InputError&) {
        continue;
      }
      const std::string yaml = duet::StudyYaml(study);
      try {
        CHECK_EQ(duet::StudyYaml(duet::ParseStudyFile(yaml, "/no folder/g", false)), yaml);
      } catch (const duet::InputError& error) {
        LOG(FATAL) << error.what() << "\n" << yaml;
      }
    }
  });
}
