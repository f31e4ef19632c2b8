#include "experiments/figures/figures.h"

#include <algorithm>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "experiments/figures/figure_files.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/thinning.h"

namespace duet {
namespace {

struct Maker {
  const char* name;
  const char* summary;
  Figure (*make)(const FigureInput& input);
};

const std::vector<Maker>& Makers() {
  static const std::vector<Maker> makers = {
      {"trajectory_top", "Estimated trajectories and the truth from above.", TrajectoryTopFigure},
      {"trajectory_side", "Estimated trajectories and the truth from the side.",
       TrajectorySideFigure},
      {"position_error", "Position error over time, each axis with +-3 sigma.",
       PositionErrorFigure},
      {"orientation_error", "Orientation error over time, each axis with +-3 sigma.",
       OrientationErrorFigure},
      {"rmse_over_runs", "Position and orientation RMSE of every run, by seed.",
       RmseOverRunsFigure},
      {"nees_over_time", "NEES of the pose, mean over runs, with its 95 % chi-squared band.",
       NeesOverTimeFigure},
  };
  return makers;
}

void ThinLines(Figure* figure) {
  for (Panel& panel : figure->panels) {
    for (Series& series : panel.series) {
      if (series.kind != SeriesKind::kLine && series.kind != SeriesKind::kBand) continue;
      std::vector<std::span<const double>> columns(series.columns.begin(), series.columns.end());
      // Along a time axis only what is above it has extremes.
      if (std::is_sorted(series.columns[0].begin(), series.columns[0].end())) {
        columns.erase(columns.begin());
      }
      const std::vector<std::size_t> rows = ThinnedRows(columns);
      for (std::vector<double>& column : series.columns) column = RowsOf(column, rows);
    }
  }
}

}  // namespace

std::vector<FigureName> FigureNames() {
  std::vector<FigureName> names;
  for (const Maker& maker : Makers()) names.push_back({maker.name, maker.summary});
  return names;
}

bool MakeFigure(const std::string& name, const FigureInput& input,
                const std::filesystem::path& out) {
  std::vector<std::string> names;
  for (const Maker& maker : Makers()) {
    names.emplace_back(maker.name);
    if (name != maker.name) continue;
    Figure figure = maker.make(input);
    figure.name = name;
    if (figure.title.empty()) figure.title = maker.summary;
    ThinLines(&figure);
    return WriteFigure(figure, out);
  }
  throw InputError("unknown figure '" + name + "'" + DidYouMean(name, names) +
                   "; duet figure list names them");
}

}  // namespace duet
