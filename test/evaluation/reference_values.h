#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/csv_reader.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"

namespace duet::test {

/// Rows of a file in test/evaluation/data, field by field; its comments say where the values come
/// from.
inline std::vector<std::vector<std::string>> ReferenceRows(const std::string& file) {
  const std::string text =
      ReadTextFile(std::string(DUET_SOURCE_DIR) + "/test/evaluation/data/" + file);
  CsvReader reader(text, file, {});
  std::vector<std::vector<std::string>> rows;
  while (reader.Next()) {
    rows.emplace_back();
    for (int c = 0; c < reader.column_count(); ++c) rows.back().emplace_back(reader.Text(c));
  }
  EXPECT_GT(rows.size(), 0u) << file;
  return rows;
}

inline double ReferenceNumber(const std::string& text) { return ParseDouble(text).value(); }

/// Numbers with blanks between them.
inline std::vector<double> ReferenceNumbers(std::string_view text) {
  std::vector<double> numbers;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    numbers.push_back(ParseDouble(text.substr(0, end)).value());
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

}  // namespace duet::test
