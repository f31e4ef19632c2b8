#include "common/support/nearest_name.h"

#include <algorithm>
#include <cctype>

namespace duet {
namespace {

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Optimal string alignment distance.
std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

bool IsFirstWordsOf(const std::string& name, const std::string& candidate) {
  return candidate.size() > name.size() && candidate.compare(0, name.size(), name) == 0 &&
         (candidate[name.size()] == '_' || candidate[name.size()] == '-');
}

}  // namespace

std::string NearestName(std::string_view name, const std::vector<std::string>& candidates) {
  // Nothing that long is a misspelling, and the distance costs the product of the lengths.
  constexpr std::size_t kLongest = 200;
  if (name.empty() || name.size() > kLongest) return "";
  const std::string lower = Lower(name);
  const std::size_t limit = std::max<std::size_t>(2, name.size() / 3);
  std::string best;
  for (const std::string& candidate : candidates) {
    const bool shorter = best.empty() || candidate.size() < best.size();
    if (shorter && IsFirstWordsOf(lower, Lower(candidate))) best = candidate;
  }
  if (!best.empty()) return best;
  std::size_t best_distance = limit + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t at_least = candidate.size() > name.size() ? candidate.size() - name.size()
                                                                : name.size() - candidate.size();
    if (at_least >= best_distance) continue;
    const std::size_t distance = EditDistance(lower, Lower(candidate));
    if (distance < best_distance && distance < candidate.size()) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string DidYouMean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string nearest = NearestName(name, candidates);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

}  // namespace duet
