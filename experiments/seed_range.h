#pragma once

#include <string>

namespace duet {

/// Seeds first to last, both included.
struct SeedRange {
  int first = 0;
  int last = 0;
};

/// "A..B" of --seeds. Throws InputError.
[[nodiscard]] SeedRange ParseSeeds(const std::string& text);

}  // namespace duet
