#include <algorithm>

#include "common/support/logging.h"
#include "evaluation/published.h"
#include "test/fuzz/fuzz_reader.h"

// A table of numbers, or of sequences: each is tried.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    try {
      const duet::PublishedNumbers numbers = duet::ParsePublishedNumbers(text, "f");
      CHECK(!numbers.rows.empty() && numbers.rows.size() < lines);
      CHECK(!numbers.name.empty() && !numbers.source.empty());
    } catch (const duet::InputError&) {
    }
    const duet::PublishedSequences sequences = duet::ParsePublishedSequences(text, "f");
    CHECK(!sequences.rows.empty() && sequences.rows.size() < lines);
  });
}
