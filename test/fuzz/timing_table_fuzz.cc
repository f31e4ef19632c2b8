#include <algorithm>

#include "common/support/logging.h"
#include "experiments/timing_log.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const auto lines = std::count(text.begin(), text.end(), '\n');
    for (const auto& [name, values] : duet::ReadTimingTable(text, "f")) {
      CHECK_LT(static_cast<std::ptrdiff_t>(values.size()), lines);
    }
  });
}
