#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/support/input_error.h"
#include "evaluation/chi_squared.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

constexpr double kConfidence = 0.95;
// Where the mean is so many times what is expected, the band would be a line on a linear axis.
constexpr double kLogarithmicFrom = 8.0;

// Of one estimator: at each frame that all of its runs have, the mean over the inputs that they ran
// on, of the mean over an input's runs: those share one draw of the noise.
struct MeanNees {
  std::vector<double> t_s;
  std::vector<double> mean;
  int runs = 0;
  int inputs = 0;
};

struct RunOnInput {
  std::string input;
  NeesRun nees;
};

bool HasNees(const RunOnInput& run) { return !run.nees.failed && !run.nees.samples.empty(); }

MeanNees MeanOverRuns(const std::vector<RunOnInput>& runs, NeesBlock block) {
  struct Sum {
    double sum = 0.0;  // each run with the weight that it has among those on its input
    int count = 0;
  };
  std::map<std::string, int> runs_on;
  for (const RunOnInput& run : runs) {
    if (HasNees(run)) ++runs_on[run.input];
  }
  std::map<Timestamp, Sum> at;
  MeanNees mean;
  mean.inputs = static_cast<int>(runs_on.size());
  Timestamp start = 0;
  for (const RunOnInput& on_input : runs) {
    if (!HasNees(on_input)) continue;
    const NeesRun& run = on_input.nees;
    const double weight = 1.0 / runs_on[on_input.input];
    start = mean.runs == 0 ? run.start : std::min(start, run.start);
    ++mean.runs;
    for (const NeesSample& sample : run.samples) {
      const std::optional<double>& value = sample.value[static_cast<std::size_t>(block)];
      if (!value) continue;
      Sum& sum = at[sample.timestamp];
      sum.sum += weight * *value;
      ++sum.count;
    }
  }
  for (const auto& [stamp, sum] : at) {
    if (sum.count != mean.runs) continue;
    mean.t_s.push_back(SecondsBetween(start, stamp));
    mean.mean.push_back(sum.sum / mean.inputs);
  }
  return mean;
}

}  // namespace

Figure NeesOverTimeFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = RunsOfFirstGroup(all);
  Figure figure;
  figure.sources = DescribeSources(runs);
  const std::vector<std::string> estimators = EstimatorsOf(runs);
  std::map<std::string, std::vector<RunOnInput>> nees;
  bool shared_input = false;
  for (const FigureRun& run : runs) {
    if (run.where.failed) continue;
    // Where the input is not known each run has its own.
    const std::string ran_on =
        run.where.stream_id.empty() ? run.folder.string() : run.where.stream_id;
    nees[run.where.estimator].push_back({ran_on, NeesOf(run)});
  }

  constexpr std::array<NeesBlock, 3> kBlocks = {NeesBlock::kPose, NeesBlock::kOrientation,
                                                NeesBlock::kPosition};
  for (std::size_t i = 0; i < kBlocks.size(); ++i) {
    const int dof = NeesBlockSize(kBlocks[i]);
    Panel panel{.x = {.label = "time after the first state [s]"},
                .y = {.label = std::string(NeesBlockName(kBlocks[i])) + " NEES [-]", .low = 0.0},
                .height_mm = 30.0,
                .share_x = i + 1 < kBlocks.size()};
    double end_s = 0.0;
    double highest = 0.0;
    std::vector<int> counts;
    for (std::size_t n = 0; n < estimators.size(); ++n) {
      const MeanNees mean = MeanOverRuns(nees[estimators[n]], kBlocks[i]);
      if (mean.t_s.empty()) continue;
      end_s = std::max(end_s, mean.t_s.back());
      highest = std::max(highest, *std::max_element(mean.mean.begin(), mean.mean.end()));
      counts.push_back(mean.inputs);
      shared_input = shared_input || mean.inputs < mean.runs;
      const std::string legend = estimators[n] + ", " + CountOfRuns(mean.runs);
      panel.series.push_back(LineSeries(estimators[n], legend, LookOfEstimator(estimators[n], n),
                                        mean.t_s, mean.mean));
    }
    if (counts.empty()) {
      throw InputError(runs.front().folder.string() + " and its like have no NEES to draw");
    }
    // Most often one band: all estimators have as many runs. Runs on one input are one draw.
    for (const int count : std::set<int>(counts.begin(), counts.end())) {
      const Band band = MeanChiSquaredBand(dof, count, kConfidence);
      const std::string of = shared_input
                                 ? std::to_string(count) + (count == 1 ? " input" : " inputs")
                                 : CountOfRuns(count);
      Series bars =
          BarSeries("band of " + of, "95 % band of " + of, {.colour = kGrey, .opacity = 0.3});
      AddBar(0.0, end_s, band.low, band.high, &bars);
      panel.series.insert(panel.series.begin(), std::move(bars));
    }
    panel.series.push_back(LineSeries("expected", "expected", {.colour = kBlack, .width_pt = 0.4},
                                      {0.0, end_s}, {1.0 * dof, 1.0 * dof}));
    if (highest > kLogarithmicFrom * dof) {
      panel.y.logarithmic = true;
      panel.y.low = 0.03 * dof;
    }
    figure.panels.push_back(std::move(panel));
  }
  figure.notes.push_back(
      "Mean over the runs at each frame, without alignment; a consistent estimator is within the "
      "band at 95 % of the frames (which depend on one another).");
  if (shared_input) {
    figure.notes.push_back(
        "Runs on one input share its noise: the band is of as many runs as there are inputs.");
  }
  AddNote(FailedNote(runs, "left out"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace duet
