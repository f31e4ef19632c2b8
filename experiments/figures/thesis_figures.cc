#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/dataset/recording.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "evaluation/errors.h"
#include "experiments/figures/car_example.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

// An IMU at rest, motors on: its rates are spread less than this over half a second.
constexpr double kRestWindowSeconds = 0.5;
constexpr double kRestGyroSigma = 0.03;          // rad/s
constexpr double kRestAccelerometerSigma = 0.5;  // m/s^2
// And what it shows on the mean: no turn beyond a gyroscope's bias, and gravity with the
// accelerometer's.
constexpr double kRestRate = 0.15;            // rad/s
constexpr double kRestAccelerationOff = 1.0;  // m/s^2
constexpr double kGravity = 9.81;             // m/s^2
constexpr std::size_t kFewestAtRest = 100;
// As long as it rests it is as it was in the first window: its mean rate within a spread of it, and
// not twice as widely spread. (What sets off slowly passes the bounds above for seconds.)
constexpr double kLeastGyroSigma = 1e-4;  // rad/s, of a noiseless one
constexpr double kWiderSpread = 2.0;

Eigen::Vector3d MeanOf(const std::vector<ImuSample>& imu, std::size_t begin, std::size_t end,
                       Eigen::Vector3d ImuSample::*member) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = begin; i < end; ++i) {
    mean += imu[i].*member / static_cast<double>(end - begin);
  }
  return mean;
}

double SigmaAlong(const std::vector<ImuSample>& imu, std::size_t begin, std::size_t end,
                  Eigen::Vector3d ImuSample::*member) {
  const Eigen::Vector3d mean = MeanOf(imu, begin, end, member);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (std::size_t i = begin; i < end; ++i) squares += (imu[i].*member - mean).cwiseAbs2();
  return std::sqrt(squares.maxCoeff() / static_cast<double>(end - begin));
}

/// A window at rest: the mean rate and its spread.
struct RestWindow {
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  double sigma = 0.0;
};

std::optional<RestWindow> RestWindowAt(const std::vector<ImuSample>& imu, std::size_t begin,
                                       std::size_t end) {
  const RestWindow window = {MeanOf(imu, begin, end, &ImuSample::omega_m),
                             SigmaAlong(imu, begin, end, &ImuSample::omega_m)};
  const bool rests =
      window.sigma < kRestGyroSigma && window.rate.norm() < kRestRate &&
      SigmaAlong(imu, begin, end, &ImuSample::a_m) < kRestAccelerometerSigma &&
      std::abs(MeanOf(imu, begin, end, &ImuSample::a_m).norm() - kGravity) < kRestAccelerationOff;
  return rests ? std::optional(window) : std::nullopt;
}

bool IsOfTheSameRest(const RestWindow& window, const RestWindow& first) {
  const double sigma = std::max(first.sigma, kLeastGyroSigma);
  return (window.rate - first.rate).norm() < sigma && window.sigma < kWiderSpread * sigma;
}

// The longest run of windows at rest.
std::pair<std::size_t, std::size_t> LongestRest(const std::vector<ImuSample>& imu) {
  const double step_s = SecondsBetween(imu.front().timestamp, imu.back().timestamp) /
                        static_cast<double>(std::max<std::size_t>(1, imu.size() - 1));
  const auto window =
      std::max<std::size_t>(2, static_cast<std::size_t>(kRestWindowSeconds / step_s));
  std::pair<std::size_t, std::size_t> longest = {0, 0};
  std::size_t begin = 0;
  std::optional<RestWindow> first;
  for (std::size_t i = 0; i + window <= imu.size(); i += window) {
    const std::optional<RestWindow> here = RestWindowAt(imu, i, i + window);
    if (!here || !first || !IsOfTheSameRest(*here, *first)) {
      begin = i;
      first = here;
    }
    if (here && i + window - begin > longest.second - longest.first) longest = {begin, i + window};
  }
  return longest;
}

