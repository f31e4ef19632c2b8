#include "common/dataset/csv_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

std::string_view Trim(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

std::string Shorten(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  if (text.size() <= kLongest) return std::string(text);
  return std::string(text.substr(0, kLongest)) + "...";
}

}  // namespace

CsvReader::CsvReader(std::string_view text, std::string file,
                     std::vector<std::vector<std::string>> shapes, char separator)
    : rest_(text), file_(std::move(file)), shapes_(std::move(shapes)), separator_(separator) {
  if (text.empty()) throw InputError(file_, 0, "", "is empty");
  if (text.find('\0') != std::string_view::npos) {
    throw InputError(file_, 0, "", "is no text: it contains a zero byte");
  }
  if (text.back() != '\n') {
    throw InputError(file_, static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 1, "",
                     "is truncated: the last line has no end");
  }
}

bool CsvReader::Next() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find('\n');
    std::string_view row = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    ++line_;
    if (row.ends_with('\r')) row.remove_suffix(1);
    row = Trim(row);
    if (row.empty() || row.front() == '#' || IsHeader(row)) continue;
    Split(row);
    if (columns_.empty()) ChooseShape();
    if (fields_.size() != columns_.size()) {
      throw InputError(file_, line_, "",
                       "expected " + std::to_string(columns_.size()) + " columns, got " +
                           std::to_string(fields_.size()) +
                           (rest_.empty() ? "; is the file truncated?" : ""));
    }
    return true;
  }
  return false;
}

bool CsvReader::IsHeader(std::string_view row) const {
  if (line_ != 1) return false;
  const char first = row.front();
  return (first < '0' || first > '9') && first != '-' && first != '+' && first != '.';
}

void CsvReader::Split(std::string_view row) {
  fields_.clear();
  while (true) {
    const std::size_t end =
        separator_ == ' '
            ? static_cast<std::size_t>(std::find_if(row.begin(), row.end(), IsBlank) - row.begin())
            : std::min(row.find(separator_), row.size());
    fields_.push_back(Trim(row.substr(0, end)));
    if (end == row.size()) return;
    row.remove_prefix(end + 1);
    if (separator_ == ' ') row = Trim(row);
  }
}

void CsvReader::ChooseShape() {
  if (shapes_.empty()) {
    for (std::size_t i = 1; i <= fields_.size(); ++i) {
      columns_.push_back("column " + std::to_string(i));
    }
    return;
  }
  std::string counts;
  for (const std::vector<std::string>& shape : shapes_) {
    if (shape.size() == fields_.size()) {
      columns_ = shape;
      return;
    }
    counts += (counts.empty() ? "" : " or ") + std::to_string(shape.size());
  }
  throw InputError(file_, line_, "",
                   "expected " + counts + " columns, got " + std::to_string(fields_.size()));
}

std::string_view CsvReader::Text(int column) const {
  return fields_.at(static_cast<std::size_t>(column));
}

double CsvReader::Number(int column) const {
  const std::optional<double> value = ParseDouble(Text(column));
  if (!value || !std::isfinite(*value)) FailValue(column, "a finite number");
  return *value;
}

float CsvReader::Single(int column) const {
  const std::optional<float> value = ParseFloat(Text(column));
  if (!value || !std::isfinite(*value)) FailValue(column, "a finite number");
  return *value;
}

std::uint64_t CsvReader::Unsigned(int column) const {
  const std::optional<std::uint64_t> value = ParseUint64(Text(column));
  if (!value) FailValue(column, "an integer of at least 0");
  return *value;
}

Timestamp CsvReader::Stamp(int column) const {
  const std::optional<std::int64_t> value = ParseInt64(Text(column));
  if (!value || *value < 0 || *value > kLatestStamp) {
    FailValue(column, "an integer stamp in nanoseconds");
  }
  return *value;
}

Timestamp CsvReader::StampInSeconds(int column) const {
  const std::optional<Timestamp> value = ParseSeconds(Text(column));
  if (!value || *value < 0 || *value > kLatestStamp) FailValue(column, "a stamp in seconds");
  return *value;
}

Timestamp CsvReader::CheckLater(int column, Timestamp stamp) {
  if (has_stamp_ && stamp == last_stamp_) {
    Fail(column,
         "the stamp " + std::string(Text(column)) + " stands twice; expected stamps that increase");
  }
  if (has_stamp_ && stamp < last_stamp_) {
    Fail(column, "time goes backwards by " + FormatDuration(last_stamp_ - stamp) +
                     " s; expected stamps that increase");
  }
  has_stamp_ = true;
  last_stamp_ = stamp;
  return stamp;
}

void CsvReader::RequireRows() const {
  if (columns_.empty()) throw InputError(file_, 0, "", "has no rows");
}

void CsvReader::Fail(int column, const std::string& text) const {
  throw InputError(file_, line_, columns_.at(static_cast<std::size_t>(column)), text);
}

void CsvReader::FailValue(int column, const std::string& expected) const {
  Fail(column, "expected " + expected + ", got '" + Shorten(Text(column)) + "'");
}

std::vector<std::string> ReadColumnNames(std::string_view text, const std::string& file) {
  std::string_view line = text.substr(0, text.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.empty() || line.front() != '#') {
    throw InputError(file, 1, "", "expected the names of the columns after a '#'");
  }
  std::vector<std::string> names;
  for (std::size_t begin = 1;;) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    names.emplace_back(Trim(line.substr(begin, end - begin)));
    if (end == line.size()) return names;
    begin = end + 1;
  }
}

Eigen::Vector3d ReadVector(const CsvReader& reader, int column) {
  return {reader.Number(column), reader.Number(column + 1), reader.Number(column + 2)};
}

Eigen::Quaterniond ReadQuaternion(const CsvReader& reader, int column, bool w_first) {
  const Eigen::Vector4d q(reader.Number(column), reader.Number(column + 1),
                          reader.Number(column + 2), reader.Number(column + 3));
  const double length = q.norm();
  // Files are rounded: EuRoC's to 1e-6. Beyond a thousandth it is no rotation.
  if (!(std::abs(length - 1.0) <= 1e-3)) {
    reader.Fail(column, "is no rotation: expected a quaternion of length 1, got length " +
                            FormatNumber(length));
  }
  const Eigen::Vector4d unit = q / length;
  return w_first ? Eigen::Quaterniond(unit[0], unit[1], unit[2], unit[3])
                 : Eigen::Quaterniond(unit[3], unit[0], unit[1], unit[2]);
}

}  // namespace duet
