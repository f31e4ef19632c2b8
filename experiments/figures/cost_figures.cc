#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/config/yaml_map.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "evaluation/statistics.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"
#include "experiments/study/study_file.h"
#include "experiments/timing_log.h"

namespace duet {
namespace {

constexpr std::size_t kMostStages = 8;

using Timing = std::vector<std::pair<std::string, std::vector<double>>>;

Timing TimingOf(const FigureRun& run) {
  const std::filesystem::path file = run.folder / "timing.csv";
  return ReadTimingTable(ReadTextFile(file), file);
}

double MedianOf(std::vector<double> values) { return Summarize(std::move(values)).median; }

/// One setting of one estimator on one stream: medians over its seeds.
struct CostPoint {
  std::string setting;  ///< with the stream where there are several
  std::string stream;
  bool has_failed = false;  ///< a run of it: its medians are of those that did not
  double frame_ms = 0.0;
  double position_m = 0.0;
};

std::vector<CostPoint> CostPoints(const std::vector<FigureRun>& runs,
                                  const std::string& estimator) {
  struct Values {
    std::vector<double> frame_ms, position_m;
    bool has_failed = false;
  };
  using Key = std::pair<std::string, std::string>;
  std::vector<Key> order;
  std::map<Key, Values> of_setting;
  for (const FigureRun& run : runs) {
    if (run.where.estimator != estimator) continue;
    const Key key = {run.where.stream, run.where.setting};
    if (!of_setting.contains(key)) order.push_back(key);
    auto& [frame_ms, position_m, has_failed] = of_setting[key];
    has_failed = has_failed || run.where.failed;
    if (run.where.failed) continue;
    for (const auto& [column, values] : TimingOf(run)) {
      if (column == "estimator") frame_ms.push_back(MedianOf(values));
    }
    if (const RunRmse rmse = RmseOf(run); std::isfinite(rmse.position_m)) {
      position_m.push_back(rmse.position_m);
    }
  }
  std::vector<CostPoint> points;
  const bool one_stream = std::all_of(runs.begin(), runs.end(), [&](const FigureRun& run) {
    return run.where.stream == runs.front().where.stream;
  });
  for (const auto& [stream, setting] : order) {
    auto& [frame_ms, position_m, has_failed] = of_setting[{stream, setting}];
    if (frame_ms.empty() || position_m.empty()) continue;
    points.push_back({.setting = one_stream ? setting : setting + " on " + stream,
                      .stream = stream,
                      .has_failed = has_failed,
                      .frame_ms = MedianOf(frame_ms),
                      .position_m = MedianOf(position_m)});
  }
  return points;
}

/// Puts numbers beside points so that none lies on another or on a point.
class NumberPlacer {
 public:
  NumberPlacer(const Axis& x, const Axis& y, double width_mm, double height_mm)
      : x_(x), y_(y), width_mm_(width_mm), height_mm_(height_mm) {}

  void AddPoint(double x, double y) { taken_.emplace_back(XMm(x), YMm(y)); }
  /// What a number should not lie on either.
  void AddLine(double x0, double y0, double x1, double y1) {
    const double length = std::hypot(XMm(x1) - XMm(x0), YMm(y1) - YMm(y0));
    const int pieces = static_cast<int>(length / 1.5);
    for (int i = 1; i < pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      taken_.emplace_back(XMm(x0) + share * (XMm(x1) - XMm(x0)),
                          YMm(y0) + share * (YMm(y1) - YMm(y0)));
    }
  }

  // Where the number of the point at (x, y) goes, in the axes' units.
  std::pair<double, double> Place(double x, double y) {
    constexpr double kAway = 3.2;
    std::pair<double, double> best = {XMm(x), YMm(y) + kAway};
    double largest = -1.0;
    for (int k = 0; k < 8; ++k) {
      const double angle = (k * 0.25 + 0.5) * 3.14159265358979323846;  // above first
      const std::pair<double, double> there = {XMm(x) + kAway * std::cos(angle),
                                               YMm(y) + kAway * std::sin(angle)};
      double nearest = 3.0;
      for (const auto& [a, b] : taken_) {
        nearest = std::min(nearest, std::hypot(there.first - a, there.second - b));
      }
      if (nearest > largest + 0.3) {
        largest = nearest;
        best = there;
      }
    }
    taken_.push_back(best);
    return {std::pow(10.0, std::log10(*x_.low) + best.first / width_mm_ * Decades(x_)),
            std::pow(10.0, std::log10(*y_.low) + best.second / height_mm_ * Decades(y_))};
  }

