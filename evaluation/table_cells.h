#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/study_table.h"

namespace duet {

/// What the renderers of a StudyTable share.

/// "0.0123 [0.0110, 0.0140]", the cell's text where it has one, "-" where there is no number.
[[nodiscard]] std::string CellText(const TableCell& cell);

/// "median [m]"
[[nodiscard]] std::string ColumnTitle(const TableColumn& column);

/// The title in lines that make the column no wider than its cells where that is possible: broken
/// between words.
[[nodiscard]] std::vector<std::string> TitleLines(const StudyTable& table, std::size_t column);
/// The most lines that a title has.
[[nodiscard]] std::size_t TitleHeight(const StudyTable& table);

/// Characters of UTF-8 text.
[[nodiscard]] std::size_t TextWidth(std::string_view text);

/// Columns begin ... end - 1 that stand under one title.
struct ColumnGroup {
  std::string title;
  std::size_t begin = 0;
  std::size_t end = 0;
};
[[nodiscard]] std::vector<ColumnGroup> ColumnGroups(const StudyTable& table);

}  // namespace duet
