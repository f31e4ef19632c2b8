#include "experiments/figures/figure.h"

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

Series SegmentSeries(std::string name, std::string legend, Look look) {
  Series series = BarSeries(std::move(name), std::move(legend), look);
  series.kind = SeriesKind::kSegments;
  return series;
}

void AddSegment(double x0, double y0, double x1, double y1, Series* segments) {
  AddBar(x0, x1, y0, y1, segments);
}

}  // namespace duet
