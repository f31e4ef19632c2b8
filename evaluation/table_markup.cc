#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/support/logging.h"
#include "evaluation/study_table.h"
#include "evaluation/table_cells.h"

namespace duet {
namespace {

/// Text as Markdown shows it: nothing in it is markup, no line ends in it.
std::string MarkdownText(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      result += ' ';
      continue;
    }
    if (std::string_view("\\`*_[]<>|#~").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

/// Text as LaTeX sets it, with any of its special characters.
std::string LatexText(std::string_view text) {
  std::string result;
  // A row that begins with a bracket would be taken for the argument of the \\\\ before it.
  if (text.starts_with('[') || text.starts_with('*')) result += "{}";
  for (const char c : text) {
    switch (c) {
      case '\\':
        result += "\\textbackslash{}";
        break;
      case '~':
        result += "\\textasciitilde{}";
        break;
      case '^':
        result += "\\textasciicircum{}";
        break;
      case '<':
        result += "\\textless{}";
        break;
      case '>':
        result += "\\textgreater{}";
        break;
      case '|':
        result += "\\textbar{}";
        break;
      case '"':
        result += "''";
        break;
      case '\n':
      case '\r':
        result += ' ';
        break;
      case '{':
      case '}':
      case '$':
      case '&':
      case '#':
      case '%':
      case '_':
        result += '\\';
        result += c;
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// Labels take letters, digits and a few signs.
std::string LatexLabel(std::string label) {
  for (char& c : label) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (!plain && c != '.' && c != '-') c = '-';
  }
  return label;
}

/// A number's minus, which is no hyphen.
std::string WithMinusSigns(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool minus =
        text[i] == '-' && i + 1 < text.size() && text[i + 1] >= '0' && text[i + 1] <= '9';
    result += minus ? std::string("$-$") : std::string(1, text[i]);
  }
  return result;
}

std::string LatexCell(const TableCell& cell) {
  const std::string escaped = LatexText(CellText(cell));
  const std::string text = cell.text.empty() ? WithMinusSigns(escaped) : escaped;
  return cell.mark == TableMark::kBest         ? "\\textbf{" + text + "}"
         : cell.mark == TableMark::kSecondBest ? "\\underline{" + text + "}"
                                               : text;
}

std::string MarkdownCell(const TableCell& cell) {
  const std::string text = MarkdownText(CellText(cell));
  return cell.mark == TableMark::kBest         ? "**" + text + "**"
         : cell.mark == TableMark::kSecondBest ? "*" + text + "*"
                                               : text;
}

/// A title of one line, or of several above one another.
std::string LatexTitle(const StudyTable& table, std::size_t column) {
  const std::vector<std::string> lines = TitleLines(table, column);
  if (lines.size() == 1) return LatexText(lines.front());
  std::string text =
      std::string("\\begin{tabular}[b]{@{}") + (table.columns[column].is_text ? "l" : "r") + "@{}}";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += (i > 0 ? "\\\\" : "") + LatexText(lines[i]);
  }
  return text + "\\end{tabular}";
}

/// The groups' line: a \multicolumn over each group, a rule below it.
std::string LatexGroups(const StudyTable& table, const std::vector<ColumnGroup>& groups) {
  std::string line;
  std::string rules;
  for (std::size_t c = 0; c < table.columns.size();) {
    if (c > 0) line += " & ";
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const ColumnGroup& g) { return g.begin == c; });
    if (group == groups.end()) {
      ++c;
      continue;
    }
    line += "\\multicolumn{" + std::to_string(group->end - group->begin) + "}{c}{" +
            LatexText(group->title) + "}";
    rules += "\\cmidrule(lr){" + std::to_string(group->begin + 1) + "-" +
             std::to_string(group->end) + "}";
    c = group->end;
  }
  return line + " \\\\\n" + rules + "\n";
}

}  // namespace

