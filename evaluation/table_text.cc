#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "evaluation/study_table.h"
#include "evaluation/table_cells.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

std::string Padded(const std::string& text, std::size_t width, bool left) {
  const std::size_t own = TextWidth(text);
  const std::string blanks(width > own ? width - own : 0, ' ');
  return left ? text + blanks : blanks + text;
}

std::string WithoutBlanksAtEnd(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string MarkedText(const TableCell& cell) {
  const std::string text = CellText(cell);
  return cell.mark == TableMark::kBest         ? text + " *"
         : cell.mark == TableMark::kSecondBest ? text + " +"
                                               : text;
}

/// Widths of the columns, and of the groups over them: a group wider than its columns widens the
/// last of them.
std::vector<std::size_t> ColumnWidths(const StudyTable& table) {
  std::vector<std::size_t> width;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    width.push_back(0);
    for (const std::string& line : TitleLines(table, c)) {
      width[c] = std::max(width[c], TextWidth(line));
    }
  }
  for (const TableRow& row : table.rows) {
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      width[c] = std::max(width[c], TextWidth(MarkedText(row.cells[c])));
    }
  }
  for (const ColumnGroup& group : ColumnGroups(table)) {
    std::size_t total = 0;
    for (std::size_t c = group.begin; c < group.end; ++c) {
      total += width[c] + (c > group.begin ? 2 : 0);
    }
    const std::size_t wanted = TextWidth(group.title);
    if (wanted > total) width[group.end - 1] += wanted - total;
  }
  return width;
}

std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos && !text.starts_with('#')) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c;
    if (c == '"') quoted += '"';
  }
  return quoted + "\"";
}

std::string CsvNumber(double value) { return std::isfinite(value) ? FormatNumber(value) : ""; }

std::string CommentLines(const std::string& text) {
  std::string lines = "# ";
  for (const char c : text) lines += c == '\n' ? std::string("\n# ") : std::string(1, c);
  return lines + "\n";
}

}  // namespace

std::string CellText(const TableCell& cell) {
  if (!cell.text.empty()) return cell.text;
  if (!std::isfinite(cell.value)) return cell.is_blank ? "" : "-";
  std::string text = Number(cell.value, cell.decimals);
  if (std::isfinite(cell.low) && std::isfinite(cell.high)) {
    text += " [" + Number(cell.low, cell.decimals) + ", " + Number(cell.high, cell.decimals) + "]";
  }
  return text;
}

std::string ColumnTitle(const TableColumn& column) {
  return column.unit.empty() ? column.title : column.title + " [" + column.unit + "]";
}

std::size_t TextWidth(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

std::vector<std::string> TitleLines(const StudyTable& table, std::size_t column) {
  std::size_t widest = 0;
  for (const TableRow& row : table.rows) {
    if (column < row.cells.size()) {
      widest = std::max(widest, TextWidth(CellText(row.cells[column])));
    }
  }
  std::vector<std::string> lines = {""};
  const std::string title = ColumnTitle(table.columns[column]);
  for (std::size_t at = 0; at < title.size();) {
    const std::size_t end = std::min(title.find(' ', at), title.size());
    const std::string word = title.substr(at, end - at);
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (TextWidth(line) + 1 + TextWidth(word) <= widest) {
      line += " " + word;
    } else {
      lines.push_back(word);
    }
    at = end + 1;
  }
  return lines;
}

std::size_t TitleHeight(const StudyTable& table) {
  std::size_t height = 1;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    height = std::max(height, TitleLines(table, c).size());
  }
  return height;
}

std::vector<ColumnGroup> ColumnGroups(const StudyTable& table) {
  std::vector<ColumnGroup> groups;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string& title = table.columns[c].group;
    if (title.empty()) continue;
    if (!groups.empty() && groups.back().end == c && groups.back().title == title) {
      ++groups.back().end;
    } else {
      groups.push_back({title, c, c + 1});
    }
  }
  return groups;
}

std::string ParagraphText(const std::string& text) {
  constexpr std::size_t kWidth = 100;
  std::string result;
  std::string line;
  const auto end_line = [&] {
    result += WithoutBlanksAtEnd(line);
    line = "  ";
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!line.empty() && line != "  " && TextWidth(line) + TextWidth(word) > kWidth) end_line();
    line += word + " ";
    at = end + 1;
  }
  end_line();
  return result;
}

std::vector<std::string> SentencesOfVerdict(const std::string& verdict) {
  std::vector<std::string> sentences;
  for (std::size_t at = 0; at < verdict.size();) {
    const std::size_t end = std::min(verdict.find('\n', at), verdict.size());
    sentences.push_back(verdict.substr(at, end - at));
    at = end + 1;
  }
  return sentences;
}

