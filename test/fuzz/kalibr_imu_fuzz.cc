#include "common/dataset/kalibr.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size,
                          [](std::string_view text) { (void)duet::ReadKalibrImu(text, "f"); });
}
