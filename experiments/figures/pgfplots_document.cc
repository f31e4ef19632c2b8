#include <map>

#include "common/support/numeric_text.h"
#include "experiments/figures/figure_files.h"
#include "experiments/figures/figure_style.h"

namespace duet {
namespace {

// What TeX would take for its own, and the few letters beyond ASCII that figures have.
std::string TexText(const std::string& text) {
  static const std::map<std::string, std::string> kWords = {{"\\", "\\textbackslash{}"},
                                                            {"_", "\\_"},
                                                            {"&", "\\&"},
                                                            {"%", "\\%"},
                                                            {"#", "\\#"},
                                                            {"$", "\\$"},
                                                            {"{", "\\{"},
                                                            {"}", "\\}"},
                                                            {"~", "\\textasciitilde{}"},
                                                            {"^", "\\textasciicircum{}"},
                                                            {"<", "$<$"},
                                                            {">", "$>$"},
                                                            {"|", "$|$"},
                                                            {"±", "$\\pm$"},
                                                            {"σ", "$\\sigma$"},
                                                            {"χ", "$\\chi$"},
                                                            {"²", "$^2$"},
                                                            {"°", "$^\\circ$"},
                                                            {"×", "$\\times$"},
                                                            {"√", "$\\surd$"},
                                                            {"–", "--"},
                                                            {"τ", "$\\tau$"},
                                                            {"θ", "$\\theta$"},
                                                            {"µ", "$\\mu$"},
                                                            {"−", "$-$"}};
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t size = byte < 0x80 ? 1 : byte < 0xe0 ? 2 : byte < 0xf0 ? 3 : 4;
    const std::string letter = text.substr(i, size);
    const auto word = kWords.find(letter);
    out += word != kWords.end() ? word->second : size == 1 ? letter : "?";
    i += size;
  }
  return out;
}

std::string Millimetres(double mm) { return FormatFixed(mm, 3) + "mm"; }

std::string TexColour(int index) { return kColours[static_cast<std::size_t>(index)].name; }

std::string TexLine(const Look& look) {
  std::string text =
      TexColour(look.colour) + ", line width=" + FormatFixed(look.width_pt, 2) + "pt";
  const std::vector<double>& lengths = DashLengths(look.dash);
  if (lengths.empty()) return text + ", solid";
  text += ", dash pattern=";
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    text += (i % 2 == 0 ? "on " : "off ") + FormatFixed(lengths[i], 2) + "pt ";
  }
  return text;
}

std::string TexMark(const Look& look) {
  return std::string("mark=") + kSymbols[static_cast<std::size_t>(look.symbol)].pgfplots +
         ", mark size=" + FormatFixed(1.3 * look.width_pt, 2) + "pt, mark options={" +
         TexColour(look.colour) + ", fill=" + TexColour(look.colour) + ", solid}";
}

std::string TexFill(const Look& look, bool border) {
  std::string text = border ? "draw=black, line width=0.2pt" : "draw=none";
  if (look.pattern > 0) {
    return text + ", pattern=" + kHatchings[static_cast<std::size_t>(look.pattern)].pgfplots +
           ", pattern color=" + TexColour(look.colour);
  }
  return text + ", fill=" + TexColour(look.colour) +
         ", fill opacity=" + FormatFixed(look.opacity, 2);
}

class TexWriter {
 public:
  TexWriter(const Figure& figure, const FigureLayout& layout)
      : figure_(figure), layout_(layout), data_(figure.name + ".csv") {}

  std::string Write() {
    Preamble();
    text_ += "\\begin{tikzpicture}[x=1mm, y=1mm, font=\\fontsize{" + FormatFixed(kLetteringPt, 0) +
             "}{" + FormatFixed(1.2 * kLetteringPt, 1) + "}\\selectfont]\n";
    for (const ColourValue& colour : kColours) {
      text_ += std::string("\\definecolor{") + colour.name + "}{HTML}{" + colour.hex + "}\n";
    }
    text_ += "\\useasboundingbox (0,0) rectangle (" + FormatFixed(layout_.width, 3) + "," +
             FormatFixed(layout_.height, 3) + ");\n";
    const std::vector<SeriesColumns> columns = ColumnsOf(figure_);
    for (std::size_t i = 0; i < layout_.panels.size(); ++i) WritePanel(i, columns);
    LegendAndNotes();
    text_ += "\\end{tikzpicture}%\n\\duetfigureend\n";
    return text_;
  }

