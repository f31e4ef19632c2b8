#include "experiments/seed_range.h"

#include <cstdio>

#include "common/support/input_error.h"

namespace duet {

SeedRange ParseSeeds(const std::string& text) {
  const std::size_t dots = text.find("..");
  SeedRange range;
  char end = 0;
  if (dots == std::string::npos ||
      std::sscanf(text.c_str(), "%d..%d%c", &range.first, &range.last, &end) != 2 ||
      range.first < 0 || range.last < range.first) {
    throw InputError("", 0, "--seeds", "expected A..B with 0 <= A <= B, got '" + text + "'");
  }
  return range;
}

}  // namespace duet
