#include "experiments/figures/figure.h"

#include <limits>

namespace duet {

Series LineSeries(std::string name, std::string legend, Look look, std::vector<double> x,
                  std::vector<double> y) {
  return {.kind = SeriesKind::kLine,
          .name = std::move(name),
          .legend = std::move(legend),
          .look = look,
          .columns = {std::move(x), std::move(y)}};
}

Series PointSeries(std::string name, std::string legend, Look look, std::vector<double> x,
                   std::vector<double> y) {
  Series series = LineSeries(std::move(name), std::move(legend), look, std::move(x), std::move(y));
  series.kind = SeriesKind::kPoints;
  return series;
}

Series BandSeries(std::string name, std::string legend, Look look, std::vector<double> x,
                  std::vector<double> low, std::vector<double> high) {
  return {.kind = SeriesKind::kBand,
          .name = std::move(name),
          .legend = std::move(legend),
          .look = look,
          .columns = {std::move(x), std::move(low), std::move(high)}};
}

Series BarSeries(std::string name, std::string legend, Look look) {
  return {.kind = SeriesKind::kBars,
          .name = std::move(name),
          .legend = std::move(legend),
          .look = look,
          .columns = {{}, {}, {}, {}}};
}

void AddBar(double x_low, double x_high, double y_low, double y_high, Series* bars) {
  const double values[] = {x_low, x_high, y_low, y_high};
  for (std::size_t i = 0; i < 4; ++i) bars->columns[i].push_back(values[i]);
}

Series TextSeries(std::string name) {
  return {.kind = SeriesKind::kText,
          .name = std::move(name),
          .legend = {},
          .look = {},
          .columns = {{}, {}}};
}

void AddText(double x, double y, std::string text, Series* texts) {
  texts->columns[0].push_back(x);
  texts->columns[1].push_back(y);
  texts->texts.push_back(std::move(text));
}

void AddSegment(double x0, double y0, double x1, double y1, Series* line) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  if (!line->columns[0].empty()) {
    line->columns[0].push_back(kGap);
    line->columns[1].push_back(kGap);
  }
  line->columns[0].insert(line->columns[0].end(), {x0, x1});
  line->columns[1].insert(line->columns[1].end(), {y0, y1});
}

}  // namespace duet
