#include "experiments/figures/figures.h"

#include <algorithm>
#include <nlohmann/json.hpp>

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
  DrawnRuns drawn;
  Figure (*make)(const FigureInput& input);
};

const std::vector<Maker>& Makers() {
  static const std::vector<Maker> makers = {
      {"trajectory_top", "Estimated trajectories and the truth from above.", DrawnRuns::kOneCell,
       TrajectoryTopFigure},
      {"trajectory_side", "Estimated trajectories and the truth from the side.",
       DrawnRuns::kOneCell, TrajectorySideFigure},
      {"position_error", "Position error over time, each axis with +-3 sigma.", DrawnRuns::kOneCell,
       PositionErrorFigure},
      {"orientation_error", "Orientation error over time, each axis with +-3 sigma.",
       DrawnRuns::kOneCell, OrientationErrorFigure},
      {"rmse_over_runs", "Position and orientation RMSE of every run, by seed.",
       DrawnRuns::kOverSeeds, RmseOverRunsFigure},
      {"nees_over_time", "NEES of the pose, mean over runs, with its 95 % chi-squared band.",
       DrawnRuns::kOverSeeds, NeesOverTimeFigure},
      {"relative_errors", "Relative errors as boxes by the length of the segments.",
       DrawnRuns::kOverSeeds, RelativeErrorsFigure},
      {"calibration",
       "Estimated calibration over time with +-3 sigma, the truth and what was told.",
       DrawnRuns::kOneCell, CalibrationFigure},
      {"ablation_matrix", "What estimating each part of the calibration changes; of duet ablate.",
       DrawnRuns::kNone, AblationMatrixFigure},
      {"cost_against_accuracy", "Median time a frame against position RMSE, by setting.",
       DrawnRuns::kOverSettings, CostAgainstAccuracyFigure},
      {"time_by_stage", "Where the time of a frame goes, and its p50, p95, p99 and maximum.",
       DrawnRuns::kOverSeeds, TimeByStageFigure},
      {"track_lengths", "How long tracks are; of a run's stream or of a recording with tracks.",
       DrawnRuns::kOneStream, TrackLengthsFigure},
      {"parallax", "How much parallax tracks have; as track_lengths, with the true orientation.",
       DrawnRuns::kOneStream, ParallaxFigure},
      {"allan", "Allan deviations of an IMU at rest and their fit; of duet allan.",
       DrawnRuns::kNone, AllanFigure},
      {"information_spectrum",
       "Eigenvalues of the information matrix; of runs or of a file of duet observability.",
       DrawnRuns::kOneCell, InformationSpectrumFigure},
      {"normalized_errors",
       "Errors over their standard deviations against the standard normal distribution.",
       DrawnRuns::kOverSeeds, NormalizedErrorsFigure},
      {"whiteness", "Autocorrelation of the normalized errors over the lag.", DrawnRuns::kOverSeeds,
       WhitenessFigure},
      {"thesis_3_2", "Gyroscope at rest with its normal fit; of a recording that begins at rest.",
       DrawnRuns::kOneStream, Thesis32Figure},
      {"thesis_3_8", "The car of thesis 3.4: its position; needs no records.", DrawnRuns::kNone,
       Thesis38Figure},
      {"thesis_3_9", "The car of thesis 3.4: its position error with +-3 sigma.", DrawnRuns::kNone,
       Thesis39Figure},
      {"thesis_3_10", "The car of thesis 3.4: errors of position and velocity with +-3 sigma.",
       DrawnRuns::kNone, Thesis310Figure},
      {"thesis_5_4",
       "When the rows of a rolling shutter's images are taken; an example, or a run's.",
       DrawnRuns::kOneRun, Thesis54Figure},
      {"thesis_6_3", "Structure of H_x, the filter's Jacobian of one feature; needs no records.",
       DrawnRuns::kNone, Thesis63Figure},
      {"thesis_8_1", "Position and orientation errors after SE(3) alignment with their RMS.",
       DrawnRuns::kOneCell, Thesis81Figure},
      {"thesis_8_2", "The truth and the two estimators from above, after SE(3) alignment.",
       DrawnRuns::kOneCell, Thesis82Figure},
  };
  return makers;
}

// JSON files are taken as docs/formats.md describes them; one that is not so is bad input.
Figure Made(const Maker& maker, const FigureInput& input) {
  try {
    return maker.make(input);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        input.folders.empty() ? std::string() : input.folders.front().string(), 0, "",
        std::string("a JSON file of it is not as docs/formats.md says: ") + error.what());
  }
}

void ThinLines(Figure* figure) {
  for (Panel& panel : figure->panels) {
    for (Series& series : panel.series) {
      if (series.kind != SeriesKind::kLine && series.kind != SeriesKind::kBand) continue;
      std::vector<std::span<const double>> columns(series.columns.begin(), series.columns.end());
      // Along a time axis only what is above it has extremes.
      std::size_t most_rows = kMostRows;
      if (std::is_sorted(series.columns[0].begin(), series.columns[0].end())) {
        columns.erase(columns.begin());
      } else {
        most_rows *= 4;  // a path turns in both
      }
      const std::vector<std::size_t> rows = ThinnedRows(columns, most_rows);
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

Figure ComposeFigure(const std::string& name, const FigureInput& input) {
  std::vector<std::string> names;
  for (const Maker& maker : Makers()) {
    names.emplace_back(maker.name);
    if (name != maker.name) continue;
    RequireEffect(input.choice, name, maker.drawn);
    Figure figure = Made(maker, input);
    figure.name = name;
    if (figure.title.empty()) figure.title = maker.summary;
    ThinLines(&figure);
    return figure;
  }
  throw InputError("unknown figure '" + name + "' (duet figure list names them)" +
                   DidYouMean(name, names));
}

bool MakeFigure(const std::string& name, const FigureInput& input,
                const std::filesystem::path& out) {
  return WriteFigure(ComposeFigure(name, input), out);
}

}  // namespace duet
