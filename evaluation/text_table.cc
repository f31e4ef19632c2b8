#include "evaluation/text_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/support/logging.h"
#include "common/support/numeric_text.h"

namespace duet {

std::string Number(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  std::string text = FormatFixed(value, decimals);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  if (zero && text.front() == '-') text.erase(0, 1);
  return text;
}

TextTable::TextTable(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

void TextTable::AddRow(std::vector<std::string> cells) {
  CHECK_EQ(cells.size(), rows_.front().size());
  rows_.push_back(std::move(cells));
}

void TextTable::AddSection(std::string title) { rows_.push_back({std::move(title)}); }

std::string TextTable::Text() const {
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> width(columns, 0);
  for (const auto& row : rows_) {
    if (row.size() < columns) continue;
    for (std::size_t c = 0; c < columns; ++c) width[c] = std::max(width[c], row[c].size());
  }
  std::string text;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const auto& row = rows_[r];
    if (row.size() < columns) {
      text += row.front() + "\n";
      continue;
    }
    text += row.front();
    std::size_t blanks = width[0] - row.front().size();
    for (std::size_t c = 1; c < columns; ++c) {
      blanks += 2 + width[c] - row[c].size();
      if (row[c].empty()) continue;
      text += std::string(blanks, ' ') + row[c];
      blanks = 0;
    }
    text += "\n";
    if (r > 0) continue;
    std::size_t total = width[0];
    for (std::size_t c = 1; c < columns; ++c) total += 2 + width[c];
    text += std::string(total, '-') + "\n";
  }
  return text;
}

}  // namespace duet
