#include <algorithm>
#include <cmath>

#include "common/support/numeric_text.h"
#include "experiments/figures/figure_files.h"
#include "experiments/figures/figure_style.h"

namespace duet {
namespace {

constexpr double kPngDotsPerInch = 300.0;
constexpr double kSvgDotsPerInch = 96.0;  // CSS's pixel

std::string GnuplotQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

std::string Colour(int index) {
  return std::string("rgb '#") + kColours[static_cast<std::size_t>(index)].hex + "'";
}

// Dash lengths count in half widths of the line for gnuplot. Ends are round (a flat one shows the
// first, tiny step that its cairo terminals make), which lengthens every dash by a width.
std::string LineLook(const Look& look) {
  std::string text = "lw " + FormatFixed(look.width_pt, 2) + " lc " + Colour(look.colour) + " dt ";
  const std::vector<double>& lengths = DashLengths(look.dash);
  if (lengths.empty()) return text + "1";
  std::string list;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const double length =
        i % 2 == 0 ? std::max(0.02, lengths[i] - look.width_pt) : lengths[i] + look.width_pt;
    list += (list.empty() ? "(" : ",") + FormatFixed(2.0 * length / look.width_pt, 2);
  }
  return text + list + ")";
}

std::string FillLook(const Look& look) {
  if (look.pattern > 0) {
    return "fs pattern " +
           std::to_string(kHatchings[static_cast<std::size_t>(look.pattern)].gnuplot);
  }
  return (look.opacity < 1.0 ? "fs transparent solid " : "fs solid ") +
         FormatFixed(look.opacity, 2);
}

std::string PointLook(const Look& look) {
  return "pt " + std::to_string(kSymbols[static_cast<std::size_t>(look.symbol)].gnuplot) + " ps " +
         FormatFixed(0.45 * look.width_pt, 2) + " lc " + Colour(look.colour);
}

class ScriptWriter {
 public:
  ScriptWriter(const Figure& figure, const FigureLayout& layout)
      : figure_(figure), layout_(layout), data_(figure.name + ".csv") {}

  std::string Write() {
    text_ = "# " + figure_.title + "\n# gnuplot " + figure_.name + ".gp, in this folder: draws " +
            data_ + " as " + figure_.name + ".svg, .pdf and .png.\n";
    for (const std::string& source : figure_.sources) text_ += "# from " + source + "\n";
    text_ += "set encoding utf8\nset datafile separator ','\nset datafile commentschars '#'\n";
    text_ += "do for [form in 'svg pdf png'] {\n";
    Terminals();
    text_ += "  set output " + GnuplotQuoted(figure_.name + ".") + ".form\n  set multiplot\n";
    LegendAndNotes();
    const std::vector<SeriesColumns> columns = ColumnsOf(figure_);
    for (std::size_t i = 0; i < layout_.panels.size(); ++i) PlotPanel(i, columns);
    text_ += "  unset multiplot\n  unset output\n}\n";
    return text_;
  }

 private:
  // gnuplot's cairo terminals count a letter's points at 96 to the inch.
  void Terminals() {
    const auto pixels = [](double mm, double dpi) {
      return std::to_string(static_cast<int>(std::lround(mm / 25.4 * dpi)));
    };
    const std::string font = std::string("font '") + kFont + ",";
    const auto scaled = [](double dpi) { return FormatFixed(dpi / 72.0, 4); };
    text_ += "  if (form eq 'svg') { set terminal svg noenhanced rounded size " +
             pixels(layout_.width, kSvgDotsPerInch) + "," +
             pixels(layout_.height, kSvgDotsPerInch) + " " + font +
             FormatFixed(kLetteringPt * kSvgDotsPerInch / 72.0, 2) + "' linewidth " +
             scaled(kSvgDotsPerInch) + " background rgb 'white' }\n";
    text_ += "  if (form eq 'pdf') { set terminal pdfcairo noenhanced rounded size " +
             FormatFixed(layout_.width / 10.0, 3) + "cm," + FormatFixed(layout_.height / 10.0, 3) +
             "cm " + font + FormatFixed(kLetteringPt, 0) + "' fontscale 0.75 linewidth 2 }\n";
    text_ += "  if (form eq 'png') { set terminal pngcairo noenhanced rounded size " +
             pixels(layout_.width, kPngDotsPerInch) + "," +
             pixels(layout_.height, kPngDotsPerInch) + " " + font + FormatFixed(kLetteringPt, 0) +
             "' fontscale " + FormatFixed(kPngDotsPerInch / kSvgDotsPerInch, 4) + " linewidth " +
             scaled(kPngDotsPerInch) + " pointscale " + scaled(kPngDotsPerInch) + " }\n";
  }

  [[nodiscard]] std::string At(double x_mm, double y_mm) const {
    return "screen " + FormatFixed(x_mm / layout_.width, 5) + ", screen " +
           FormatFixed(y_mm / layout_.height, 5);
  }

  void Label(const PlacedText& label, const std::string& how) {
    text_ += "  set label " + GnuplotQuoted(label.text) + " at " + At(label.x, label.y) + " " +
             how + "\n";
  }

