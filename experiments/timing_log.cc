#include "experiments/timing_log.h"

#include <algorithm>
#include <string_view>

#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

constexpr std::string_view kUnit = " [ms]";

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

std::vector<std::pair<std::string, std::vector<double>>> ReadTimingTable(std::string_view csv,
                                                                         const std::string& file) {
  const std::vector<std::string> names = ReadColumnNames(csv, file);
  std::vector<std::pair<std::string, std::vector<double>>> columns;
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (!names[i].ends_with(kUnit)) throw InputError(file, 1, names[i], "expected a column in ms");
    columns.emplace_back(names[i].substr(0, names[i].size() - kUnit.size()), std::vector<double>());
  }
  CsvReader reader(csv, file, {names});
  while (reader.Next()) {
    reader.CheckLater(0, reader.Stamp(0));
    for (int i = 1; i < reader.column_count(); ++i) {
      if (!reader.Text(i).empty()) columns[i - 1].second.push_back(reader.Number(i));
    }
  }
  return columns;
}

}  // namespace duet
