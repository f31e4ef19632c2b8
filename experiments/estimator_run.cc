#include "experiments/estimator_run.h"

#include <memory>
#include <optional>

#include "common/support/logging.h"
#include "experiments/late_start.h"

namespace duet {
namespace {

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

}  // namespace

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

EstimatorRunResult RunEstimator(const EstimatorRunChoices& choices, Session* session,
                                RecordFolder* record) {
  EstimatorStart start = session->Start();
  const EstimatorSetup setup = session->Setup();
  const std::unique_ptr<Estimator> estimator =
      MakeEstimator(choices.backend, setup, session->configuration.backends);
  Manifest& manifest = record->manifest();
  manifest["dataset"] = DescribeRecording(session->recording);

  std::vector<TrackFrameSet> tracked;  // of a live run
  std::unique_ptr<LiveTracker> tracker;
  std::unique_ptr<FrameSource> replay;
  if (session->recording.vision == Vision::kImages) {
    tracker = StartTracking(*session, [&](const TrackFrameSet& tracks, const ImageSet& /*images*/) {
      tracked.push_back(tracks);
    });
  } else {
    manifest["tracks_sha256"] = HashTrackStream(session->recording.tracks.frames);
    replay = std::make_unique<TrackReplay>(std::move(session->recording.tracks.frames));
  }
  FrameSource& frames = tracker ? *tracker : *replay;

  EstimatorRunResult result;
  RunRecorder recorder(record->path(), estimator->layout(), setup.rig, setup.shared.time_bounds(),
                       choices.covariance);
  TimingLog timing;
  Progress progress(choices.backend, frames.count(), "frames", choices.quiet);
  result.outcome = RunEstimationLoop({.frames = frames,
                                      .imu = session->recording.imu,
                                      .imu_horizon_s = ImuHorizon(session->configuration.shared),
                                      .start = start,
                                      .estimator = *estimator,
                                      .recorder = recorder,
                                      .timing = timing,
                                      .progress = progress});
  recorder.Close();
  timing.Write(record->path() / "timing.csv");
  manifest["peak_memory_mb"] = PeakMemoryMb();
  if (tracker) {
    manifest["tracks_sha256"] =
        WriteTracks(record->path(), session->recording, tracked, session->sources.values());
    manifest["frontend"] = DescribeTracking(*tracker, tracked);
  }
  manifest["backend"] = choices.backend;
  manifest["init"] = session->init;
  manifest["seed"] = session->seed;
  result.summary = recorder.summary();
  const StartWait wait = WaitOf(result.summary, start.reason());
  manifest["outcome"] = DescribeOutcome(result.outcome, result.summary, wait);
  result.reason = manifest["outcome"]["reason"];
  progress.Finish(OutcomeName(result.outcome) +
                  (result.reason.empty() ? "" : ": " + result.reason));
  if (result.outcome == LoopOutcome::kFailed) {
    LOG(WARNING) << choices.backend << " failed: " << result.reason;
  }
  const std::optional<std::string> late =
      result.summary.first_instant ? LateStartWarning(wait) : std::nullopt;
  if (late) LOG(WARNING) << choices.backend << " " << *late;
  result.calibration = recorder.calibration().Numbers();
  for (const std::string& warning : CalibrationWarnings(result.calibration)) {
    LOG(WARNING) << choices.backend << ": " << warning;
  }
  return result;
}

}  // namespace duet
