#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/support/input_error.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

constexpr double kSettleSeconds = 2.0;
constexpr double kBinSigmas = 0.25;
constexpr int kBinsASide = 20;  // to 5 sigma; what is further counts in the last
constexpr double kLongestLagSeconds = 10.0;

/// Errors over their own standard deviations, one sequence a component.
struct NormalizedErrors {
  std::vector<double> t_s;
  std::array<std::vector<double>, 3> theta, p;
};

NormalizedErrors Normalize(const ErrorsOverTime& errors) {
  NormalizedErrors normalized;
  for (std::size_t i = 0; i < errors.t_s.size(); ++i) {
    if (errors.t_s[i] < errors.t_s.front() + kSettleSeconds) continue;
    normalized.t_s.push_back(errors.t_s[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      normalized.theta[k].push_back(errors.theta_deg[k][i] / errors.sigma_theta_deg[k][i]);
      normalized.p[k].push_back(errors.p_m[k][i] / errors.sigma_p_m[k][i]);
    }
  }
  return normalized;
}

std::map<std::string, std::vector<NormalizedErrors>> OfEstimators(
    const std::vector<FigureRun>& runs) {
  std::map<std::string, std::vector<NormalizedErrors>> of;
  for (const FigureRun& run : runs) {
    if (run.where.failed) continue;
    NormalizedErrors errors = Normalize(ErrorsOf(run));
    if (errors.t_s.size() > 1) of[run.where.estimator].push_back(std::move(errors));
  }
  if (of.empty()) {
    throw InputError(runs.front().folder.string() +
                     " and its like have no two states after the first 2 s");
  }
  return of;
}

double NormalDensity(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * 3.14159265358979323846);
}

// Of one sequence: sum over t of z(t) z(t + lag) over sum of z^2, for lags 0, 1, ...
bool AddAutocorrelation(const std::vector<double>& z, std::vector<double>* sums) {
  double squares = 0.0;
  for (const double value : z) squares += value * value;
  if (!(squares > 0.0)) return false;  // no error at all
  for (std::size_t lag = 0; lag < sums->size() && lag < z.size(); ++lag) {
    double products = 0.0;
    for (std::size_t i = 0; i + lag < z.size(); ++i) products += z[i] * z[i + lag];
    (*sums)[lag] += products / squares;
  }
  return true;
}

}  // namespace

Figure NormalizedErrorsFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = RunsOfFirstGroup(all);
  const std::vector<std::string> estimators = EstimatorsOf(runs);
  const auto errors = OfEstimators(runs);
  Figure figure;
  figure.sources = DescribeSources(runs);
  for (const bool position : {false, true}) {
    Panel panel{.x = {.label = "error over its standard deviation, x, y and z [-]",
                      .low = -5.0,
                      .high = 5.0},
                .y = {.label = std::string(position ? "position" : "orientation") + ", density [-]",
                      .low = 0.0},
                .height_mm = 34.0,
                .share_x = !position};
    std::vector<double> x, normal;
    for (int i = -100; i <= 100; ++i) {
      x.push_back(0.05 * i);
      normal.push_back(NormalDensity(x.back()));
    }
    panel.series.push_back(LineSeries("standard normal", "standard normal",
                                      {.colour = kGrey, .width_pt = 2.0}, x, normal));
    for (std::size_t n = 0; n < estimators.size(); ++n) {
      if (!errors.contains(estimators[n])) continue;
      std::vector<double> counts(2 * kBinsASide, 0.0);
      double total = 0.0;
      for (const NormalizedErrors& run : errors.at(estimators[n])) {
        for (const std::vector<double>& sequence : position ? run.p : run.theta) {
          for (const double z : sequence) {
            if (!std::isfinite(z)) continue;
            const int bin = std::clamp(static_cast<int>(std::floor(z / kBinSigmas)) + kBinsASide, 0,
                                       2 * kBinsASide - 1);
            counts[static_cast<std::size_t>(bin)] += 1.0;
            total += 1.0;
          }
        }
      }
      std::vector<double> steps_x, steps_y;
      for (int i = 0; i < 2 * kBinsASide; ++i) {
        const double density = counts[static_cast<std::size_t>(i)] / (total * kBinSigmas);
        for (const int end : {i, i + 1}) {
          steps_x.push_back(kBinSigmas * (end - kBinsASide));
          steps_y.push_back(density);
        }
      }
      panel.series.push_back(LineSeries(estimators[n], estimators[n],
                                        LookOfEstimator(estimators[n], n), steps_x, steps_y));
    }
    figure.panels.push_back(std::move(panel));
  }
  figure.notes = {
      "Errors of the state (records hold no innovations), after the first 2 s, all runs "
      "together; neighbouring instants depend on one another."};
  AddNote(FailedNote(runs, "left out"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

Figure WhitenessFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = RunsOfFirstGroup(all);
  const std::vector<std::string> estimators = EstimatorsOf(runs);
  const auto errors = OfEstimators(runs);
  Figure figure;
  figure.sources = DescribeSources(runs);
  for (const bool position : {false, true}) {
    Panel panel{.title = position ? "errors of the position" : "errors of the orientation",
                .x = {.label = "lag [s]", .low = 0.0},
                .y = {.label = "autocorrelation [-]", .high = 1.05},
                .height_mm = 34.0,
                .share_x = !position};
    double last_s = 0.0;
    for (std::size_t n = 0; n < estimators.size(); ++n) {
      if (!errors.contains(estimators[n])) continue;
      const std::vector<NormalizedErrors>& of = errors.at(estimators[n]);
      const std::vector<double>& t_s = of.front().t_s;
      const double step_s = (t_s.back() - t_s.front()) / static_cast<double>(t_s.size() - 1);
      const auto lags =
          std::min(t_s.size() / 2, static_cast<std::size_t>(kLongestLagSeconds / step_s) + 1);
      std::vector<double> sums(lags, 0.0);
      int sequences = 0;
      for (const NormalizedErrors& run : of) {
        for (const std::vector<double>& sequence : position ? run.p : run.theta) {
          if (AddAutocorrelation(sequence, &sums)) ++sequences;
        }
      }
      std::vector<double> lag_s;
      for (std::size_t i = 0; i < lags; ++i) {
        lag_s.push_back(static_cast<double>(i) * step_s);
        sums[i] /= std::max(1, sequences);
      }
      if (lags > 0) last_s = std::max(last_s, lag_s.back());
      panel.series.push_back(LineSeries(estimators[n] + (position ? " position" : " orientation"),
                                        estimators[n], LookOfEstimator(estimators[n], n), lag_s,
                                        sums));
    }
    panel.series.push_back(
        LineSeries("zero", "", {.colour = kBlack, .width_pt = 0.4}, {0.0, last_s}, {0.0, 0.0}));
    figure.panels.push_back(std::move(panel));
  }
  figure.notes = {
      "Of the state's errors over their standard deviations (records hold no "
      "innovations, which would be white): how far apart instants are independent. Mean "
      "over axes and runs, after the first 2 s."};
  AddNote(FailedNote(runs, "left out"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace duet
