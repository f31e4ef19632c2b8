#include <algorithm>
#include <cstdio>
#include <map>

#include "common/support/input_error.h"
#include "evaluation/relative_errors.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

/// Of one estimator and length: what a box is drawn of.
struct LengthErrors {
  std::vector<RelativeErrors> of_runs;
};

// The estimators that ran on one stream with one seed share their segments.
std::vector<std::vector<FigureRun>> OnSameStream(const std::vector<FigureRun>& runs) {
  std::map<std::tuple<std::string, std::string, std::string, int>, std::vector<FigureRun>> groups;
  for (const FigureRun& run : runs) {
    if (run.where.failed) continue;
    const StudyRun& where = run.where;
    groups[{where.stream, where.setting, where.perturbation, where.seed}].push_back(run);
  }
  std::vector<std::vector<FigureRun>> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

/// A box from the quarter to the three quarters, with the median, and whiskers from p5 to p95.
struct Box {
  double p5, p25, median, p75, p95;
};

Box BoxOf(const ErrorSummary& errors) {
  return {errors.p5, errors.p25, errors.median, errors.p75, errors.p95};
}

Box BoxOfMedians(const std::vector<RelativeErrors>& runs, ErrorSummary RelativeErrors::*which) {
  std::vector<double> medians;
  for (const RelativeErrors& run : runs) medians.push_back((run.*which).median);
  return BoxOf(Summarize(medians));
}

std::string LengthText(double length_m) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g m", length_m);
  return text;
}

}  // namespace

Figure RelativeErrorsFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = RunsOfFirstGroup(all);
  const std::vector<std::string> estimators = EstimatorsOf(runs);
  std::map<double, std::map<std::string, LengthErrors>> errors;
  std::size_t groups = 0;
  for (const std::vector<FigureRun>& group : OnSameStream(runs)) {
    const std::vector<StampedPose> truth = TruthOf(group.front()).poses;
    std::vector<std::vector<PosePair>> pairs;
    for (const FigureRun& run : group) {
      pairs.push_back(Associate(truth, TrajectoryOf(run), {}).pairs);
    }
    const RelativeErrorReport report = ComputeRelativeErrors(truth, pairs, {});
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (const RelativeErrors& of_length : report.of_estimator[i]) {
        if (of_length.segments == 0) continue;
        errors[of_length.length_m][group[i].where.estimator].of_runs.push_back(of_length);
      }
    }
    ++groups;
  }
  if (errors.empty()) {
    throw InputError(runs.front().folder.string() +
                     " and its like have no segment of 0.5 m or more: a way too short");
  }

  Figure figure;
  figure.sources = DescribeSources(runs);
  Axis x{.label = "length of the segments, travelled by the truth",
         .low = -0.5,
         .high = static_cast<double>(errors.size()) - 0.5,
         .grid = false};
  for (const auto& [length, of_estimators] : errors) {
    x.ticks.emplace_back(static_cast<double>(x.ticks.size()), LengthText(length));
  }
  Panel translation{.x = x,
                    .y = {.label = "translation error [% of the way]", .low = 0.0},
                    .height_mm = 36.0,
                    .share_x = true};
  Panel rotation{.x = x, .y = {.label = "rotation error [deg]", .low = 0.0}, .height_mm = 36.0};
  const double slot = 0.8 / static_cast<double>(estimators.size());
  const bool single = groups == 1;
  for (Panel* panel : {&translation, &rotation}) {
    ErrorSummary RelativeErrors::*which = panel == &translation
                                              ? &RelativeErrors::translation_percent
                                              : &RelativeErrors::rotation_deg;
    for (std::size_t n = 0; n < estimators.size(); ++n) {
      Look look = LookOfEstimator(estimators[n], n);
      Series whiskers =
          SegmentSeries(estimators[n] + " p5 to p95", "", {.colour = look.colour, .width_pt = 0.7});
      look.opacity = 0.6;
      Series boxes = BarSeries(estimators[n] + " p25 to p75", estimators[n], look);
      Series medians =
          SegmentSeries(estimators[n] + " median", n + 1 == estimators.size() ? "median" : "",
                        {.colour = kBlack, .width_pt = 1.2});
      double at = -0.4 + (static_cast<double>(n) + 0.5) * slot;
      for (const auto& [length, of_estimators] : errors) {
        const double middle = at;
        at += 1.0;
        const auto found = of_estimators.find(estimators[n]);
        if (found == of_estimators.end()) continue;
        const std::vector<RelativeErrors>& of_runs = found->second.of_runs;
        const Box box = single ? BoxOf(of_runs.front().*which) : BoxOfMedians(of_runs, which);
        AddSegment(middle, box.p5, middle, box.p25, &whiskers);
        AddSegment(middle, box.p75, middle, box.p95, &whiskers);
        AddBar(middle - 0.4 * slot, middle + 0.4 * slot, box.p25, box.p75, &boxes);
        AddSegment(middle - 0.4 * slot, box.median, middle + 0.4 * slot, box.median, &medians);
      }
      for (Series* series : {&whiskers, &boxes, &medians}) panel->series.push_back(*series);
    }
  }
  figure.panels = {translation, rotation};
  figure.notes.push_back(single ? "Boxes over segments: p25 to p75, whiskers p5 to p95. Segments:"
                                : "Boxes over the runs of each one's median over its segments: "
                                  "p25 to p75, whiskers p5 to p95.");
  if (single) {
    std::string& note = figure.notes.back();
    for (const auto& [length, of_estimators] : errors) {
      note += " " + std::to_string(of_estimators.begin()->second.of_runs.front().segments) +
              " of " + LengthText(length) + (length == errors.rbegin()->first ? "." : ",");
    }
  }
  AddNote(FailedNote(runs, "left out"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace duet