std::string TableText(const StudyTable& table) {
  const std::vector<std::size_t> width = ColumnWidths(table);
  std::string text = ParagraphText(table.title) + "\n";
  const std::vector<ColumnGroup> groups = ColumnGroups(table);
  if (!groups.empty()) {
    std::string line;
    for (std::size_t c = 0; c < table.columns.size();) {
      const auto group = std::find_if(groups.begin(), groups.end(),
                                      [&](const ColumnGroup& g) { return g.begin == c; });
      const std::size_t end = group == groups.end() ? c + 1 : group->end;
      std::size_t total = 0;
      for (std::size_t k = c; k < end; ++k) total += width[k] + (k > c ? 2 : 0);
      line += (c > 0 ? "  " : "") + Padded(group == groups.end() ? "" : group->title, total, false);
      c = end;
    }
    text += WithoutBlanksAtEnd(line);
  }
  const std::size_t height = TitleHeight(table);
  for (std::size_t h = 0; h < height; ++h) {
    std::string header;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      // The last lines of all titles stand beside one another.
      const std::vector<std::string> lines = TitleLines(table, c);
      const std::size_t blank = height - lines.size();
      header += (c > 0 ? "  " : "") +
                Padded(h < blank ? "" : lines[h - blank], width[c], table.columns[c].is_text);
    }
    text += WithoutBlanksAtEnd(header);
  }
  std::size_t total = 0;
  for (std::size_t c = 0; c < width.size(); ++c) total += width[c] + (c > 0 ? 2 : 0);
  text += std::string(total, '-') + "\n";
  bool marked = false;
  for (const TableRow& row : table.rows) {
    if (!row.section.empty()) {
      text += row.section + "\n";
      continue;
    }
    CHECK_EQ(row.cells.size(), table.columns.size()) << table.name;
    std::string line;
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      marked = marked || row.cells[c].mark != TableMark::kNone;
      line += (c > 0 ? "  " : "") +
              Padded(MarkedText(row.cells[c]), width[c], table.columns[c].is_text);
    }
    text += WithoutBlanksAtEnd(line);
  }
  text += "\n";
  const std::vector<std::string> sentences = SentencesOfVerdict(table.verdict);
  for (const std::string& sentence : sentences) {
    text += ParagraphText((sentences.size() > 1 ? "- " : "") + sentence);
  }
  if (!sentences.empty()) text += "\n";
  if (marked) text += "* best, + second\n";
  for (const std::string& line : table.foot) text += ParagraphText(line);
  return text;
}

std::string TableCsv(const StudyTable& table) {
  std::string text = CommentLines(table.title);
  if (!table.verdict.empty()) text += CommentLines(table.verdict);
  for (const std::string& line : table.foot) text += CommentLines(line);
  bool sections = false;
  std::vector<bool> marked(table.columns.size(), false);
  for (const TableRow& row : table.rows) {
    sections = sections || !row.section.empty();
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      marked[c] = marked[c] || row.cells[c].mark != TableMark::kNone;
    }
  }
  std::string line = sections ? "section," : "";
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const TableColumn& column = table.columns[c];
    const std::string name = (column.group.empty() ? "" : column.group + " ") + ColumnTitle(column);
    line += (c > 0 ? "," : "") + CsvField(name);
    if (!column.spread.empty()) {
      line += "," + CsvField(name + " low") + "," + CsvField(name + " high");
    }
    if (marked[c]) line += "," + CsvField(name + " mark");
  }
  text += line + "\n";
  std::string section;
  for (const TableRow& row : table.rows) {
    if (!row.section.empty()) {
      section = row.section;
      continue;
    }
    CHECK_EQ(row.cells.size(), table.columns.size()) << table.name;
    line = sections ? CsvField(section) + "," : "";
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      const TableCell& cell = row.cells[c];
      line += (c > 0 ? "," : "") +
              (std::isfinite(cell.value) ? CsvNumber(cell.value) : CsvField(cell.text));
      if (!table.columns[c].spread.empty()) {
        line += "," + CsvNumber(cell.low) + "," + CsvNumber(cell.high);
      }
      if (marked[c]) {
        line += cell.mark == TableMark::kBest         ? ",best"
                : cell.mark == TableMark::kSecondBest ? ",second"
                                                      : ",";
      }
    }
    text += line + "\n";
  }
  return text;
}

}  // namespace duet
