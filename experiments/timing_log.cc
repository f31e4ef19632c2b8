#include "experiments/timing_log.h"

#include <algorithm>
#include <string_view>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

constexpr std::string_view kUnit = " [ms]";

std::vector<std::string_view> Split(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = line.find(',', begin);
    fields.push_back(line.substr(begin, comma - begin));
    if (comma == std::string_view::npos) return fields;
    begin = comma + 1;
  }
}

}  // namespace

void TimingLog::StartFrame(Timestamp timestamp) { rows_.push_back({timestamp, {}}); }

void TimingLog::Add(const std::string& column, double cpu_ms) {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  const auto index = static_cast<std::size_t>(found - columns_.begin());
  if (found == columns_.end()) columns_.push_back(column);
  Row& row = rows_.back();
  if (row.cpu_ms.size() <= index) row.cpu_ms.resize(index + 1);
  row.cpu_ms[index] = row.cpu_ms[index].value_or(0.0) + cpu_ms;
}

void TimingLog::Add(const std::string& prefix, const std::vector<StageTimer::Stage>& stages) {
  for (const StageTimer::Stage& stage : stages) Add(prefix + "." + stage.name, stage.cpu_ms);
}

void TimingLog::Write(const std::filesystem::path& path) const {
  std::string text = "#timestamp [ns]";
  for (const std::string& column : columns_) text += "," + column + std::string(kUnit);
  text += "\n";
  for (const Row& row : rows_) {
    AppendNumber(row.timestamp, &text);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      text += ',';
      if (i < row.cpu_ms.size() && row.cpu_ms[i]) text += FormatFixed(*row.cpu_ms[i], 4);
    }
    text += "\n";
  }
  WriteTextFile(path, text);
}

std::vector<std::pair<std::string, std::vector<double>>> ReadTiming(
    const std::filesystem::path& path) {
  const std::string text = ReadTextFile(path);
  std::vector<std::pair<std::string, std::vector<double>>> columns;
  int line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::vector<std::string_view> fields =
        Split(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    if (++line_number == 1) {
      for (std::size_t i = 1; i < fields.size(); ++i) {
        columns.emplace_back(fields[i].substr(0, fields[i].rfind(kUnit)), std::vector<double>());
      }
      continue;
    }
    if (fields.size() != columns.size() + 1) {
      throw InputError(path.string(), line_number, "",
                       "expected " + std::to_string(columns.size() + 1) + " fields");
    }
    for (std::size_t i = 1; i < fields.size(); ++i) {
      if (fields[i].empty()) continue;
      const std::optional<double> value = ParseDouble(fields[i]);
      if (!value) {
        throw InputError(path.string(), line_number, columns[i - 1].first, "expected a number");
      }
      columns[i - 1].second.push_back(*value);
    }
  }
  return columns;
}

}  // namespace duet
