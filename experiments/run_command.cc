#include <gflags/gflags.h>

#include <cstdio>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/estimation_loop.h"
#include "experiments/exit_status.h"
#include "experiments/late_start.h"
#include "experiments/record_folder.h"
#include "experiments/session.h"

DEFINE_string(backend, "", "The estimator.");
DEFINE_string(tracks, "",
              "Folder that duet track has written: its track stream is used instead of images.");
DEFINE_bool(covariance, false,
            "Write covariance.csv too: each frame's covariance of the navigation state, the biases "
            "and the estimated calibration.");

namespace duet {
namespace {

const char* OutcomeName(LoopOutcome outcome) {
  switch (outcome) {
    case LoopOutcome::kDone:
      return "done";
    case LoopOutcome::kFailed:
      return "failed";
    case LoopOutcome::kInterrupted:
      return "interrupted";
  }
  return "unknown";
}

ExitStatus StatusOf(LoopOutcome outcome) {
  if (outcome == LoopOutcome::kInterrupted) return kInterrupted;
  return outcome == LoopOutcome::kFailed ? kEstimatorFailed : kDone;
}

StartWait WaitOf(const RunSummary& summary, const std::string& start_reason) {
  return {.frames_waited = summary.waiting,
          .frames = summary.frames,
          .waited_s = summary.waited_s,
          .missing = summary.first_instant && summary.waiting == 0 ? "" : start_reason};
}

Manifest DescribeOutcome(LoopOutcome outcome, const RunSummary& summary, const StartWait& wait) {
  Manifest manifest = {{"status", OutcomeName(outcome)},
                       {"reason", ""},
                       {"last_status", EstimatorStatusName(summary.last_status)},
                       {"frames", summary.frames},
                       {"waiting", wait.frames_waited},
                       {"waited_s", wait.waited_s},
                       {"waited_for", wait.missing},
                       {"tracking", summary.tracking},
                       {"dead_reckoned", summary.dead_reckoning},
                       {"skipped", summary.skipped}};
  if (outcome == LoopOutcome::kFailed) {
    manifest["reason"] =
        summary.failure.empty() ? "did not start: " + wait.missing : summary.failure;
  }
  if (summary.failure_instant) manifest["failed_at_ns"] = *summary.failure_instant;
  if (summary.first_instant) manifest["first_state_ns"] = *summary.first_instant;
  if (summary.last_instant) manifest["last_good_state_ns"] = *summary.last_instant;
  return manifest;
}

int RunRun(const CommandLine& line) {
  RequireAbsent(FLAGS_out);
  LogCapture log(FLAGS_quiet);
  Session session = OpenSession(line, FLAGS_dataset, FLAGS_tracks);
  EstimatorStart start = session.Start();
  const EstimatorSetup setup = session.Setup();
  const std::unique_ptr<Estimator> estimator =
      MakeEstimator(FLAGS_backend, setup, session.configuration.backends);
  RecordFolder record(FLAGS_out, line, log);
  Manifest& manifest = record.manifest();
  manifest["dataset"] = DescribeRecording(session.recording);

  std::vector<TrackFrameSet> tracked;  // of a live run
  std::unique_ptr<LiveTracker> tracker;
  std::unique_ptr<FrameSource> replay;
  if (session.recording.vision == Vision::kImages) {
    tracker = StartTracking(session, [&](const TrackFrameSet& tracks, const ImageSet& /*images*/) {
      tracked.push_back(tracks);
    });
  } else {
    manifest["tracks_sha256"] = HashTrackStream(session.recording.tracks.frames);
    replay = std::make_unique<TrackReplay>(std::move(session.recording.tracks.frames));
  }
  FrameSource& frames = tracker ? *tracker : *replay;

  RunRecorder recorder(record.path(), estimator->layout(), setup.rig, FLAGS_covariance);
  TimingLog timing;
  Progress progress(FLAGS_backend, frames.count(), "frames", FLAGS_quiet);
  const LoopOutcome outcome =
      RunEstimationLoop({.frames = frames,
                         .imu = session.recording.imu,
                         .imu_horizon_s = ImuHorizon(session.configuration.shared),
                         .start = start,
                         .estimator = *estimator,
                         .recorder = recorder,
                         .timing = timing,
                         .progress = progress});
  recorder.Close();
  timing.Write(record.path() / "timing.csv");
  manifest["peak_memory_mb"] = PeakMemoryMb();
  if (tracker) {
    manifest["tracks_sha256"] =
        WriteTracks(record.path(), session.recording, tracked, session.sources.values());
    manifest["frontend"] = DescribeTracking(*tracker, tracked);
  }
  manifest["backend"] = FLAGS_backend;
  manifest["init"] = FLAGS_init;
  manifest["seed"] = FLAGS_seed;
  const StartWait wait = WaitOf(recorder.summary(), start.reason());
  manifest["outcome"] = DescribeOutcome(outcome, recorder.summary(), wait);
  const std::string reason = manifest["outcome"]["reason"];
  progress.Finish(OutcomeName(outcome) + (reason.empty() ? "" : ": " + reason));
  if (outcome == LoopOutcome::kFailed) LOG(WARNING) << FLAGS_backend << " failed: " << reason;
  const std::optional<std::string> late =
      recorder.summary().first_instant ? LateStartWarning(wait) : std::nullopt;
  if (late) LOG(WARNING) << FLAGS_backend << " " << *late;
  const std::vector<CalibrationWatch::Number> calibration = recorder.calibration().Numbers();
  for (const std::string& warning : CalibrationWarnings(calibration)) {
    LOG(WARNING) << FLAGS_backend << ": " << warning;
  }
  record.Commit(session.sources);
  const RunSummary& summary = recorder.summary();
  const std::string waited =
      summary.waiting > 0 ? ", " + std::to_string(summary.waiting) + " waited for the start" : "";
  std::printf("%s: %s, %d of %d frames tracked%s%s%s\n", FLAGS_backend.c_str(),
              OutcomeName(outcome), summary.tracking, summary.frames, waited.c_str(),
              reason.empty() ? "" : "; ", reason.c_str());
  if (!calibration.empty()) std::fputs(CalibrationWatchText(calibration).c_str(), stdout);
  return StatusOf(outcome);
}

}  // namespace

Command RunCommand() {
  Command command = {
      .name = "run",
      .summary = "Runs one estimator over images or over a recorded track stream.",
      .description =
          "Runs one estimator over a recording and writes a run record: trajectory.tum, "
          "states.csv, "
          "features.csv, timing.csv, config.yaml, log.txt, manifest.json and, from images, the "
          "track stream. A recording without images brings its own tracks<k>/. Exit status 3 where "
          "the estimator failed; the record is written all the same and says why.",
      .example = "duet run --dataset MH_01_easy --backend msckf --init groundtruth --out run-mh01",
      .flags = CommonFlags(true),
      .run = RunRun};
  command.flags.insert(
      command.flags.begin() + 1,
      {.name = "backend", .value = "msckf|window", .required = true, .choices = EstimatorNames()});
  command.flags.push_back({.name = "tracks", .value = "DIR"});
  command.flags.push_back({.name = "covariance"});
  return command;
}

}  // namespace duet
