#pragma once

#include <algorithm>
#include <vector>

namespace duet {

/// The index, from `first` on, at which `error` of the ascending `values` is smallest, the first of
/// equals: what an exhaustive search for the strictly smaller would find, where `error` falls up to
/// `target` and rises after it. -1 where there is none from `first` on.
template <class Error>
[[nodiscard]] int NearestIndex(const std::vector<double>& values, int first, double target,
                               const Error& error) {
  const int size = static_cast<int>(values.size());
  if (first >= size) return -1;
  const auto after = std::lower_bound(values.begin() + first, values.end(), target);
  int best = std::min(static_cast<int>(after - values.begin()), size - 1);
  while (best > first && error(values[best - 1]) <= error(values[best])) --best;
  return best;
}

}  // namespace duet
