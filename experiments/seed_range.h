#pragma once

#include <string>

namespace duet {

/// Seeds first to last, both included.
struct SeedRange {
  int first = 0;
  int last = 0;
};

/// "A..B" of --seeds, or of what `key` names. Throws InputError.
[[nodiscard]] SeedRange ParseSeeds(const std::string& text, const std::string& file = "",
                                   int line = 0, const std::string& key = "--seeds");

}  // namespace duet
