#include "experiments/seed_range.h"

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

#include "common/support/input_error.h"

namespace duet {
namespace {

constexpr int kLargest = 99'999'999;

/// Digits alone; nothing where they are more than an int holds.
std::optional<int> SeedOf(std::string_view digits) {
  int seed = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seed);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  if (seed < 0 || seed > kLargest) return std::nullopt;
  return seed;
}

}  // namespace

SeedRange ParseSeeds(const std::string& text, const std::string& file, int line,
                     const std::string& key) {
  const std::size_t dots = text.find("..");
  std::optional<int> first;
  std::optional<int> last;
  if (dots != std::string::npos) {
    first = SeedOf(std::string_view(text).substr(0, dots));
    last = SeedOf(std::string_view(text).substr(dots + 2));
  }
  if (!first || !last || *last < *first) {
    throw InputError(file, line, key,
                     "expected A..B with 0 <= A <= B of at most eight digits, got '" + text + "'");
  }
  return {*first, *last};
}

}  // namespace duet
