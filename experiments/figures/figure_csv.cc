#include <algorithm>

#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "experiments/figures/figure_files.h"

namespace duet {
namespace {

std::vector<std::string> ColumnHeads(const Panel& panel, const Series& series) {
  const std::string x = panel.x.label;
  const std::string y = panel.y.label;
  switch (series.kind) {
    case SeriesKind::kLine:
    case SeriesKind::kPoints:
      return {x, y};
    case SeriesKind::kBand:
      return {x, y + " from", y + " to"};
    case SeriesKind::kSegments:
    case SeriesKind::kBars:
      return {x + " from", x + " to", y + " from", y + " to"};
    case SeriesKind::kText:
      return {x, y, "text"};
  }
  return {};
}

// A comma would end a field, and nothing reads quotes alike.
std::string Field(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

std::vector<SeriesColumns> ColumnsOf(const Figure& figure) {
  std::vector<SeriesColumns> all;
  int next = 0;
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    for (const Series& series : figure.panels[p].series) {
      const std::size_t rows = series.columns.front().size();
      for (const std::vector<double>& column : series.columns) CHECK_EQ(column.size(), rows);
      all.push_back({&series, p, next, rows});
      next += static_cast<int>(series.columns.size());
      if (series.kind == SeriesKind::kText) ++next;
    }
  }
  return all;
}

std::string FigureCsv(const Figure& figure) {
  std::string text = "# " + figure.title + "\n";
  for (const std::string& source : figure.sources) text += "# from " + source + "\n";
  for (const std::string& note : figure.notes) text += "# " + note + "\n";
  const std::vector<SeriesColumns> all = ColumnsOf(figure);
  std::size_t rows = 0;
  const char* separator = "#";
  for (const SeriesColumns& columns : all) {
    rows = std::max(rows, columns.rows);
    for (const std::string& head : ColumnHeads(figure.panels[columns.panel], *columns.series)) {
      text += separator + Field(columns.series->name + ": " + head);
      separator = ",";
    }
  }
  text += '\n';
  for (std::size_t row = 0; row < rows; ++row) {
    std::string line;
    for (const SeriesColumns& columns : all) {
      const bool has = row < columns.rows;
      for (const std::vector<double>& column : columns.series->columns) {
        if (has && std::isfinite(column[row])) {
          AppendNumber(column[row], &line);
        } else {
          line += "nan";
        }
        line += ',';
      }
      if (columns.series->kind == SeriesKind::kText) {
        line += (has ? Field(columns.series->texts[row]) : std::string("-")) + ",";
      }
    }
    line.back() = '\n';
    text += line;
  }
  return text;
}

}  // namespace duet
