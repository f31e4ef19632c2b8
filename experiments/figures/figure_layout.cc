#include "experiments/figures/figure_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "experiments/figures/figure_style.h"

namespace duet {
namespace {

constexpr double kEdgeMm = 0.8;         // between anything and the page's edge
constexpr double kTickGapMm = 1.8;      // between the frame and its ticks' texts
constexpr double kPanelGapMm = 2.6;     // between panels that share x
constexpr double kLegendSpaceMm = 3.5;  // between entries
// A paper's own font may be a little wider than the house's (Computer Modern is, by 5 %).
constexpr double kWiderFont = 1.06;
constexpr double kNoteWidthMm = (kColumnWidthMm - 2.0 * kEdgeMm) / kWiderFont;
constexpr double kTickRoomMm = 1.7 * kLineHeightMm;  // of one tick of y
constexpr double kDigitsHeightMm = 2.1;              // of a tick's text

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void Add(double value, bool positive_only) {
    if (!std::isfinite(value) || (positive_only && value <= 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// Which columns of a series lie along x; the others lie along y.
bool AlongX(SeriesKind kind, std::size_t column) {
  const bool two = kind == SeriesKind::kBars || kind == SeriesKind::kSegments;
  return column == 0 || (two && column == 1);
}

Range DataRange(const Panel& panel, bool along_x) {
  const Axis& axis = along_x ? panel.x : panel.y;
  Range range;
  for (const Series& series : panel.series) {
    for (std::size_t k = 0; k < series.columns.size(); ++k) {
      if (AlongX(series.kind, k) != along_x) continue;
      for (const double value : series.columns[k]) range.Add(value, axis.logarithmic);
    }
  }
  if (range.low > range.high) range = {axis.logarithmic ? 0.1 : 0.0, 1.0};
  const double low = axis.low.value_or(range.low);
  const double high = axis.high.value_or(range.high);
  if (axis.logarithmic) {
    range = {low, high > low ? high : low * 10.0};
    const double room = std::pow(range.high / range.low, 0.04);
    return {axis.low ? range.low : range.low / room, axis.high ? range.high : range.high * room};
  }
  const double spread = high > low ? high - low : std::max(1e-9, std::abs(high) * 0.1);
  // What a border would cut stays inside of it.
  const double room = along_x ? 0.0 : 0.05 * spread;
  range = {axis.low ? low : low - room, axis.high ? high : high + room};
  if (range.high <= range.low) range.high = range.low + spread;
  return range;
}

PlacedAxis PlaceAxis(const Axis& axis, const Range& range, double length_mm, double tick_mm) {
  PlacedAxis placed;
  if (!axis.ticks.empty()) {
    placed.low = range.low;
    placed.high = range.high;
    placed.ticks = axis.ticks;
  } else if (axis.logarithmic) {
    placed = RoundLogarithmicAxis(range.low, range.high, length_mm, tick_mm);
  } else {
    placed = RoundAxis(range.low, range.high, length_mm, tick_mm);
  }
  placed.logarithmic = axis.logarithmic;
  return placed;
}

double WidestTick(const PlacedAxis& axis) {
  double widest = 0.0;
  for (const auto& [value, text] : axis.ticks) widest = std::max(widest, TextWidthMm(text));
  return widest;
}

// Longer along the axis that would be shown larger, so that both have one scale.
void EqualizeScales(double width, double height, Range* x, Range* y) {
  const double per_mm = std::max((x->high - x->low) / width, (y->high - y->low) / height);
  const auto widen = [per_mm](Range* range, double mm) {
    const double more = 0.5 * (per_mm * mm - (range->high - range->low));
    range->low -= more;
    range->high += more;
  };
  widen(x, width);
  widen(y, height);
}

std::vector<PlacedLegend> PlaceLegend(const Figure& figure, double* rows_mm) {
  std::vector<PlacedLegend> legend;
  std::set<std::string> seen;
  double x = kEdgeMm + 1.0;
  double row_mm = 0.5 * kLineHeightMm;
  std::size_t row_begin = 0;
  const auto end_row = [&](double right) {  // centred
    const double shift = 0.5 * (kColumnWidthMm - kEdgeMm - right);
    for (std::size_t i = row_begin; i < legend.size(); ++i) legend[i].x += std::max(0.0, shift);
    row_begin = legend.size();
  };
  double right = x;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      if (series.legend.empty() || !seen.insert(series.legend).second) continue;
      const double width = kSampleMm + kSampleGapMm + kWiderFont * TextWidthMm(series.legend);
      if (x > kEdgeMm + 1.0 && x + width > kColumnWidthMm - kEdgeMm) {
        end_row(right);
        x = kEdgeMm + 1.0;
        row_mm += kLineHeightMm;
      }
      legend.push_back({x, row_mm, &series});  // y: from above, turned round by LayOut
      right = x + width;
      x = right + kLegendSpaceMm;
    }
  }
  end_row(right);
  *rows_mm = legend.empty() ? 0.0 : row_mm + 0.5 * kLineHeightMm;
  return legend;
}

// The digits that a step of this size needs behind the point.
int DecimalsOf(double step) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 12);
}

std::string TickText(double value, double step, double largest) {
  if (largest >= 1e6 || largest < 1e-3) {  // rather 2e-05 than a row of zeros
    char text[32];
    std::snprintf(text, sizeof(text), "%.2g", value);
    return text;
  }
  std::string text = FormatFixed(value, DecimalsOf(step));
  if (text.find_first_not_of("-0.") == std::string::npos) text = "0";
  return text;
}

}  // namespace

