#include <gflags/gflags.h>

#include <cstdio>

#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/estimator_run.h"
#include "experiments/exit_status.h"

DEFINE_string(backend, "", "The estimator.");
DEFINE_string(tracks, "",
              "Folder that duet track has written: its track stream is used instead of images.");
DEFINE_bool(covariance, false,
            "Write covariance.csv too: each frame's covariance of the navigation state, the biases "
            "and the estimated calibration.");

namespace duet {
namespace {

ExitStatus StatusOf(LoopOutcome outcome) {
  if (outcome == LoopOutcome::kInterrupted) return kInterrupted;
  return outcome == LoopOutcome::kFailed ? kEstimatorFailed : kDone;
}

int RunRun(const CommandLine& line) {
  RequireAbsent(FLAGS_out);
  LogCapture log(FLAGS_quiet);
  Session session = OpenSession(line, FLAGS_dataset, FLAGS_tracks);
  (void)session.Start();  // refuses a start that the recording does not allow, before the work
  RecordFolder record(FLAGS_out, line.text(), log);
  const EstimatorRunResult result =
      RunEstimator({.backend = FLAGS_backend, .covariance = FLAGS_covariance, .quiet = FLAGS_quiet},
                   &session, &record);
  record.Commit(session.sources);
  const RunSummary& summary = result.summary;
  const std::string waited =
      summary.waiting > 0 ? ", " + std::to_string(summary.waiting) + " waited for the start" : "";
  std::printf("%s: %s, %d of %d frames tracked%s%s%s\n", FLAGS_backend.c_str(),
              OutcomeName(result.outcome), summary.tracking, summary.frames, waited.c_str(),
              result.reason.empty() ? "" : "; ", result.reason.c_str());
  if (!result.calibration.empty()) {
    std::fputs(CalibrationWatchText(result.calibration).c_str(), stdout);
  }
  return StatusOf(result.outcome);
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
