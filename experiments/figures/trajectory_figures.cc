#include <algorithm>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "evaluation/alignment.h"
#include "evaluation/association.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

struct Path {
  std::vector<double> along[3];
};

Path PathOf(const std::vector<StampedPose>& poses) {
  Path path;
  for (const StampedPose& pose : poses) {
    for (int i = 0; i < 3; ++i) path.along[i].push_back(pose.T_GB.p[i]);
  }
  return path;
}

// The estimate after the alignment that its errors are taken with.
std::vector<StampedPose> Aligned(const std::vector<StampedPose>& truth,
                                 std::vector<StampedPose> estimate, AlignmentMode mode,
                                 bool* by_first) {
  const std::vector<PosePair> pairs = Associate(truth, estimate, {}).pairs;
  *by_first = false;
  if (pairs.empty()) return estimate;
  const Alignment alignment = AlignOrFirst(pairs, mode, by_first);
  for (StampedPose& pose : estimate) pose.T_GB.p = alignment.Apply(pose.T_GB.p);
  return estimate;
}

// The part of the truth that any estimate covers.
std::vector<StampedPose> Between(const std::vector<StampedPose>& truth, Timestamp start,
                                 Timestamp end) {
  std::vector<StampedPose> part;
  for (const StampedPose& pose : truth) {
    if (pose.timestamp >= start && pose.timestamp <= end) part.push_back(pose);
  }
  return part;
}

struct View {
  int across;  ///< axis of G along x
  int up;
  const char* across_label;
  const char* up_label;
  AlignmentMode mode = AlignmentMode::kPositionYaw;
  const char* alignment = "position and yaw";
  bool thesis_colours = false;
};

// The thesis's colours where each estimator is there once.
Look LookIn(const View& view, const FigureRun& run, Look look) {
  const bool own = look.colour == LookOfEstimator(run.where.estimator, 0).colour;
  if (view.thesis_colours && own && run.where.estimator == "msckf") look.colour = kGreen;
  if (view.thesis_colours && own && run.where.estimator == "window") look.colour = kOrange;
  return look;
}

Figure TrajectoryFigure(const FigureInput& input, const View& view) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = ExampleRuns(all);
  Figure figure;
  figure.sources = DescribeSources(runs);
  Panel panel{.x = {.label = view.across_label}, .y = {.label = view.up_label}};
  std::vector<Series> estimates;
  Timestamp start = 0;
  Timestamp end = 0;
  std::vector<StampedPose> truth;
  bool any_by_first = false;
  const std::vector<Look> looks = LooksOf(runs);
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const FigureRun& run = runs[n];
    std::vector<StampedPose> poses = TrajectoryOf(run);
    if (poses.empty()) continue;
    if (truth.empty()) {
      truth = TruthOf(run).poses;
      start = poses.front().timestamp;
      end = poses.back().timestamp;
    }
    start = std::min(start, poses.front().timestamp);
    end = std::max(end, poses.back().timestamp);
    bool by_first = false;
    const Path path = PathOf(Aligned(truth, std::move(poses), view.mode, &by_first));
    any_by_first = any_by_first || by_first;
    estimates.push_back(LineSeries(run.label, run.label, LookIn(view, run, looks[n]),
                                   path.along[view.across], path.along[view.up]));
  }
  if (estimates.empty()) {
    throw InputError(runs.front().folder.string() + " and its like have no state to draw");
  }
  const Path true_path = PathOf(Between(truth, start, end));
  Look truth_look = TruthLook();
  truth_look.width_pt = 1.6;
  truth_look.colour = view.thesis_colours ? kVermilion : kGrey;
  panel.series.push_back(LineSeries("truth", "truth", truth_look, true_path.along[view.across],
                                    true_path.along[view.up]));
  panel.series.insert(panel.series.end(), estimates.begin(), estimates.end());

  // As high as the path is in the scale of its width, within a page's reason.
  double low[2] = {1e300, 1e300};
  double high[2] = {-1e300, -1e300};
  for (const Series& series : panel.series) {
    for (std::size_t k = 0; k < 2; ++k) {
      const auto [least, most] =
          std::minmax_element(series.columns[k].begin(), series.columns[k].end());
      low[k] = std::min(low[k], *least);
      high[k] = std::max(high[k], *most);
    }
  }
  constexpr double kAboutWidthMm = 72.0;
  panel.height_mm =
      std::clamp(kAboutWidthMm * (high[1] - low[1]) / std::max(1e-6, high[0] - low[0]), 30.0, 80.0);
  panel.equal_scale = true;
  figure.panels.push_back(std::move(panel));
  figure.notes.push_back(std::string("Each estimate laid onto the truth by ") +
                         (any_by_first ? "its first position and its yaw" : view.alignment) + ".");
  AddNote(FailedNote(ExampleCells(all), "drawn as far as it went"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace

Figure TrajectoryTopFigure(const FigureInput& input) {
  return TrajectoryFigure(input, {0, 1, "x in G [m]", "y in G [m]"});
}

Figure TrajectorySideFigure(const FigureInput& input) {
  return TrajectoryFigure(input, {0, 2, "x in G [m]", "height z in G [m]"});
}

Figure Thesis82Figure(const FigureInput& input) {
  return TrajectoryFigure(input,
                          {0, 1, "x in G [m]", "y in G [m]", AlignmentMode::kSe3, "SE(3)", true});
}

}  // namespace duet