PlacedAxis RoundAxis(double low, double high, double length_mm, double tick_mm) {
  CHECK(std::isfinite(low) && std::isfinite(high) && low < high) << low << " to " << high;
  const double least = (high - low) * tick_mm / length_mm;
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  const auto count = [low, high](double step) {
    return std::floor(high / step + 1e-6) - std::ceil(low / step - 1e-6) + 1.0;
  };
  double step = decade;
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    // Rather closer than one tick alone.
    if (factor > 1.0 && count(factor * decade) < 2.0) break;
    step = factor * decade;
    if (step >= least * (1.0 - 1e-9)) break;
  }
  PlacedAxis axis{.low = low, .high = high, .ticks = {}};
  const double largest = std::max(std::abs(low), std::abs(high));
  for (double k = std::ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k += 1.0) {
    const double value = k == 0.0 ? 0.0 : k * step;
    axis.ticks.emplace_back(std::clamp(value, low, high), TickText(value, step, largest));
  }
  return axis;
}

PlacedAxis RoundLogarithmicAxis(double low, double high, double length_mm, double tick_mm) {
  CHECK(0.0 < low && low < high) << low << " to " << high;
  PlacedAxis axis{.low = low, .high = high, .logarithmic = true, .ticks = {}};
  const double mm_a_decade = length_mm / std::log10(high / low);
  const int every = std::max(1, static_cast<int>(std::ceil(tick_mm / mm_a_decade)));
  const auto ticks_at = [&](const std::vector<double>& factors) {
    std::vector<std::pair<double, std::string>> ticks;
    for (int e = static_cast<int>(std::floor(std::log10(low))) - 1; std::pow(10.0, e) <= high;
         ++e) {
      if (e % every != 0) continue;
      for (const double factor : factors) {
        const double value = factor * std::pow(10.0, e);
        if (value < low * (1.0 - 1e-9) || value > high * (1.0 + 1e-9)) continue;
        char text[32];
        std::snprintf(text, sizeof(text), e < -4 || e > 4 ? "%.0e" : "%g", value);
        ticks.emplace_back(value, text);
      }
    }
    return ticks;
  };
  // The densest of these that has room; a denser one rather than a single tick.
  axis.ticks = ticks_at({1.0});
  if (std::log10(2.0) * mm_a_decade >= tick_mm || axis.ticks.size() < 2) {
    axis.ticks = ticks_at({1.0, 2.0, 5.0});
  }
  if (axis.ticks.size() < 2) axis.ticks = RoundAxis(low, high, length_mm, 2.0 * tick_mm).ticks;
  return axis;
}

