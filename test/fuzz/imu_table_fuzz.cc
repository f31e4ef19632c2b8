#include "common/dataset/asl_tables.h"
#include "common/support/logging.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const std::vector<duet::ImuSample> samples = duet::ReadImuTable(text, "f");
    const std::vector<duet::ImuSample> again =
        duet::ReadImuTable(duet::WriteImuTable(samples), "g");
    CHECK_EQ(again.size(), samples.size());
    CHECK(again.back().a_m == samples.back().a_m);
  });
}