 private:
  static double Decades(const Axis& axis) { return std::log10(*axis.high / *axis.low); }
  [[nodiscard]] double XMm(double x) const {
    return std::log10(x / *x_.low) / Decades(x_) * width_mm_;
  }
  [[nodiscard]] double YMm(double y) const {
    return std::log10(y / *y_.low) / Decades(y_) * height_mm_;
  }

  const Axis& x_;
  const Axis& y_;
  double width_mm_;
  double height_mm_;
  std::vector<std::pair<double, double>> taken_;
};

// The streams that may stand in one picture with the first: the same simulation but for how many
// features it shows.
std::set<std::string> StreamsWithFirst(const FigureRun& first) {
  std::set<std::string> names = {first.where.stream};
  const std::filesystem::path file = first.study / "study.yaml";
  if (first.study.empty() || !std::filesystem::exists(file)) return names;
  const auto settings_of = [](const StudyStream& stream) {
    std::map<std::string, std::string> settings = {
        {"simulate", stream.simulate},
        {"seed", stream.simulation_seed ? std::to_string(*stream.simulation_seed) : ""},
        {"jitter", FormatNumber(stream.jitter_px)},
        {"init", stream.init}};
    for (const StudyKey& key : stream.set) {
      if (key.key != "simulation.max_tracks") settings[key.key] = Describe(key.value);
    }
    return settings;
  };
  const std::vector<StudyStream> streams = ReadStudyFile(file, /*quick=*/false).streams;
  for (const StudyStream& stream : streams) {
    if (stream.name != first.where.stream || !stream.simulated()) continue;
    for (const StudyStream& other : streams) {
      if (settings_of(other) == settings_of(stream)) names.insert(other.name);
    }
  }
  return names;
}

// No other point costs less and is more accurate. Medians of survivors beat nobody.
bool OnFront(const CostPoint& point, const std::vector<CostPoint>& all) {
  if (point.has_failed) return false;
  return std::none_of(all.begin(), all.end(), [&point](const CostPoint& other) {
    return !other.has_failed && other.frame_ms <= point.frame_ms &&
           other.position_m <= point.position_m &&
           (other.frame_ms < point.frame_ms || other.position_m < point.position_m);
  });
}

Axis LogarithmicAxisAround(std::string label, double low, double high) {
  return {.label = std::move(label), .low = low / 1.5, .high = high * 1.5, .logarithmic = true};
}

}  // namespace

Figure CostAgainstAccuracyFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::set<std::string> streams = StreamsWithFirst(all.chosen.front());
  std::vector<FigureRun> runs;
  for (const FigureRun& run : all.chosen) {
    if (streams.contains(run.where.stream) &&
        run.where.perturbation == all.chosen.front().where.perturbation) {
      runs.push_back(run);
    }
  }
  RequireEachChosen(runs, all.choice);
  Figure figure;
  figure.sources = DescribeSources(runs);
  const std::vector<std::string> estimators = EstimatorsOf(runs);
  std::vector<std::vector<CostPoint>> points;
  double low[2] = {1e300, 1e300};
  double high[2] = {0.0, 0.0};
  for (const std::string& estimator : estimators) {
    points.push_back(CostPoints(runs, estimator));
    for (const CostPoint& point : points.back()) {
      low[0] = std::min(low[0], point.frame_ms);
      high[0] = std::max(high[0], point.frame_ms);
      low[1] = std::min(low[1], point.position_m);
      high[1] = std::max(high[1], point.position_m);
    }
  }
  if (high[0] <= 0.0) throw InputError(runs.front().folder.string() + " and its like have no run");
  Panel panel{.x = LogarithmicAxisAround("thread CPU time a frame, median [ms]", low[0], high[0]),
              .y = LogarithmicAxisAround("position RMSE, median [m]", low[1], high[1]),
              .height_mm = 55.0};
  std::vector<CostPoint> everything;
  for (const std::vector<CostPoint>& of : points) {
    everything.insert(everything.end(), of.begin(), of.end());
  }
  NumberPlacer placer(panel.x, panel.y, 70.0, panel.height_mm);
  for (const CostPoint& point : everything) placer.AddPoint(point.frame_ms, point.position_m);
  const auto place_of_stream = [&runs](const CostPoint& point) {
    return std::find_if(
               runs.begin(), runs.end(),
               [&point](const FigureRun& run) { return run.where.stream == point.stream; }) -
           runs.begin();
  };
  std::vector<std::string> settings;
  Series numbers = TextSeries("setting");
  Series front = PointSeries("front", "no point is cheaper and better",
                             {.colour = kBlack, .symbol = 4, .width_pt = 2.4}, {}, {});
  for (std::size_t n = 0; n < estimators.size(); ++n) {
    std::vector<CostPoint> sorted = points[n];
    std::sort(sorted.begin(), sorted.end(),
              [](const CostPoint& a, const CostPoint& b) { return a.frame_ms < b.frame_ms; });
    // A line joins the settings on one stream; streams as the study has them.
    std::stable_sort(sorted.begin(), sorted.end(), [&](const CostPoint& a, const CostPoint& b) {
      return place_of_stream(a) < place_of_stream(b);
    });
    std::vector<double> line_x, line_y;
    std::vector<double> x, y;
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      if (sorted[i].stream != sorted[i - 1].stream) continue;
      placer.AddLine(sorted[i - 1].frame_ms, sorted[i - 1].position_m, sorted[i].frame_ms,
                     sorted[i].position_m);
    }
    for (const CostPoint& point : sorted) {
      if (&point != &sorted.front() && point.stream != (&point - 1)->stream) {
        line_x.push_back(std::nan(""));
        line_y.push_back(std::nan(""));
      }
      line_x.push_back(point.frame_ms);
      line_y.push_back(point.position_m);
      x.push_back(point.frame_ms);
      y.push_back(point.position_m);
      if (std::find(settings.begin(), settings.end(), point.setting) == settings.end()) {
        settings.push_back(point.setting);
      }
      if (OnFront(point, everything)) {
        front.columns[0].push_back(point.frame_ms);
        front.columns[1].push_back(point.position_m);
      }
    }
    Look look = LookOfEstimator(estimators[n], n);
    look.width_pt = 0.6;
    panel.series.push_back(LineSeries(estimators[n] + " line", "", look, line_x, line_y));
    look.width_pt = 1.2;
    panel.series.push_back(PointSeries(estimators[n], estimators[n], look, x, y));
  }
  if (settings.size() > 1) {
    for (const std::vector<CostPoint>& of : points) {
      for (const CostPoint& point : of) {
        const auto at = placer.Place(point.frame_ms, point.position_m);
        const auto index =
            std::find(settings.begin(), settings.end(), point.setting) - settings.begin();
        AddText(at.first, at.second, std::to_string(index + 1), &numbers);
      }
    }
    std::string note = "Settings:";
    for (std::size_t i = 0; i < settings.size(); ++i) {
      note +=
          " " + std::to_string(i + 1) + ": " + settings[i] + (i + 1 < settings.size() ? "," : ".");
    }
    figure.notes.push_back(note);
  }
  panel.series.push_back(front);
  if (!numbers.texts.empty()) panel.series.push_back(numbers);
  figure.panels = {panel};
  figure.notes.push_back("Medians over the seeds; front end apart.");
  AddNote(FailedNote(runs, "left out of the medians, and such points are not compared"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

Figure TimeByStageFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = RunsOfFirstGroup(all);
  const std::vector<std::string> estimators = EstimatorsOf(runs);
  constexpr const char* kPrefix = "estimator.";
  // Frames of all runs of an estimator together; a frame without a stage spent none in it.
  std::map<std::string, std::vector<double>> frame_ms;
  std::map<std::string, std::map<std::string, double>> stage_ms;
  std::map<std::string, double> total;
  std::vector<std::string> stages;
  for (const FigureRun& run : runs) {
    if (!run.has_record()) continue;
    std::vector<double>& frames = frame_ms[run.where.estimator];
    for (const auto& [column, values] : TimingOf(run)) {
      if (column == "estimator") frames.insert(frames.end(), values.begin(), values.end());
      if (column.rfind(kPrefix, 0) != 0) continue;
      const std::string stage = column.substr(std::string(kPrefix).size());
      if (std::find(stages.begin(), stages.end(), stage) == stages.end()) stages.push_back(stage);
      for (const double value : values) stage_ms[run.where.estimator][stage] += value;
    }
  }
  for (const std::string& estimator : estimators) {
    const double frames = static_cast<double>(frame_ms[estimator].size());
    if (frames == 0.0) {
      throw InputError(runs.front().folder.string() + " and its like have no times in timing.csv");
    }
    for (auto& [stage, ms] : stage_ms[estimator]) {
      ms /= frames;
      total[stage] = std::max(total[stage], ms);
    }
  }
  // The most expensive stages of any estimator by name, the rest together.
  std::vector<std::string> largest = stages;
  std::stable_sort(largest.begin(), largest.end(),
                   [&](const std::string& a, const std::string& b) { return total[a] > total[b]; });
  if (largest.size() > kMostStages) largest.resize(kMostStages);
  std::vector<std::string> shown;
  for (const std::string& stage : stages) {
    if (std::find(largest.begin(), largest.end(), stage) != largest.end()) shown.push_back(stage);
  }

  Figure figure;
  figure.sources = DescribeSources(runs);
  Axis rows{.label = "",
            .low = -0.5,
            .high = static_cast<double>(estimators.size()) - 0.5,
            .grid = false};
  const auto row_of = [&](std::size_t n) { return static_cast<double>(estimators.size() - 1 - n); };
  for (std::size_t n = 0; n < estimators.size(); ++n) {
    rows.ticks.emplace_back(row_of(n), estimators[n]);
  }
  const double height_mm = 8.0 * static_cast<double>(estimators.size());
  Panel stacked{.x = {.label = "mean thread CPU time a frame [ms]", .low = 0.0},
                .y = rows,
                .height_mm = height_mm};
  std::vector<double> left(estimators.size(), 0.0);
  for (std::size_t k = 0; k <= shown.size(); ++k) {
    const bool rest = k == shown.size();
    Look look = LookOf(k);
    look.opacity = 0.8;
    look.pattern = k >= 5 ? static_cast<int>(k - 4) : 0;
    if (rest) look = {.colour = kGrey, .opacity = 0.25};
    Series bars =
        BarSeries(rest ? "everything else" : shown[k], rest ? "everything else" : shown[k], look);
    for (std::size_t n = 0; n < estimators.size(); ++n) {
      double ms = 0.0;
      if (rest) {
        double sum = 0.0;
        for (const double frame : frame_ms[estimators[n]]) sum += frame;
        ms = std::max(0.0, sum / static_cast<double>(frame_ms[estimators[n]].size()) - left[n]);
      } else if (const auto found = stage_ms[estimators[n]].find(shown[k]);
                 found != stage_ms[estimators[n]].end()) {
        ms = found->second;
      }
      if (ms <= 0.0) continue;
      AddBar(left[n], left[n] + ms, row_of(n) - 0.35, row_of(n) + 0.35, &bars);
      left[n] += ms;
    }
    if (!bars.columns[0].empty()) stacked.series.push_back(std::move(bars));
  }

  Panel distribution{.x = {.label = "thread CPU time a frame [ms]", .logarithmic = true},
                     .y = rows,
                     .height_mm = height_mm};
  struct Quantile {
    const char* name;
    double ErrorSummary::*member;
    int symbol;
  };
  Series spread = SegmentSeries("p50 to max", "", {.colour = kGrey, .width_pt = 0.8});
  std::vector<ErrorSummary> summaries;
  for (std::size_t n = 0; n < estimators.size(); ++n) {
    summaries.push_back(Summarize(frame_ms[estimators[n]]));
    AddSegment(summaries[n].median, row_of(n), summaries[n].max, row_of(n), &spread);
  }
  distribution.series.push_back(spread);
  for (const Quantile& quantile :
       {Quantile{"p50", &ErrorSummary::median, 0}, Quantile{"p95", &ErrorSummary::p95, 1},
        Quantile{"p99", &ErrorSummary::p99, 2}, Quantile{"max", &ErrorSummary::max, 3}}) {
    std::vector<double> x, y;
    for (std::size_t n = 0; n < estimators.size(); ++n) {
      x.push_back(summaries[n].*quantile.member);
      y.push_back(row_of(n));
    }
    distribution.series.push_back(
        PointSeries(quantile.name, quantile.name,
                    {.colour = kBlack, .symbol = quantile.symbol, .width_pt = 1.2}, x, y));
  }
  figure.panels = {stacked, distribution};
  std::string note = "Frames:";
  for (const std::string& estimator : estimators) {
    note += " " + std::to_string(frame_ms[estimator].size()) + " of " + estimator +
            (estimator == estimators.back() ? "." : ",");
  }
  figure.notes.push_back(note + " Front end apart.");
  AddNote(FailedNote(runs, "its frames as far as it went"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace duet
