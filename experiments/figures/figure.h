#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace duet {

/// How something drawn looks: a colour of the house's palette and, as a second cue for those who do
/// not see colours or print without, a dash, a mark or a hatching.
struct Look {
  int colour = 0;         ///< index into kColours (figure_style.h)
  int dash = 0;           ///< of lines: index into kDashes
  int symbol = 0;         ///< of points: index into kSymbols
  int pattern = 0;        ///< of bars: 0 filled, else hatched
  double width_pt = 1.0;  ///< of lines
  double opacity = 1.0;   ///< of bands and bars
};

enum class SeriesKind {
  kLine,      ///< columns x, y; NaN breaks the line
  kPoints,    ///< x, y
  kBand,      ///< x, low, high
  kSegments,  ///< x from, x to, y from, y to: straight lines
  kBars,      ///< x from, x to, y from, y to: rectangles
  kText,      ///< x, y and a text, centred there
};

/// One thing drawn, and its columns of the figure's data.
struct Series {
  SeriesKind kind = SeriesKind::kLine;
  std::string name;    ///< heads its columns in the data file
  std::string legend;  ///< empty: not in the legend; equal texts stand there once
  Look look;
  std::vector<std::vector<double>> columns;
  std::vector<std::string> texts = {};  ///< of kText
};

struct Axis {
  std::string label;  ///< in words, with the unit
  /// Ends that the data do not decide.
  std::optional<double> low = std::nullopt, high = std::nullopt;
  bool logarithmic = false;
  /// Ticks of its own: categories. Otherwise round numbers.
  std::vector<std::pair<double, std::string>> ticks = {};
  bool grid = true;
};

struct Panel {
  std::string title = {};  ///< above it; empty: none
  Axis x, y;
  double height_mm = 32.0;
  bool equal_scale = false;  ///< a metre is as long upwards as sidewards
  bool share_x = false;      ///< ticks and words of x are those of the panel below
  std::vector<Series> series = {};
};

/// A figure as data: panels below one another, one legend above them, notes at the foot. Writers
/// make the files of it (figure_files.h); what it looks like is decided in figure_style.h and
/// figure_layout.h alone.
struct Figure {
  std::string name;
  std::string title = {};  ///< one line for the files' comments
  std::vector<Panel> panels = {};
  std::vector<std::string> notes = {};    ///< below the panels
  std::vector<std::string> sources = {};  ///< the records that it was made from
};

[[nodiscard]] Series LineSeries(std::string name, std::string legend, Look look,
                                std::vector<double> x, std::vector<double> y);
[[nodiscard]] Series PointSeries(std::string name, std::string legend, Look look,
                                 std::vector<double> x, std::vector<double> y);
[[nodiscard]] Series BandSeries(std::string name, std::string legend, Look look,
                                std::vector<double> x, std::vector<double> low,
                                std::vector<double> high);

/// Rectangles, added one by one.
[[nodiscard]] Series BarSeries(std::string name, std::string legend, Look look);
void AddBar(double x_low, double x_high, double y_low, double y_high, Series* bars);
/// Texts, added one by one.
[[nodiscard]] Series TextSeries(std::string name);
void AddText(double x, double y, std::string text, Series* texts);
/// Straight lines from one point to the other, added one by one.
[[nodiscard]] Series SegmentSeries(std::string name, std::string legend, Look look);
void AddSegment(double x0, double y0, double x1, double y1, Series* segments);

}  // namespace duet
