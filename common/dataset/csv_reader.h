#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/support/timestamp.h"

namespace duet {

/// A strict reader of tables in text, row by row. Lines end in LF or CRLF, the last one too (a file
/// that does not end so is taken for truncated); lines that begin with '#', and empty ones, are
/// skipped; so is a first line that does not begin like a number (column names without '#').
/// Blanks around a field do not count. Every error is an InputError that names file, line, column
/// and what was expected.
class CsvReader {
 public:
  /// `shapes`: the column names of each shape that the table may have; shapes differ in their
  /// number of columns, and the first row decides which it is. No shapes: any number of columns,
  /// named "column 1", ...; the first row decides. `separator` ' ' stands for any number of blanks.
  /// `text` must outlive the reader. Throws where the text is empty, no text or truncated.
  CsvReader(std::string_view text, std::string file, std::vector<std::vector<std::string>> shapes,
            char separator = ',');

  /// Goes to the next row; false after the last. Throws for a row of another number of columns.
  [[nodiscard]] bool Next();

  /// Fields of the current row, by column.
  [[nodiscard]] std::string_view Text(int column) const;
  [[nodiscard]] double Number(int column) const;  ///< finite
  [[nodiscard]] float Single(int column) const;   ///< finite, rounded once
  [[nodiscard]] std::uint64_t Unsigned(int column) const;
  [[nodiscard]] Timestamp Stamp(int column) const;           ///< integer nanoseconds
  [[nodiscard]] Timestamp StampInSeconds(int column) const;  ///< decimal seconds, read exactly

  /// Refuses a stamp that is not later than that of the row before (the last one given here).
  Timestamp CheckLater(int column, Timestamp stamp);

  /// Throws InputError unless there was at least one row.
  void RequireRows() const;

  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] int column_count() const { return static_cast<int>(columns_.size()); }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[noreturn]] void Fail(int column, const std::string& text) const;

 private:
  void Split(std::string_view row);
  void ChooseShape();
  [[nodiscard]] bool IsHeader(std::string_view row) const;
  [[noreturn]] void FailValue(int column, const std::string& expected) const;

  std::string_view rest_;
  std::string file_;
  std::vector<std::vector<std::string>> shapes_;
  std::vector<std::string> columns_;  ///< of the shape, empty before the first row
  char separator_;
  int line_ = 0;
  std::vector<std::string_view> fields_;
  bool has_stamp_ = false;
  Timestamp last_stamp_ = 0;
};

/// The column names of a table whose first line gives them after a '#'. Throws InputError where it
/// does not.
[[nodiscard]] std::vector<std::string> ReadColumnNames(std::string_view text,
                                                       const std::string& file);

/// Three numbers, the first one in `column`.
[[nodiscard]] Eigen::Vector3d ReadVector(const CsvReader& reader, int column);

/// The quaternion whose first number stands in `column`, normalized, its sign kept; `w_first`:
/// w x y z, else x y z w. Throws InputError where its length is off 1 by more than a thousandth.
[[nodiscard]] Eigen::Quaterniond ReadQuaternion(const CsvReader& reader, int column, bool w_first);

/// Stamps that files may hold: from 0 to this many nanoseconds (the year 2096), so that no
/// difference of two leaves 64 bits.
inline constexpr Timestamp kLatestStamp = 4'000'000'000'000'000'000;

}  // namespace duet