// Of a recording's folder, of duet allan's, or of what the first run ran on.
Recording ImuRecordingOf(const FigureInput& input, std::string* source) {
  RecordingOptions imu_alone;
  imu_alone.source = RecordingOptions::Source::kNone;
  imu_alone.check_coverage = false;
  if (input.folders.empty()) {
    throw InputError("", 0, "--runs", "expected a recording that begins at rest, or a run on one");
  }
  const std::filesystem::path folder = input.folders.front();
  std::filesystem::path dataset;
  if (std::filesystem::exists(folder / "mav0") || std::filesystem::exists(folder / "imu0")) {
    dataset = folder;
  } else if (std::filesystem::exists(folder / "allan.json")) {
    dataset = ReadJsonFile(folder / "allan.json").value("dataset", std::string());
  }
  if (!dataset.empty()) {
    RequireNoChoice(input.choice, "a recording");
    Recording recording = LoadRecording(dataset, imu_alone);
    *source = dataset.string() + " (" + recording.fingerprint.substr(0, 16) + ")";
    return recording;
  }
  const std::vector<FigureRun> runs = ExampleRuns(FindRuns(input));
  *source = DescribeSource(runs.front());
  return RecordingOf(runs.front());
}

std::string Scientific3(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

}  // namespace

Figure Thesis32Figure(const FigureInput& input) {
  std::string source;
  const Recording recording = ImuRecordingOf(input, &source);
  const auto [begin, end] = LongestRest(recording.imu);
  if (end - begin < kFewestAtRest) {
    throw InputError(recording.folder.string() + " does not rest: its longest rest has " +
                     std::to_string(end - begin) +
                     " samples (steady, hardly turning, gravity alone); expected " +
                     std::to_string(kFewestAtRest) + " or more");
  }
  Figure figure;
  figure.sources = {source};
  const char* axes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t i = begin; i < end; ++i) values.push_back(recording.imu[i].omega_m[axis]);
    double mean = 0.0;
    for (const double v : values) mean += v / static_cast<double>(values.size());
    double squares = 0.0;
    for (const double v : values) squares += (v - mean) * (v - mean);
    const double sigma = std::sqrt(squares / static_cast<double>(values.size() - 1));
    // Bins of 0.4 sigma out to 4 sigma; further samples count in the last.
    constexpr int kBins = 20;
    constexpr int kMiddle = kBins / 2;
    constexpr double kBin = 0.4;
    std::vector<double> counts(kBins, 0.0);
    for (const double v : values) {
      const int bin = static_cast<int>(std::floor((v - mean) / sigma / kBin)) + kMiddle;
      counts[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))] += 1.0;
    }
    Series bars = BarSeries(std::string("gyro ") + axes[axis], "samples",
                            {.colour = kSkyBlue, .opacity = 0.6});
    const double scale = 1.0 / (static_cast<double>(values.size()) * kBin * sigma);
    for (int i = 0; i < kBins; ++i) {
      const double from = mean + (i - kMiddle) * kBin * sigma;
      AddBar(from, from + kBin * sigma, 0.0, counts[static_cast<std::size_t>(i)] * scale, &bars);
    }
    std::vector<double> x, density;
    for (int i = -80; i <= 80; ++i) {
      const double z = 0.05 * i;
      x.push_back(mean + z * sigma);
      density.push_back(std::exp(-0.5 * z * z) / (std::sqrt(2.0 * 3.14159265358979323846) * sigma));
    }
    Panel panel{.x = {.label = std::string("angular rate about ") + axes[axis] + " [rad/s]"},
                .y = {.label = "density [1/(rad/s)]", .low = 0.0},
                .height_mm = 24.0};
    panel.series = {bars, LineSeries(std::string("normal ") + axes[axis], "normal fit",
                                     {.colour = kVermilion, .width_pt = 1.2}, x, density)};
    figure.panels.push_back(std::move(panel));
    figure.notes.push_back(std::string(axes[axis]) + ": mean " + Scientific3(mean) +
                           ", standard deviation " + Scientific3(sigma) + " rad/s");
  }
  figure.notes.push_back(
      std::to_string(end - begin) + " samples at rest, " +
      FormatFixed(SecondsBetween(recording.imu[begin].timestamp, recording.imu[end - 1].timestamp),
                  1) +
      " s.");
  return figure;
}

