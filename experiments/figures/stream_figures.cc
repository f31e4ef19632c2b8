#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "common/dataset/track_files.h"
#include "common/geometry/interpolation.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "evaluation/statistics.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

constexpr int kMostBins = 40;
constexpr double kDegreesARadian = 180.0 / 3.14159265358979323846;

struct Stream {
  Recording recording;
  std::string sha256;
  std::string source;
  std::string drawn;  ///< DrawnNote of a study
};

// Of a recording's folder, or of what the first run ran on.
Stream StreamOf(const FigureInput& input) {
  Stream stream;
  if (input.folders.size() == 1 && (std::filesystem::exists(input.folders.front() / "mav0") ||
                                    std::filesystem::exists(input.folders.front() / "imu0"))) {
    RequireNoChoice(input.choice, "a recording");
    RecordingOptions options;
    options.source = RecordingOptions::Source::kTracks;
    options.check_coverage = false;
    stream.recording = LoadRecording(input.folders.front(), options);
    stream.source = input.folders.front().string();
  } else {
    const FoundRuns all = FindRuns(input);
    const std::vector<FigureRun> runs = ExampleRuns(all);
    stream.drawn = DrawnNote(all, runs);
    stream.recording = RecordingOf(runs.front());
    stream.source = DescribeSource(runs.front());
  }
  if (stream.recording.tracks.frames.empty()) {
    throw InputError(stream.recording.folder.string() +
                     " has no tracks; expected a simulated recording, or a run that tracked");
  }
  stream.sha256 = HashTrackStream(stream.recording.tracks.frames);
  return stream;
}

Figure HistogramFigure(const Stream& stream, const std::vector<double>& values, double bin,
                       const std::string& label, const std::string& what) {
  const ErrorSummary summary = Summarize(values);
  const int bins = static_cast<int>(std::floor(summary.max / bin)) + 1;
  std::vector<double> counts(static_cast<std::size_t>(bins), 0.0);
  for (const double value : values) counts[static_cast<std::size_t>(value / bin)] += 1.0;
  Panel panel{.x = {.label = label, .low = 0.0, .high = bins * bin},
              .y = {.label = "tracks [-]", .low = 0.0},
              .height_mm = 42.0};
  Series bars = BarSeries("tracks", "", {.colour = kBlue, .opacity = 0.6});
  double highest = 0.0;
  for (int i = 0; i < bins; ++i) {
    const double count = counts[static_cast<std::size_t>(i)];
    highest = std::max(highest, count);
    if (count > 0.0) AddBar(i * bin, (i + 1) * bin, 0.0, count, &bars);
  }
  panel.series.push_back(std::move(bars));
  panel.y.high = 1.06 * highest;
  const auto line = [&](const char* name, double at, Dash dash) {
    panel.series.push_back(LineSeries(name, name, {.colour = kVermilion, .dash = dash}, {at, at},
                                      {0.0, 1.06 * highest}));
  };
  line("median", summary.median, kSolid);
  line("p95", summary.p95, kDashed);
  Figure figure;
  figure.panels = {panel};
  figure.sources = {stream.source + ", tracks " + stream.sha256};
  char text[160];
  std::snprintf(text, sizeof(text), "%zu tracks; %s median %.3g, p95 %.3g, largest %.3g.",
                values.size(), what.c_str(), summary.median, summary.p95, summary.max);
  figure.notes = {text, "Stream " + stream.sha256.substr(0, 32) + "."};
  AddNote(stream.drawn, &figure);
  return figure;
}

// 1, 2 or 5 times a power of ten, so that there are at most kMostBins.
double RoundBin(double largest, double smallest_bin) {
  double bin = smallest_bin;
  for (int k = 0; largest / bin > kMostBins; ++k) bin *= k % 3 == 1 ? 2.5 : 2.0;
  return bin;
}

}  // namespace

Figure TrackLengthsFigure(const FigureInput& input) {
  const Stream stream = StreamOf(input);
  std::map<std::uint64_t, int> frames;
  for (const TrackFrameSet& set : stream.recording.tracks.frames) {
    std::vector<std::uint64_t> seen;
    for (const TrackFrame& frame : set.frames) {
      for (const TrackObservation& observation : frame.observations) {
        seen.push_back(observation.track_id);
      }
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (const std::uint64_t id : seen) ++frames[id];
  }
  std::vector<double> lengths;
  for (const auto& [id, count] : frames) lengths.push_back(count);
  if (lengths.empty()) throw InputError(stream.source + ": the stream has no track");
  const double bin = RoundBin(*std::max_element(lengths.begin(), lengths.end()), 1.0);
  return HistogramFigure(stream, lengths, bin, "length of a track [frames]", "length in frames,");
}

Figure ParallaxFigure(const FigureInput& input) {
  const Stream stream = StreamOf(input);
  const Recording& recording = stream.recording;
  if (!recording.truth) {
    throw InputError(recording.folder.string() +
                     " has no ground truth; parallax is what is left of a track's motion when the "
                     "true rotation is taken out");
  }
  // The ray of each track's first observation, and the largest angle of a later one to it, in G.
  struct Parallax {
    Eigen::Vector3d first_G;
    double largest_rad = 0.0;
    int observations = 1;
  };
  std::map<std::uint64_t, Parallax> of_track;
  for (const TrackFrameSet& set : recording.tracks.frames) {
    const Timestamp taken = set.timestamp + ToNanoseconds(recording.rig.t_d_s);
    const std::optional<Pose> T_GB = InterpolatePose(recording.truth->poses, taken, 0.06);
    if (!T_GB || set.frames.empty()) continue;
    const TrackFrame& frame = set.frames.front();  // one camera: a baseline of its own is no motion
    const CameraCalibration& camera = recording.rig.cameras.front();
    const Eigen::Quaterniond R_GC = T_GB->R * camera.R_CB.conjugate();
    for (const TrackObservation& observation : frame.observations) {
      const std::optional<Eigen::Vector3d> ray_C =
          camera.model.Unproject(Eigen::Vector2d(observation.u, observation.v));
      if (!ray_C) continue;
      const Eigen::Vector3d ray_G = R_GC * ray_C->normalized();
      const auto [entry, is_new] = of_track.try_emplace(observation.track_id, Parallax{ray_G});
      if (is_new) continue;
      Parallax& parallax = entry->second;
      ++parallax.observations;
      const double angle =
          std::atan2(parallax.first_G.cross(ray_G).norm(), parallax.first_G.dot(ray_G));
      parallax.largest_rad = std::max(parallax.largest_rad, angle);
    }
  }
  std::vector<double> degrees;
  for (const auto& [id, parallax] : of_track) {
    if (parallax.observations > 1) degrees.push_back(parallax.largest_rad * kDegreesARadian);
  }
  if (degrees.empty()) throw InputError(stream.source + ": no track was seen twice");
  const double bin = RoundBin(*std::max_element(degrees.begin(), degrees.end()), 1e-3);
  Figure figure = HistogramFigure(stream, degrees, bin, "largest parallax of a track [deg]",
                                  "parallax in degrees,");
  figure.notes.push_back(
      "Angle to the first ray of the track in G, by the true orientation; tracks seen twice or "
      "more.");
  return figure;
}

}  // namespace duet