 private:
  void Preamble() {
    text_ = "% " + figure_.title + "\n";
    for (const std::string& source : figure_.sources) text_ += "% from " + source + "\n";
    text_ +=
        "% \\input this in a paper that has \\usepackage{pgfplots} and\n"
        "% \\usetikzlibrary{patterns}, or run pdflatex on it; it reads " +
        data_ + ".\n";
    text_ +=
        "\\ifdefined\\pgfplotsset\\let\\duetfigureend\\relax\\else\n"
        "\\documentclass{article}\n"
        "\\usepackage[paperwidth=" +
        Millimetres(layout_.width) + ",paperheight=" + Millimetres(layout_.height) +
        ",margin=0mm]{geometry}\n"
        "\\usepackage{pgfplots}\n\\usetikzlibrary{patterns}\n"
        "\\pagestyle{empty}\\parindent0pt\\topskip0pt\n"
        "\\def\\duetfigureend{\\end{document}}\n"
        "\\begin{document}\\fi\n"
        "\\pgfplotsset{compat=1.17}%\n";
  }

  void Node(const PlacedText& label, const std::string& how) {
    text_ += "\\node[inner sep=0pt, " + how + "] at (" + FormatFixed(label.x, 3) + "," +
             FormatFixed(label.y, 3) + ") {\\strut " + TexText(label.text) + "};\n";
  }

  void LegendAndNotes() {
    for (const PlacedText& note : layout_.notes) Node(note, "anchor=west");
    for (const PlacedLegend& entry : layout_.legend) {
      const Series& series = *entry.series;
      const std::string y = FormatFixed(entry.y, 3);
      const double end = entry.x + kSampleMm;
      if (series.kind == SeriesKind::kLine || series.kind == SeriesKind::kSegments) {
        text_ += "\\draw[" + TexLine(series.look) + "] (" + FormatFixed(entry.x, 3) + "," + y +
                 ") -- (" + FormatFixed(end, 3) + "," + y + ");\n";
      } else if (series.kind == SeriesKind::kPoints) {
        text_ += "\\draw plot[only marks, " + TexMark(series.look) + "] coordinates {(" +
                 FormatFixed(0.5 * (entry.x + end), 3) + "," + y + ")};\n";
      } else {
        text_ += "\\path[" + TexFill(series.look, series.kind == SeriesKind::kBars) + "] (" +
                 FormatFixed(entry.x, 3) + "," + FormatFixed(entry.y - 1.0, 3) + ") rectangle (" +
                 FormatFixed(end, 3) + "," + FormatFixed(entry.y + 1.0, 3) + ");\n";
      }
      Node({end + kSampleGapMm, entry.y, series.legend}, "anchor=west");
    }
  }

  void AxisOptions(const char* axis, const PlacedAxis& placed, bool grid) {
    text_ += std::string("  ") + axis + "min=" + FormatNumber(placed.low) + ", " + axis +
             "max=" + FormatNumber(placed.high) + ", " + axis +
             "mode=" + (placed.logarithmic ? "log" : "normal") + ", " + axis + "tick={";
    std::string names;
    const char* separator = "";
    for (const auto& [value, words] : placed.ticks) {
      text_ += separator + FormatNumber(value);
      names += separator + ("{\\strut " + TexText(words) + "}");
      separator = ",";
    }
    text_ += std::string("}, ") + axis + "ticklabels={" + names + "}, " + axis +
             "majorgrids=" + (grid ? "true" : "false") + ",\n";
  }

  void WritePanel(std::size_t index, const std::vector<SeriesColumns>& columns) {
    const PlacedPanel& panel = layout_.panels[index];
    text_ += "\\begin{axis}[at={(" + Millimetres(panel.left) + "," + Millimetres(panel.bottom) +
             ")}, anchor=south west, scale only axis,\n  width=" + Millimetres(panel.width) +
             ", height=" + Millimetres(panel.height) + ",\n";
    AxisOptions("x", panel.x, figure_.panels[index].x.grid);
    AxisOptions("y", panel.y, figure_.panels[index].y.grid);
    text_ +=
        "  axis lines=left, axis line style={-, line width=0.4pt}, grid style={black!15, line "
        "width=0.3pt},\n  major tick length=1mm, minor tick num=0, tick align=inside,\n"
        "  scaled ticks=false, unbounded coords=jump, filter discard warning=false,\n"
        "  every axis plot/.append style={forget plot}]\n";
    for (const SeriesColumns& of : columns) {
      if (of.panel == index && of.rows > 0) WriteSeries(of, columns);
    }
    text_ += "\\end{axis}\n";
    for (const PlacedText& line : panel.x_label) Node(line, "anchor=center");
    for (const PlacedText& line : panel.y_label) Node(line, "anchor=center, rotate=90");
    for (const PlacedText& line : panel.title) Node(line, "anchor=center");
  }

