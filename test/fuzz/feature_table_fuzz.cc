#include "common/support/logging.h"
#include "experiments/record_tables.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const double mean = duet::ReadFeatureMean(text, "f", "used");
    CHECK(!(mean < 0.0));
  });
}