namespace {

const char* const kCarSource = "the car example of thesis 3.4 (experiments/figures/car_example.h)";

Panel CarErrorPanel(const std::vector<CarState>& states, int component, const char* label) {
  std::vector<double> t_s, error, low, high;
  for (const CarState& state : states) {
    t_s.push_back(state.t_s);
    error.push_back(state.truth[component] - state.estimate[component]);
    high.push_back(3.0 * std::sqrt(state.covariance(component, component)));
    low.push_back(-high.back());
  }
  Panel panel{.x = {.label = "time [s]"}, .y = {.label = label}, .height_mm = 32.0};
  const Look curve = LookOf(0);
  const Look bound = {.colour = kVermilion, .dash = kDashed, .width_pt = 0.8};
  panel.series.push_back(LineSeries("zero", "", {.colour = kBlack, .width_pt = 0.4},
                                    {t_s.front(), t_s.back()}, {0.0, 0.0}));
  panel.series.push_back(LineSeries("error", "error: true minus estimate", curve, t_s, error));
  panel.series.push_back(LineSeries("-3 sigma", "±3σ of the filter", bound, t_s, low));
  panel.series.push_back(LineSeries("+3 sigma", "", bound, t_s, high));
  return panel;
}

std::string CarNote() {
  const CarOptions options;
  return "Acceleration measured to " + FormatNumber(options.acceleration_sigma) +
         " m/s², velocity to " + FormatNumber(options.velocity_sigma) + " m/s, every " +
         FormatNumber(options.step_s) + " s; seed " + std::to_string(options.seed) + ".";
}

}  // namespace

Figure Thesis38Figure(const FigureInput& /*input*/) {
  std::vector<double> t_s, truth, estimate;
  for (const CarState& state : DriveCar({})) {
    t_s.push_back(state.t_s);
    truth.push_back(state.truth[0]);
    estimate.push_back(state.estimate[0]);
  }
  Panel panel{
      .x = {.label = "time [s]"}, .y = {.label = "position of the car [m]"}, .height_mm = 42.0};
  panel.series.push_back(
      LineSeries("truth", "truth", {.colour = kGrey, .width_pt = 1.8}, t_s, truth));
  panel.series.push_back(LineSeries("estimate", "Kalman filter", LookOf(0), t_s, estimate));
  Figure figure;
  figure.panels = {panel};
  figure.sources = {kCarSource};
  figure.notes = {CarNote()};
  return figure;
}

Figure Thesis39Figure(const FigureInput& /*input*/) {
  Figure figure;
  figure.panels = {CarErrorPanel(DriveCar({}), 0, "position error [m]")};
  figure.panels.front().height_mm = 42.0;
  figure.sources = {kCarSource};
  figure.notes = {"The position is not observable: its uncertainty grows without bound.",
                  CarNote()};
  return figure;
}

Figure Thesis310Figure(const FigureInput& /*input*/) {
  const std::vector<CarState> states = DriveCar({});
  Figure figure;
  figure.panels = {CarErrorPanel(states, 0, "position error [m]"),
                   CarErrorPanel(states, 1, "velocity error [m/s]")};
  figure.panels.front().share_x = true;
  figure.sources = {kCarSource};
  figure.notes = {"The velocity is observable and stays bounded, the position is not.", CarNote()};
  return figure;
}

