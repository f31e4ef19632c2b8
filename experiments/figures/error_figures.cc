#include <cmath>

#include "common/support/input_error.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

/// RMSEs that differ by more than this factor are shown on a logarithmic axis.
constexpr double kFarApart = 30.0;

constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

// Three panels, one an axis: what is true minus estimate, and the lines at +-3 sigma.
Figure ErrorFigure(const FigureInput& input, bool position) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = ExampleRuns(all);
  Figure figure;
  figure.sources = DescribeSources(runs);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Panel panel{.x = {.label = "time after the first frame [s]"},
                .y = {.label = std::string(position ? "position error " : "orientation error ") +
                               kAxisNames[axis] + (position ? " [m]" : " [deg]")},
                .height_mm = 29.0,
                .share_x = axis < 2};
    panel.series.push_back(LineSeries("zero", "", {.colour = kBlack, .width_pt = 0.4}, {}, {}));
    figure.panels.push_back(std::move(panel));
  }
  const std::vector<Look> looks = LooksOf(runs);
  bool aligned = false;
  bool by_first = false;
  double last_s = 0.0;
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const ErrorsOverTime errors = ErrorsOf(runs[n]);
    if (errors.t_s.empty()) continue;
    aligned = aligned || errors.aligned;
    by_first = by_first || errors.by_first;
    last_s = std::max(last_s, errors.t_s.back());
    const Look look = looks[n];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::vector<double>& values = position ? errors.p_m[axis] : errors.theta_deg[axis];
      const std::vector<double>& sigma =
          position ? errors.sigma_p_m[axis] : errors.sigma_theta_deg[axis];
      std::vector<double> low;
      std::vector<double> high;
      for (const double s : sigma) {
        low.push_back(-3.0 * s);
        high.push_back(3.0 * s);
      }
      std::vector<Series>& series = figure.panels[axis].series;
      Look sigma_look = SigmaLook(look);
      sigma_look.dash = look.dash == kSolid ? kSolid : kShortDashed;
      series.push_back(LineSeries(runs[n].label, runs[n].label, look, errors.t_s, values));
      series.push_back(LineSeries(runs[n].label + " -3 sigma", runs[n].label + ", ±3σ", sigma_look,
                                  errors.t_s, low));
      series.push_back(LineSeries(runs[n].label + " +3 sigma", "", sigma_look, errors.t_s, high));
    }
  }
  for (Panel& panel : figure.panels) panel.series[0].columns = {{0.0, last_s}, {0.0, 0.0}};
  figure.notes.push_back(position ? "Error: true minus estimate, axes of G."
                                  : "Error: θ of R_true = Exp(θ) R_estimate, axes of G.");
  if (aligned) {
    figure.notes.push_back(std::string("Laid onto the truth by ") +
                           (by_first ? "its first position and its yaw" : "position and yaw") +
                           " first: σ counts from the estimator's own start.");
  }
  AddNote(FailedNote(ExampleCells(all), "drawn as far as it went"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace

Figure PositionErrorFigure(const FigureInput& input) { return ErrorFigure(input, true); }
Figure OrientationErrorFigure(const FigureInput& input) { return ErrorFigure(input, false); }

Figure RmseOverRunsFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = RunsOfFirstGroup(all);
  Figure figure;
  figure.sources = DescribeSources(runs);
  const bool plain = runs.front().study.empty();
  Panel position{.x = {.label = plain ? "recording, in the order given" : "seed"},
                 .y = {.label = "position RMSE [m]", .low = 0.0},
                 .share_x = true};
  Panel orientation{.x = position.x, .y = {.label = "orientation RMSE [deg]", .low = 0.0}};
  const std::vector<std::string> estimators = EstimatorsOf(runs);
  for (std::size_t n = 0; n < estimators.size(); ++n) {
    std::vector<double> at, position_m, orientation_deg;
    for (const FigureRun& run : runs) {
      if (run.where.estimator != estimators[n]) continue;
      at.push_back(plain ? static_cast<double>(at.size() + 1) : run.where.seed);
      RunRmse rmse;
      if (!run.where.failed) rmse = RmseOf(run);
      position_m.push_back(rmse.position_m);
      orientation_deg.push_back(rmse.orientation_deg);
    }
    const Look look = LookOfEstimator(estimators[n], n);
    const auto add = [&](const std::vector<double>& values, Panel* panel) {
      Look points = look;  // without lines: seeds have no order
      points.width_pt = 1.2;
      panel->series.push_back(PointSeries(estimators[n], estimators[n], points, at, values));
    };
    add(position_m, &position);
    add(orientation_deg, &orientation);
  }
  for (Panel* panel : {&position, &orientation}) {
    double last = 1.0;
    double first = 1e300;
    double largest = 0.0;
    double smallest = 1e300;
    for (const Series& series : panel->series) {
      for (const double at : series.columns[0]) last = std::max(last, at);
      for (const double at : series.columns[0]) first = std::min(first, at);
      for (const double rmse : series.columns[1]) {
        if (!(rmse > 0.0)) continue;
        largest = std::max(largest, rmse);
        smallest = std::min(smallest, rmse);
      }
    }
    // One that is lost must not hide the others.
    if (largest > kFarApart * smallest) {
      panel->y.low.reset();
      panel->y.logarithmic = true;
    }
    panel->x.low = first - 0.5;
    panel->x.high = last + 0.5;
    if (last - first < 10.0) {
      for (int at = static_cast<int>(first); at <= static_cast<int>(last); ++at) {
        panel->x.ticks.emplace_back(at, std::to_string(at));
      }
    }
  }
  figure.panels = {position, orientation};
  figure.notes.push_back("Position after position and yaw, orientation after a yaw of its own.");
  AddNote(FailedNote(runs, "gaps"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace duet
