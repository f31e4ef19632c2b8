#include "common/support/logging.h"
#include "experiments/record_reader.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const duet::ManifestReader manifest(text, "f");
    // A manifest of `duet track` is none of `duet run`, and the other way round: each is tried.
    try {
      CHECK_GE(duet::ReadTrackManifest(manifest).frames, 0);
    } catch (const duet::InputError&) {
    }
    CHECK_GE(duet::ReadRunManifest(manifest, 0).run.frames, 0);
  });
}