  // The rows that fill this series' columns up to the longest series are passed over.
  [[nodiscard]] static std::string Rows(const SeriesColumns& of,
                                        const std::vector<SeriesColumns>& columns) {
    std::size_t longest = 0;
    for (const SeriesColumns& other : columns) longest = std::max(longest, other.rows);
    if (longest == of.rows) return "";
    return ", skip coords between index={" + std::to_string(of.rows) + "}{" +
           std::to_string(longest) + "}";
  }

  [[nodiscard]] std::string Table(const std::string& columns) const {
    return " table[col sep=comma, comment chars={\\#}, header=false, " + columns + "] {" + data_ +
           "}";
  }

  void WriteSeries(const SeriesColumns& of, const std::vector<SeriesColumns>& columns) {
    const Series& series = *of.series;
    const std::string rows = Rows(of, columns);
    const auto column = [&of](int k) { return std::to_string(of.first + k); };
    const std::string x = "x index=" + column(0);
    switch (series.kind) {
      case SeriesKind::kLine:
        text_ += "\\addplot[mark=none, " + TexLine(series.look) + rows + "]" +
                 Table(x + ", y index=" + column(1)) + ";\n";
        return;
      case SeriesKind::kPoints:
        text_ += "\\addplot[only marks, " + TexMark(series.look) + rows + "]" +
                 Table(x + ", y index=" + column(1)) + ";\n";
        return;
      case SeriesKind::kBand:
        WriteBand(series, columns, of);
        return;
      case SeriesKind::kSegments:
      case SeriesKind::kBars:
        WriteBars(series, of);
        return;
      case SeriesKind::kText:
        text_ +=
            "\\addplot[only marks, mark=none, nodes near coords={\\pgfplotspointmeta}, nodes "
            "near coords align={center}, point meta=explicit symbolic" +
            rows + "]" + Table(x + ", y index=" + column(1) + ", meta index=" + column(2)) + ";\n";
        return;
    }
  }

  // The area between two curves: there along one, back along the other.
  void WriteBand(const Series& series, const std::vector<SeriesColumns>& columns,
                 const SeriesColumns& of) {
    const std::string rows = Rows(of, columns);
    const auto column = [&of](int k) { return std::to_string(of.first + k); };
    const std::string path = "duet" + std::to_string(of.first);
    text_ += "\\addplot[draw=none, mark=none, stack plots=y" + rows + "]" +
             Table("x index=" + column(0) + ", y index=" + column(1)) + ";\n";
    text_ += "\\addplot[mark=none, stack plots=y, " + TexFill(series.look, false) + rows + "]" +
             Table("x index=" + column(0) + ", y expr=\\thisrowno{" + column(2) + "}-\\thisrowno{" +
                   column(1) + "}") +
             " \\closedcycle;\n";
    text_ += "\\addplot[draw=none, mark=none, stack plots=y, stack dir=minus" + rows + "]" +
             Table("x index=" + column(0) + ", y index=" + column(2)) + ";\n";
  }

  void WriteBars(const Series& series, const SeriesColumns& of) {
    text_ += "\\pgfplotstableread[col sep=comma, comment chars={\\#}, header=false]{" + data_ +
             "}\\duetdata\n\\pgfplotsinvokeforeach{0,...," + std::to_string(of.rows - 1) + "}{\n";
    const char* names[] = {"xlow", "xhigh", "ylow", "yhigh"};
    for (int k = 0; k < 4; ++k) {
      text_ += "  \\pgfplotstablegetelem{#1}{[index]" + std::to_string(of.first + k) +
               "}\\of\\duetdata\\let\\duet" + names[k] + "\\pgfplotsretval\n";
    }
    const bool lines = series.kind == SeriesKind::kSegments;
    text_ += "  \\edef\\duetbar{\\noexpand\\path[" +
             (lines ? "draw=" + TexLine(series.look) : TexFill(series.look, true)) +
             "] (axis cs:\\duetxlow,\\duetylow) " + (lines ? "--" : "rectangle") +
             " (axis cs:\\duetxhigh,\\duetyhigh);}\n"
             "  \\duetbar}\n";
  }

  const Figure& figure_;
  const FigureLayout& layout_;
  const std::string data_;
  std::string text_;
};

}  // namespace

std::string PgfplotsDocument(const Figure& figure, const FigureLayout& layout) {
  return TexWriter(figure, layout).Write();
}

}  // namespace duet