Figure Thesis54Figure(const FigureInput& input) {
  double t_d_s = -0.012;
  double t_r_s = 0.025;
  double period_s = 0.05;
  int rows = 480;
  Figure figure;
  figure.sources = {"an example's times"};
  std::string drawn;
  if (input.folders.empty()) {
    RequireNoChoice(input.choice, "an example's times, as no --runs are given");
  } else {  // of a run: its last estimates, where it has some, else as told
    const FoundRuns all = FindRuns(input);
    const std::vector<FigureRun> runs = ExampleRuns(all);
    drawn = DrawnNote(all, {runs.front()});
    const Recording recording = RecordingOf(runs.front());
    const RecordTable states = ReadRecordTable(runs.front().folder / "states.csv");
    const std::vector<Timestamp> stamps = recording.FrameStamps();
    const auto last = [&](const char* name, double told) {
      const std::vector<double>* column = states.Find(name);
      return column == nullptr || column->empty() ? told : column->back();
    };
    t_d_s = last("t_d", recording.rig.t_d_s);
    t_r_s = last("t_r", recording.rig.t_r_s);
    if (stamps.size() > 1) {
      period_s =
          SecondsBetween(stamps.front(), stamps.back()) / static_cast<double>(stamps.size() - 1);
    }
    rows = recording.rig.readout_by_columns ? recording.rig.cameras.front().model.width_px()
                                            : recording.rig.cameras.front().model.height_px();
    figure.sources = {DescribeSource(runs.front())};
  }
  constexpr int kImages = 3;
  const double half = 0.5 * (rows - 1);
  Series stamps =
      SegmentSeries("stamps", "stamp t of the image", {.colour = kBlack, .dash = kDashed});
  Series readout = SegmentSeries("rows", "row k, taken at t + t_d + k t_r / N", LookOf(0));
  readout.look.width_pt = 1.6;
  Series middle = PointSeries("middle rows", "middle row, taken at t + t_d",
                              {.colour = kVermilion, .symbol = 1, .width_pt = 1.4}, {}, {});
  Series offset = SegmentSeries("t_d", "t_d", {.colour = kVermilion, .width_pt = 1.0});
  Series names = TextSeries("stamps");
  for (int i = 0; i < kImages; ++i) {
    const double t_ms = 1e3 * i * period_s;
    const double taken_ms = t_ms + 1e3 * t_d_s;
    const double reach_ms = 1e3 * half / rows * t_r_s;
    AddSegment(t_ms, -half, t_ms, half, &stamps);
    AddSegment(taken_ms - reach_ms, -half, taken_ms + reach_ms, half, &readout);
    AddSegment(t_ms, 0.0, taken_ms, 0.0, &offset);
    middle.columns[0].push_back(taken_ms);
    middle.columns[1].push_back(0.0);
    AddText(t_ms, 1.22 * half, "t" + std::to_string(i), &names);
  }
  const double low_ms = 1e3 * (std::min(0.0, t_d_s) - 0.6 * std::abs(t_r_s)) - 100.0 * period_s;
  const double high_ms =
      1e3 * ((kImages - 1) * period_s + std::max(0.0, t_d_s) + 0.6 * std::abs(t_r_s)) +
      100.0 * period_s;
  Panel panel{.x = {.label = "time of the IMU's clock [ms]", .low = low_ms, .high = high_ms},
              .y = {.label = "row k from the middle [px]", .low = -1.1 * half, .high = 1.4 * half},
              .height_mm = 42.0};
  panel.series = {readout, stamps, offset, middle, names};
  figure.panels = {panel};
  char text[128];
  std::snprintf(text, sizeof(text), "t_d = %.4g ms, t_r = %.4g ms, N = %d.", 1e3 * t_d_s,
                1e3 * t_r_s, rows);
  figure.notes = {text};
  AddNote(drawn, &figure);
  return figure;
}

Figure Thesis81Figure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  const std::vector<FigureRun> runs = ExampleRuns(all);
  Figure figure;
  figure.sources = DescribeSources(runs);
  const std::vector<Look> looks = LooksOf(runs);
  Panel position{.x = {.label = "time after the first state [s]"},
                 .y = {.label = "position error [m]", .low = 0.0},
                 .share_x = true};
  Panel orientation{.x = position.x, .y = {.label = "orientation error [deg]", .low = 0.0}};
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const std::vector<StampedPose> estimate = TrajectoryOf(runs[n]);
    if (estimate.empty()) continue;
    const Association association = Associate(TruthOf(runs[n]).poses, estimate, {});
    const AbsoluteErrors errors = ComputeAbsoluteErrors(association.pairs, AlignmentMode::kSe3);
    if (errors.position_series_m.empty()) continue;
    std::vector<double> t_s;
    for (const PosePair& pair : association.pairs) {
      t_s.push_back(SecondsBetween(association.pairs.front().timestamp, pair.timestamp));
    }
    const Look look = looks[n];
    Look rms = look;
    rms.width_pt = 0.6;
    rms.dash = kDotted;
    const auto add = [&](const std::vector<double>& series, double rmse, Panel* panel) {
      panel->series.push_back(LineSeries(runs[n].label, runs[n].label, look, t_s, series));
      panel->series.push_back(LineSeries(runs[n].label + " RMS", runs[n].label + ", RMS", rms,
                                         {0.0, t_s.back()}, {rmse, rmse}));
    };
    add(errors.position_series_m, errors.position_m.rmse, &position);
    add(errors.orientation_series_deg, errors.orientation_deg.rmse, &orientation);
    figure.notes.push_back(runs[n].label + ": RMS " + Scientific3(errors.position_m.rmse) + " m, " +
                           Scientific3(errors.orientation_deg.rmse) + " deg.");
  }
  if (position.series.empty()) {
    throw InputError(runs.front().folder.string() + " and its like have no aligned error to draw");
  }
  figure.panels = {position, orientation};
  figure.notes.push_back("After SE(3) alignment, as in table 8.1, on " + runs.front().where.stream +
                         ".");
  AddNote(FailedNote(ExampleCells(all), "drawn as far as it went"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace duet
