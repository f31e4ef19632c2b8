#include "experiments/report/table_html.h"

#include <algorithm>

#include "common/support/logging.h"
#include "evaluation/table_cells.h"
#include "experiments/report/page_text.h"

namespace duet {
namespace {

std::string GroupsRow(const StudyTable& table, const std::vector<ColumnGroup>& groups) {
  std::string html = "<tr>";
  for (std::size_t c = 0; c < table.columns.size();) {
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [c](const ColumnGroup& g) { return g.begin == c; });
    if (group == groups.end()) {
      html += "<td></td>";
      ++c;
      continue;
    }
    html += "<th scope=\"colgroup\" class=\"group\" colspan=\"" +
            std::to_string(group->end - group->begin) + "\">" + EscapeHtml(group->title) + "</th>";
    c = group->end;
  }
  return html + "</tr>\n";
}

std::string CellHtml(const TableCell& cell, const TableColumn& column, bool is_first) {
  const std::string text = EscapeHtml(CellText(cell));
  if (is_first) return "<th scope=\"row\">" + text + "</th>";
  if (column.is_text) return "<td>" + text + "</td>";
  switch (cell.mark) {
    case TableMark::kBest:
      return "<td class=\"number best\">" + text + "<span class=\"hidden\"> best</span></td>";
    case TableMark::kSecondBest:
      return "<td class=\"number second\">" + text + "<span class=\"hidden\"> second</span></td>";
    case TableMark::kNone:
      break;
  }
  return "<td class=\"number\">" + text + "</td>";
}

}  // namespace

std::string TableHtml(const StudyTable& table) {
  std::string html;
  for (const std::string& sentence : SentencesOfVerdict(table.verdict)) {
    html += "<p class=\"verdict\">" + EscapeHtml(sentence) + "</p>\n";
  }
  html += "<div class=\"table-box\" tabindex=\"0\" role=\"region\" aria-label=\"" +
          EscapeHtml(table.title) + "\">\n<table>\n<caption class=\"hidden\">" +
          EscapeHtml(table.title) + "</caption>\n<thead>\n";
  const std::vector<ColumnGroup> groups = ColumnGroups(table);
  if (!groups.empty()) html += GroupsRow(table, groups);
  html += "<tr>";
  for (const TableColumn& column : table.columns) {
    html += std::string("<th scope=\"col\"") + (column.is_text ? ">" : " class=\"number\">") +
            EscapeHtml(ColumnTitle(column)) + "</th>";
  }
  html += "</tr>\n</thead>\n<tbody>\n";
  bool marked = false;
  for (const TableRow& row : table.rows) {
    html += row.section.empty() ? "<tr>" : "<tr class=\"section\">";
    if (!row.section.empty()) {
      html += "<th scope=\"rowgroup\" colspan=\"" + std::to_string(table.columns.size()) + "\">" +
              EscapeHtml(row.section) + "</th>";
    } else {
      CHECK_EQ(row.cells.size(), table.columns.size()) << table.name;
    }
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      marked = marked || row.cells[c].mark != TableMark::kNone;
      html += CellHtml(row.cells[c], table.columns[c], c == 0);
    }
    html += "</tr>\n";
  }
  html += "</tbody>\n</table>\n</div>\n";
  if (marked) html += "<p class=\"note\">Best bold on green, second underlined.</p>\n";
  if (!table.foot.empty()) {
    html += "<details><summary>How to read it, and what was switched on</summary>\n<ul>\n";
    for (const std::string& line : table.foot) html += "<li>" + EscapeHtml(line) + "</li>\n";
    html += "</ul></details>\n";
  }
  return html;
}

}  // namespace duet
