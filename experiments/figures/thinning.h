#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace duet {

/// Most rows of a curve in a figure: a column's width holds no more.
inline constexpr std::size_t kMostRows = 500;

/// Which rows of equally long columns to draw, ascending: all where there are at most `most_rows`;
/// else the first and the last, and of each of so many stretches of equal length the rows with the
/// smallest and the largest number of each column, so that no extreme is lost. A row that is not
/// finite (a gap in a curve) stands for its stretch's gap and is kept. About `most_rows` rows.
[[nodiscard]] std::vector<std::size_t> ThinnedRows(
    const std::vector<std::span<const double>>& columns, std::size_t most_rows = kMostRows);

[[nodiscard]] std::vector<double> RowsOf(std::span<const double> column,
                                         const std::vector<std::size_t>& rows);

}  // namespace duet
