#include "experiments/figures/thinning.h"

#include <algorithm>
#include <cmath>

namespace duet {

std::vector<std::size_t> ThinnedRows(const std::vector<std::span<const double>>& columns,
                                     std::size_t most_rows) {
  std::vector<std::size_t> rows;
  const std::size_t count = columns.empty() ? 0 : columns.front().size();
  if (count <= most_rows) {
    for (std::size_t i = 0; i < count; ++i) rows.push_back(i);
    return rows;
  }
  const std::size_t stretches = std::max<std::size_t>(1, most_rows / (2 * columns.size()));
  rows = {0, count - 1};
  for (std::size_t k = 0; k < stretches; ++k) {
    const std::size_t begin = count * k / stretches;
    const std::size_t end = count * (k + 1) / stretches;
    for (const std::span<const double> column : columns) {
      std::size_t lowest = end;
      std::size_t highest = end;
      std::size_t gap = end;
      for (std::size_t i = begin; i < end; ++i) {
        if (!std::isfinite(column[i])) {
          if (gap == end) gap = i;
          continue;
        }
        if (lowest == end || column[i] < column[lowest]) lowest = i;
        if (highest == end || column[i] > column[highest]) highest = i;
      }
      for (const std::size_t row : {lowest, highest, gap}) {
        if (row != end) rows.push_back(row);
      }
    }
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

std::vector<double> RowsOf(std::span<const double> column, const std::vector<std::size_t>& rows) {
  std::vector<double> chosen;
  chosen.reserve(rows.size());
  for (const std::size_t row : rows) chosen.push_back(column[row]);
  return chosen;
}

}  // namespace duet