  // Belong to the page; drawn with the first panel.
  void LegendAndNotes() {
    for (const PlacedText& note : layout_.notes) Label(note, "left");
    for (const PlacedLegend& entry : layout_.legend) {
      const Series& series = *entry.series;
      const double end = entry.x + kSampleMm;
      if (series.kind == SeriesKind::kLine || series.kind == SeriesKind::kSegments) {
        text_ += "  set arrow from " + At(entry.x, entry.y) + " to " + At(end, entry.y) +
                 " nohead " + LineLook(series.look) + "\n";
      } else if (series.kind == SeriesKind::kPoints) {
        text_ += "  set label '' at " + At(0.5 * (entry.x + end), entry.y) + " point " +
                 PointLook(series.look) + "\n";
      } else {
        text_ +=
            "  set object rectangle from " + At(entry.x, entry.y - 1.0) + " to " +
            At(end, entry.y + 1.0) + " fc " + Colour(series.look.colour) + " " +
            FillLook(series.look) +
            (series.kind == SeriesKind::kBand ? " noborder\n" : " border lc rgb 'black' lw 0.4\n");
      }
      Label({end + kSampleGapMm, entry.y, series.legend}, "left");
    }
  }

  void Ticks(const char* axis, const PlacedAxis& placed, bool grid) {
    // First a range that any scale can have: the panel before may have left another.
    text_ += std::string("  set ") + axis + "range [1:10]\n  " +
             (placed.logarithmic ? "set" : "unset") + " logscale " + axis + "\n  set " + axis +
             "range [" + FormatNumber(placed.low) + ":" + FormatNumber(placed.high) + "]\n  set " +
             axis + "tics nomirror scale 0.4 (";
    const char* separator = "";
    for (const auto& [value, words] : placed.ticks) {
      text_ += separator + GnuplotQuoted(words) + " " + FormatNumber(value);
      separator = ", ";
    }
    text_ += std::string(")\n  set grid ") + (grid ? "" : "no") + axis + "tics\n";
  }

  void PlotPanel(std::size_t index, const std::vector<SeriesColumns>& columns) {
    const PlacedPanel& panel = layout_.panels[index];
    const Panel& what = figure_.panels[index];
    const auto margin = [this](const char* side, double mm, double of) {
      text_ += std::string("  set ") + side + "margin at screen " + FormatFixed(mm / of, 5) + "\n";
    };
    margin("l", panel.left, layout_.width);
    margin("r", panel.left + panel.width, layout_.width);
    margin("b", panel.bottom, layout_.height);
    margin("t", panel.bottom + panel.height, layout_.height);
    text_ += "  unset key\n  set border 3 lw 0.5\n";
    text_ += "  set grid back lt 1 lw 0.4 lc rgb '#d8d8d8'\n";
    Ticks("x", panel.x, what.x.grid);
    Ticks("y", panel.y, what.y.grid);
    for (const PlacedText& line : panel.x_label) Label(line, "center");
    for (const PlacedText& line : panel.y_label) Label(line, "center rotate by 90");
    for (const PlacedText& line : panel.title) Label(line, "center");
    std::string plots;
    for (const SeriesColumns& of : columns) {
      if (of.panel == index && of.rows > 0) {
        plots += (plots.empty() ? "  plot " : ", \\\n    ") + Plot(of);
      }
    }
    text_ +=
        (plots.empty() ? "  plot NaN" : plots) + "\n  unset label\n  unset arrow\n  unset object\n";
  }

  [[nodiscard]] std::string Plot(const SeriesColumns& of) const {
    const Look& look = of.series->look;
    const auto column = [&of](int k) { return std::to_string(of.first + 1 + k); };
    std::string head = GnuplotQuoted(data_) + " every ::0::" + std::to_string(of.rows - 1) +
                       " using " + column(0) + ":";
    switch (of.series->kind) {
      case SeriesKind::kLine:
        return head + column(1) + " with lines " + LineLook(look);
      case SeriesKind::kPoints:
        return head + column(1) + " with points " + PointLook(look);
      case SeriesKind::kBand:
        return head + column(1) + ":" + column(2) + " with filledcurves " + FillLook(look) +
               " noborder lc " + Colour(look.colour);
      case SeriesKind::kSegments:
        return head + column(2) + ":($" + column(1) + "-$" + column(0) + "):($" + column(3) + "-$" +
               column(2) + ") with vectors nohead " + LineLook(look);
      case SeriesKind::kBars:
        return head + column(2) + ":" + column(0) + ":" + column(1) + ":" + column(2) + ":" +
               column(3) + " with boxxyerror " + FillLook(look) +
               " border lc rgb 'black' lw 0.4 fc " + Colour(look.colour);
      case SeriesKind::kText:
        return head + column(1) + ":(strcol(" + column(2) + ")) with labels center tc " +
               Colour(look.colour);
    }
    return {};
  }

  const Figure& figure_;
  const FigureLayout& layout_;
  const std::string data_;
  std::string text_;
};

}  // namespace

std::string GnuplotScript(const Figure& figure, const FigureLayout& layout) {
  return ScriptWriter(figure, layout).Write();
}

}  // namespace duet