FigureLayout LayOut(const Figure& figure) {
  FigureLayout layout;
  layout.width = kColumnWidthMm;
  double legend_mm = 0.0;
  layout.legend = PlaceLegend(figure, &legend_mm);

  // The frames' left and right are the same for all panels: of the widest ticks, and of the words
  // beside them, which need to know no more than the frame's height.
  std::vector<Range> x_ranges;
  std::vector<Range> y_ranges;
  std::vector<std::vector<std::string>> y_labels;
  double tick_mm = 0.0;
  std::size_t label_lines = 0;
  for (const Panel& panel : figure.panels) {
    x_ranges.push_back(DataRange(panel, true));
    y_ranges.push_back(DataRange(panel, false));
    const PlacedAxis y = PlaceAxis(panel.y, y_ranges.back(), panel.height_mm, kTickRoomMm);
    tick_mm = std::max(tick_mm, WidestTick(y));
    y_labels.push_back(WrapText(panel.y.label, panel.height_mm + 1.5));
    label_lines = std::max(label_lines, y_labels.back().size());
  }
  const double label_mm = kLineHeightMm * static_cast<double>(label_lines);
  const double left = kEdgeMm + label_mm + 0.8 + tick_mm + kTickGapMm;
  const double right = kColumnWidthMm - kEdgeMm - 3.0;  // half of the last tick's text
  const double width = right - left;
  CHECK_GT(width, 0.0) << figure.name;

  double down = kEdgeMm + legend_mm + (legend_mm > 0.0 ? 1.0 : 0.0);  // from the page's top
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    PlacedPanel placed;
    if (!panel.title.empty()) {
      for (const std::string& line : WrapText(panel.title, kColumnWidthMm - 2.0 * kEdgeMm)) {
        placed.title.push_back({0.5 * (left + right), down + 0.5 * kLineHeightMm, line});
        down += kLineHeightMm;
      }
      down += 0.6;
    } else if (i == 0) {
      down += 0.5 * kDigitsHeightMm;  // a tick at the frame's upper end
    }
    placed.left = left;
    placed.width = width;
    placed.height = panel.height_mm;
    if (panel.equal_scale) EqualizeScales(width, panel.height_mm, &x_ranges[i], &y_ranges[i]);
    // An x tick needs room for its text, whose length depends on the step: twice is enough.
    placed.x = PlaceAxis(panel.x, x_ranges[i], width, 9.0);
    placed.x = PlaceAxis(panel.x, x_ranges[i], width, WidestTick(placed.x) + 4.0);
    placed.y = PlaceAxis(panel.y, y_ranges[i], panel.height_mm, kTickRoomMm);
    const double middle = down + 0.5 * panel.height_mm;
    const double label_right = left - kTickGapMm - tick_mm - 0.8;
    const double lines = static_cast<double>(y_labels[i].size());
    for (std::size_t k = 0; k < y_labels[i].size(); ++k) {
      placed.y_label.push_back(
          {label_right - kLineHeightMm * (lines - static_cast<double>(k) - 0.5), middle,
           y_labels[i][k]});
    }
    down += panel.height_mm;
    placed.bottom = down;
    if (panel.share_x) {
      for (auto& [value, text] : placed.x.ticks) text.clear();
      down += kPanelGapMm;
    } else {
      down += kTickGapMm + kLineHeightMm + 0.9;
      for (const std::string& line : WrapText(panel.x.label, width + 3.0)) {
        placed.x_label.push_back({0.5 * (left + right), down + 0.5 * kLineHeightMm, line});
        down += kLineHeightMm;
      }
      if (i + 1 < figure.panels.size()) down += 1.8;
    }
    layout.panels.push_back(std::move(placed));
  }
  for (const std::string& note : figure.notes) {
    for (const std::string& line : WrapText(note, kNoteWidthMm)) {
      layout.notes.push_back({kEdgeMm + 0.5, down + 0.5 * kLineHeightMm + 0.4, line});
      down += kLineHeightMm;
    }
  }
  layout.height = down + kEdgeMm;

  // From above to from below.
  const auto turn = [&layout](std::vector<PlacedText>* texts) {
    for (PlacedText& text : *texts) text.y = layout.height - text.y;
  };
  for (PlacedPanel& panel : layout.panels) {
    panel.bottom = layout.height - panel.bottom;
    turn(&panel.x_label);
    turn(&panel.y_label);
    turn(&panel.title);
  }
  for (PlacedLegend& entry : layout.legend) entry.y = layout.height - kEdgeMm - entry.y;
  turn(&layout.notes);
  return layout;
}

}  // namespace duet
