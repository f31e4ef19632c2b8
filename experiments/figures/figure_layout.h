#pragma once

#include <string>
#include <utility>
#include <vector>

#include "experiments/figures/figure.h"

namespace duet {

/// An axis with its ends and the ticks on it.
struct PlacedAxis {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;
  std::vector<std::pair<double, std::string>> ticks;
};

/// Places on the page, in mm from its lower left corner. Texts are placed by their middle.
struct PlacedText {
  double x = 0.0;
  double y = 0.0;
  std::string text;
};

struct PlacedPanel {
  double left = 0.0, bottom = 0.0, width = 0.0, height = 0.0;  ///< of the frame
  PlacedAxis x, y;
  std::vector<PlacedText> x_label;  ///< one a line
  std::vector<PlacedText> y_label;  ///< one a line, turned by 90 degrees
  std::vector<PlacedText> title;
};

struct PlacedLegend {
  double x = 0.0;                  ///< left end of the sample
  double y = 0.0;                  ///< middle
  const Series* series = nullptr;  ///< whose look the sample has; of the figure
};

struct FigureLayout {
  double width = 0.0;
  double height = 0.0;
  std::vector<PlacedPanel> panels;
  std::vector<PlacedLegend> legend;
  std::vector<PlacedText> notes;  ///< by their left end
};

inline constexpr double kSampleMm = 6.0;     ///< length of a legend's sample
inline constexpr double kSampleGapMm = 1.2;  ///< from there to its text

/// Where everything of a figure stands on a page of a column's width, computed from the widths of
/// all texts, so that none is clipped and none lies on another, whoever draws it. The figure must
/// outlive the layout.
[[nodiscard]] FigureLayout LayOut(const Figure& figure);

/// The ends and round ticks of an axis that shows low to high within `length_mm`; labels have as
/// many digits as the step needs. `tick_mm`: room for one tick.
[[nodiscard]] PlacedAxis RoundAxis(double low, double high, double length_mm, double tick_mm);
/// The same with powers of ten, and 2 and 5 times them where there are few decades.
[[nodiscard]] PlacedAxis RoundLogarithmicAxis(double low, double high, double length_mm,
                                              double tick_mm);

}  // namespace duet
