#include "experiments/seed_range.h"

#include <cstdio>

#include "common/support/input_error.h"

namespace duet {
namespace {

// Two numbers of eight digits, which is more than anyone runs and less than an int holds.
constexpr std::size_t kLongest = 18;

}  // namespace

SeedRange ParseSeeds(const std::string& text, const std::string& file, int line,
                     const std::string& key) {
  const std::size_t dots = text.find("..");
  SeedRange range;
  char end = 0;
  if (dots == std::string::npos ||
      std::sscanf(text.c_str(), "%d..%d%c", &range.first, &range.last, &end) != 2 ||
      text.size() > kLongest || range.first < 0 || range.last < range.first) {
    throw InputError(file, line, key,
                     "expected A..B with 0 <= A <= B of at most eight digits, got '" + text + "'");
  }
  return range;
}

}  // namespace duet
