#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    if (const std::optional<duet::Timestamp> t = duet::ParseSeconds(text)) {
      CHECK(duet::ParseSeconds(duet::FormatSeconds(*t)) == t);
    }
    if (const std::optional<double> value = duet::ParseDouble(text)) {
      CHECK(*value != *value || duet::ParseDouble(duet::FormatNumber(*value)) == value);
    }
    (void)duet::ParseFloat(text);
    (void)duet::ParseInt64(text);
    (void)duet::ParseUint64(text);
  });
}
