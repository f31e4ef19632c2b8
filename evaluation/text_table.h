#pragma once

#include <string>
#include <vector>

namespace duet {

/// `value` with that many digits after the point, the same on every machine; "-" where it is not
/// finite; never "-0.00".
[[nodiscard]] std::string Number(double value, int decimals);

/// A table for a terminal: the first column left-aligned, the others right-aligned, two blanks
/// between them. Cells are ASCII.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header);
  /// As many cells as the header has.
  void AddRow(std::vector<std::string> cells);
  /// A line that stands over the rows after it.
  void AddSection(std::string title);
  [[nodiscard]] std::string Text() const;

 private:
  std::vector<std::vector<std::string>> rows_;  // a section is a row of one cell
};

}  // namespace duet