std::string TableMarkdown(const StudyTable& table) {
  std::string text = "**" + MarkdownText(table.title) + "**\n\n|";
  std::string rule = "|";
  for (const TableColumn& column : table.columns) {
    const std::string group = column.group.empty() ? "" : column.group + ": ";
    text += " " + MarkdownText(group + ColumnTitle(column)) + " |";
    rule += column.is_text ? " :-- |" : " --: |";
  }
  text += "\n" + rule + "\n";
  bool marked = false;
  for (const TableRow& row : table.rows) {
    text += "|";
    if (!row.section.empty()) {
      text += " **" + MarkdownText(row.section) + "** |";
      for (std::size_t c = 1; c < table.columns.size(); ++c) text += " |";
    }
    for (const TableCell& cell : row.cells) {
      marked = marked || cell.mark != TableMark::kNone;
      text += " " + MarkdownCell(cell) + " |";
    }
    text += "\n";
  }
  text += "\n";
  const std::vector<std::string> sentences = SentencesOfVerdict(table.verdict);
  for (const std::string& sentence : sentences) {
    text += (sentences.size() > 1 ? "- " : "") + MarkdownText(sentence) + "\n";
  }
  if (!sentences.empty()) text += "\n";
  if (marked) text += "Best bold, second in italics.\n\n";
  for (const std::string& line : table.foot) text += "- " + MarkdownText(line) + "\n";
  return text;
}

std::string TableLatex(const StudyTable& table) {
  std::string text =
      "% needs \\usepackage{booktabs,graphicx}\n"
      "\\begin{table}\n\\centering\n\\caption{" +
      LatexText(table.title) + ".}\n\\label{tab:" + LatexLabel(table.name) +
      "}\n\\footnotesize\n\\setlength{\\tabcolsep}{4pt}\n"
      // Shrunk only where it is wider than the line.
      "\\sbox0{\\begin{tabular}{@{}";
  for (const TableColumn& column : table.columns) text += column.is_text ? "l" : "r";
  text += "@{}}\n\\toprule\n";
  const std::vector<ColumnGroup> groups = ColumnGroups(table);
  if (!groups.empty()) text += LatexGroups(table, groups);
  const auto add_row = [&](const std::vector<std::string>& cells) {
    for (std::size_t c = 0; c < cells.size(); ++c) text += (c > 0 ? " & " : "") + cells[c];
    text += " \\\\\n";
  };
  std::vector<std::string> cells;
  for (std::size_t c = 0; c < table.columns.size(); ++c) cells.push_back(LatexTitle(table, c));
  add_row(cells);
  text += "\\midrule\n";
  bool marked = false;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const TableRow& row = table.rows[r];
    if (!row.section.empty()) {
      if (r > 0) text += "\\addlinespace\n";
      text += "\\multicolumn{" + std::to_string(table.columns.size()) + "}{@{}l}{\\textit{" +
              LatexText(row.section) + "}} \\\\\n";
      continue;
    }
    CHECK_EQ(row.cells.size(), table.columns.size()) << table.name;
    cells.clear();
    for (const TableCell& cell : row.cells) {
      marked = marked || cell.mark != TableMark::kNone;
      cells.push_back(LatexCell(cell));
    }
    add_row(cells);
  }
  text +=
      "\\bottomrule\n\\end{tabular}}%\n"
      "\\ifdim\\wd0>\\linewidth\\resizebox{\\linewidth}{!}{\\usebox0}"
      "\\else\\usebox0\\fi\n";
  std::string foot;
  const auto add_foot = [&](const std::string& line) {
    foot += (foot.empty() ? "" : "\\\\\n") + LatexText(line);
  };
  for (const std::string& sentence : SentencesOfVerdict(table.verdict)) add_foot(sentence);
  if (marked) add_foot("Best bold, second underlined.");
  for (const std::string& line : table.foot) add_foot(line);
  if (!foot.empty()) {
    text += "\n\\medskip\n\\begin{minipage}{\\linewidth}\\footnotesize\\raggedright\n" + foot +
            "\n\\end{minipage}\n";
  }
  return text + "\\end{table}\n";
}

}  // namespace duet
