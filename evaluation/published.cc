#include "evaluation/published.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

constexpr const char* kNumbersHeader = "#sequence,position_rmse_m,orientation_rmse_deg";
constexpr const char* kSequencesHeader =
    "#sequence,length_m,duration_s,speed_m_per_s,rate_rad_per_s,remark";

bool HasLine(std::string_view text, std::string_view line) {
  return text.starts_with(std::string(line) + "\n") ||
         text.find("\n" + std::string(line) + "\n") != std::string_view::npos;
}

/// "# KEY: VALUE" of the head; empty where it is not there and need not be.
std::string HeadLine(std::string_view text, const std::string& key, const std::string& file,
                     bool required = true) {
  const std::string beginning = "# " + key + ": ";
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.starts_with(beginning) && line.size() > beginning.size()) {
      return std::string(line.substr(beginning.size()));
    }
    at = end + 1;
  }
  if (!required) return "";
  throw InputError(file, 0, key, "expected a line \"" + beginning + "...\"");
}

double NumberOrNaN(const CsvReader& reader, int column) {
  return reader.Text(column).empty() ? std::numeric_limits<double>::quiet_NaN()
                                     : reader.Number(column);
}

void CheckNew(const CsvReader& reader, std::set<std::string>* seen) {
  const std::string sequence(reader.Text(0));
  if (sequence.empty()) reader.Fail(0, "expected the name of a sequence");
  if (!seen->insert(sequence).second) reader.Fail(0, "\"" + sequence + "\" stands here twice");
}

}  // namespace

PublishedNumbers ParsePublishedNumbers(std::string_view text, const std::string& file) {
  if (!HasLine(text, kNumbersHeader)) {
    throw InputError(file, 0, "", std::string("expected the line \"") + kNumbersHeader + "\"");
  }
  PublishedNumbers numbers;
  numbers.name = HeadLine(text, "name", file);
  numbers.source = HeadLine(text, "source", file);
  numbers.alignment = HeadLine(text, "alignment", file);
  numbers.covers = HeadLine(text, "covers", file);
  numbers.note = HeadLine(text, "note", file, false);
  CsvReader reader(text, file, {{"sequence", "position_rmse_m", "orientation_rmse_deg"}});
  std::set<std::string> seen;
  while (reader.Next()) {
    CheckNew(reader, &seen);
    numbers.rows.push_back(
        {std::string(reader.Text(0)), NumberOrNaN(reader, 1), NumberOrNaN(reader, 2)});
  }
  reader.RequireRows();
  return numbers;
}

PublishedSequences ParsePublishedSequences(std::string_view text, const std::string& file) {
  if (!HasLine(text, kSequencesHeader)) {
    throw InputError(file, 0, "", std::string("expected the line \"") + kSequencesHeader + "\"");
  }
  PublishedSequences sequences;
  sequences.name = HeadLine(text, "name", file);
  sequences.source = HeadLine(text, "source", file);
  CsvReader reader(
      text, file,
      {{"sequence", "length_m", "duration_s", "speed_m_per_s", "rate_rad_per_s", "remark"}});
  std::set<std::string> seen;
  while (reader.Next()) {
    CheckNew(reader, &seen);
    sequences.rows.push_back({std::string(reader.Text(0)), reader.Number(1), reader.Number(2),
                              reader.Number(3), reader.Number(4), std::string(reader.Text(5))});
  }
  reader.RequireRows();
  return sequences;
}

Published ReadPublished(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(folder.string(), 0, "", "expected a folder of published numbers");
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  Published published;
  for (const auto& file : files) {
    const std::string text = ReadTextFile(file);
    if (HasLine(text, kSequencesHeader)) {
      published.sequences.push_back(ParsePublishedSequences(text, file.string()));
    } else {
      published.numbers.push_back(ParsePublishedNumbers(text, file.string()));
    }
  }
  if (published.empty()) {
    throw InputError(folder.string(), 0, "", "expected at least one file NAME.csv");
  }
  return published;
}

}  // namespace duet
