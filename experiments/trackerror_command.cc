#include <gflags/gflags.h>

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "common/dataset/recording.h"
#include "common/support/input_error.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/progress.h"
#include "experiments/record_folder.h"
#include "experiments/simulated_dataset.h"
#include "experiments/simulation/scenario.h"
#include "experiments/simulation/track_accuracy.h"

DECLARE_string(tracks);
DEFINE_bool(ignore_rolling_shutter, false,
            "Hold tracks against the middle row's pose: shows what that costs.");
DEFINE_double(edge_distance, 5.0, "Tracks this close to a depth edge are left out [px].");

namespace duet {
namespace {

nlohmann::ordered_json PixelErrorsJson(const ErrorSummary& errors) {
  return {{"count", errors.count}, {"rms_px", errors.rmse}, {"median_px", errors.median},
          {"p95_px", errors.p95},  {"p99_px", errors.p99},  {"max_px", errors.max}};
}

nlohmann::ordered_json ReportJson(const TrackAccuracyReport& report) {
  nlohmann::ordered_json json = {{"pairs", report.pairs},
                                 {"edge_share", report.edge_share},
                                 {"hidden_share", report.hidden_share},
                                 {"frame_to_frame", PixelErrorsJson(report.frame_to_frame)},
                                 {"drift", nlohmann::ordered_json::array()}};
  for (std::size_t age = 1; age < report.drift.size(); ++age) {
    if (report.drift[age].count == 0) continue;
    nlohmann::ordered_json entry = {{"age_frames", age}};
    entry.update(PixelErrorsJson(report.drift[age]));
    json["drift"].push_back(entry);
  }
  return json;
}

std::string ReportText(int camera, const TrackAccuracyReport& report) {
  const auto line = [](const char* what, const ErrorSummary& errors) {
    char text[200];
    std::snprintf(text, sizeof text, "  %-18s %8d  %8.3f  %8.3f  %8.3f  %8.3f\n", what,
                  errors.count, errors.rmse, errors.median, errors.p95, errors.max);
    return std::string(text);
  };
  char head[300];
  std::snprintf(head, sizeof head,
                "camera %d: %d pairs of observations; left out %.1f %% near depth edges, %.1f %% "
                "hidden or out of view\n  error [px]            count       RMS    median       "
                "p95       max\n",
                camera, report.pairs, 100.0 * report.edge_share, 100.0 * report.hidden_share);
  std::string text = head + line("frame to frame", report.frame_to_frame);
  for (const std::size_t age : {5U, 10U, 20U, 40U}) {
    if (age >= report.drift.size() || report.drift[age].count == 0) continue;
    text += line(("after " + std::to_string(age) + " frames").c_str(), report.drift[age]);
  }
  return text;
}

/// How many frames each track of a camera lasts.
ErrorSummary TrackLengths(const std::vector<TrackFrameSet>& frames, std::size_t camera) {
  std::map<std::uint64_t, int> lengths;
  for (const TrackFrameSet& set : frames) {
    for (const TrackObservation& each : set.frames[camera].observations) ++lengths[each.track_id];
  }
  std::vector<double> values;
  for (const auto& [id, length] : lengths) values.push_back(length);
  return Summarize(std::move(values));
}

int RunTrackError(const CommandLine& line) {
  if (!FLAGS_out.empty()) RequireAbsent(FLAGS_out);
  const SimulatedDatasetOptions simulation = ReadSimulationOf(FLAGS_dataset);
  if (simulation.simulation.world == kBoxWorld) {
    throw InputError(FLAGS_dataset, 0, "simulation.world",
                     "is a box; expected a data set in a world with surfaces");
  }
  RecordingOptions recording_options;
  recording_options.cameras = CamerasAsked();
  recording_options.source = RecordingOptions::Source::kTracks;
  if (line.Given("tracks")) recording_options.tracks_folder = FLAGS_tracks;
  const Recording recording = LoadRecording(FLAGS_dataset, recording_options);
  const Scenario scenario = MakeScenario(simulation.simulation, false);
  for (const int number : recording.camera_numbers) {
    if (number >= static_cast<int>(scenario.true_rig.cameras.size())) {
      throw InputError("", 0, "--cameras",
                       "the simulation has no camera " + std::to_string(number));
    }
  }
  const TrueCamera truth(scenario.true_rig, scenario.world, scenario.trajectory, scenario.start,
                         FLAGS_ignore_rolling_shutter ? TrueCamera::Shutter::kMiddleRow
                                                      : TrueCamera::Shutter::kAsItIs);
  std::string text = recording.label + "\n";
  nlohmann::ordered_json json = {{"dataset", FLAGS_dataset},
                                 {"label", recording.label},
                                 {"rolling_shutter_ignored", FLAGS_ignore_rolling_shutter},
                                 {"cameras", nlohmann::ordered_json::array()}};
  for (std::size_t k = 0; k < recording.camera_numbers.size(); ++k) {
    const int number = recording.camera_numbers[k];
    TrackAccuracyOptions options;
    options.edge_distance_px = FLAGS_edge_distance;
    TrackAccuracy accuracy(&truth, number, options);
    Progress progress("tracks", static_cast<std::int64_t>(recording.tracks.frames.size()), "frames",
                      FLAGS_quiet);
    std::int64_t done = 0;
    for (const TrackFrameSet& set : recording.tracks.frames) {
      TrackFrame frame = set.frames[k];
      frame.camera = number;  // of the rig that was simulated, not of those that are read
      accuracy.Add(frame);
      progress.Update(++done);
    }
    progress.Finish();
    const TrackAccuracyReport report = accuracy.Report();
    text += ReportText(number, report);
    const ErrorSummary lengths = TrackLengths(recording.tracks.frames, k);
    char line_text[200];
    std::snprintf(line_text, sizeof line_text,
                  "  %d tracks, of %.0f frames (median; quartiles %.0f and %.0f, mean %.1f, 95 %% "
                  "below %.0f)\n",
                  lengths.count, lengths.median, lengths.p25, lengths.p75, lengths.mean,
                  lengths.p95);
    text += line_text;
    json["cameras"].push_back({{"camera", number}});
    json["cameras"].back()["track_frames"] = {{"count", lengths.count}, {"mean", lengths.mean},
                                              {"p25", lengths.p25},     {"median", lengths.median},
                                              {"p75", lengths.p75},     {"p95", lengths.p95}};
    json["cameras"].back().update(ReportJson(report));
  }
  if (!FLAGS_out.empty()) {
    OutputFolder folder(FLAGS_out);
    WriteTextFile(folder.path() / "track_error.json", json.dump(2) + "\n");
    WriteTextFile(folder.path() / "track_error.txt", text);
    folder.Commit();
  }
  std::fputs(text.c_str(), stdout);
  return kDone;
}

}  // namespace

Command TrackErrorCommand() {
  return {
      .name = "trackerror",
      .summary = "How far tracks are from the truth of the simulated world that they were made in.",
      .description =
          "Holds the tracks of a simulated data set (its own, or with --tracks what duet track "
          "made "
          "of its images) against the true geometry: the surface point truly seen at a track's "
          "pixel in one frame, seen in the next, against the track's pixel there; and the drift "
          "from the first frame of each track, by age. Tracks near depth edges, where two surfaces "
          "share a patch, are left out and their share is told. --out writes the same as JSON.",
      .example = "duet trackerror --dataset sim7 --tracks sim7-tracks",
      .flags = {{.name = "dataset", .value = "DIR", .required = true},
                {.name = "tracks", .value = "DIR"},
                {.name = "out", .value = "DIR"},
                {.name = "cameras", .value = "0|1|0,1", .choices = {"0", "1", "0,1"}},
                {.name = "edge-distance", .value = "PX"},
                {.name = "ignore-rolling-shutter"},
                {.name = "quiet"}},
      .run = RunTrackError};
}

}  // namespace duet
