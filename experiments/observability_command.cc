#include <gflags/gflags.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/measurement/gauge.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/text_file.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/log_capture.h"
#include "experiments/observability/observability_report.h"
#include "experiments/observed_states.h"
#include "experiments/progress.h"
#include "experiments/session.h"
#include "experiments/simulation/monte_carlo.h"

DECLARE_string(tracks);
DECLARE_string(estimate);

namespace duet {
namespace {

/// Thrown out of the computation when the user interrupts it.
struct Interruption {};

bool EstimatesAnything(const CalibrationPriors& priors) {
  return priors.T_g.estimated || priors.T_s.estimated || priors.T_a.estimated ||
         priors.p_CB.estimated || priors.R_CB.estimated || priors.intrinsics.estimated ||
         priors.distortion.estimated || priors.t_d.estimated || priors.t_r.estimated;
}

// All blocks; those that the gauge `camera` ties the axes to stay fixed.
void EstimateEverything(CalibrationPriors* priors) {
  for (BlockPrior* block :
       {&priors->T_g, &priors->T_s, &priors->T_a, &priors->p_CB, &priors->R_CB, &priors->intrinsics,
        static_cast<BlockPrior*>(&priors->distortion), &priors->t_d, &priors->t_r}) {
    block->estimated = true;
  }
  if (priors->imu_frame == ImuFrame::kCamera) priors->R_CB.estimated = false;
}

// Before the work: WriteTextFile would find out after it.
void CheckOut() {
  if (FLAGS_out.empty()) return;
  std::error_code ignored;
  if (std::filesystem::exists(FLAGS_out, ignored)) {
    throw InputError(FLAGS_out, 0, "", "exists; --out expects a file that does not exist yet");
  }
  const std::filesystem::path folder = std::filesystem::absolute(FLAGS_out).parent_path();
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw InputError(FLAGS_out, 0, "",
                     "lies in no folder; --out expects a file in one that exists");
  }
}

int RunObservability(const CommandLine& line) {
  CheckOut();
  LogCapture log(FLAGS_quiet);
  Session session = OpenSession(line, FLAGS_dataset, FLAGS_tracks);
  const Recording& recording = session.recording;
  EstimatorSetup setup = session.Setup();
  setup.rig = recording.rig;  // errors that are told on purpose are no part of the motion
  CalibrationPriors& priors = setup.shared.calibration;
  const bool everything = !EstimatesAnything(priors);
  if (everything) EstimateEverything(&priors);
  if (const std::string error = GaugeError(priors); !error.empty()) {
    throw InputError("shared.calibration.imu_frame: " + error);
  }

  KnownMotion known = FLAGS_estimate.empty() ? MotionOfTruth(recording)
                                             : MotionOfEstimate(FLAGS_estimate, recording);
  const std::string source = FLAGS_estimate.empty() ? "truth" : FLAGS_estimate;
  const std::vector<TrackFrameSet> tracked = TracksOf(session, FLAGS_quiet);
  if (Interrupted()) return kInterrupted;

  ImuBuffer imu;
  for (const ImuSample& sample : known.readings.empty() ? recording.imu : known.readings) {
    imu.Add(sample);
  }
  std::vector<TrackFrameSet> frames;
  std::vector<InertialState> states;
  for (const TrackFrameSet& frame : tracked) {
    const Timestamp instant = frame.timestamp + ToNanoseconds(setup.rig.t_d_s);
    const std::optional<InertialState> state = StateAt(known.states, instant, imu, setup);
    if (!state) continue;
    frames.push_back(frame);
    states.push_back(*state);
  }
  if (frames.size() < 2) {
    throw InputError(recording.folder.string() + ": " + std::to_string(frames.size()) + " of " +
                     std::to_string(tracked.size()) +
                     " frames lie within 60 ms of a state of the " + source +
                     "; expected at least 2");
  }
  if (frames.size() < tracked.size()) {
    LOG(WARNING) << tracked.size() - frames.size() << " of " << tracked.size()
                 << " frames have no state within 60 ms and are left out";
  }

  const FisherInformation information(
      {.setup = setup,
       .start_covariance = StartCovariance(session.configuration.initialization, 1.0),
       .frames = frames,
       .states = std::move(states),
       .imu = recording.imu,
       .readings = std::move(known.readings)});
  if (2 * information.not_triangulated() > information.tracks()) {
    LOG(WARNING) << information.not_triangulated() << " of " << information.tracks()
                 << " tracks have no point that fits the " << source
                 << ": no parallax, or states or calibration that do not fit the tracks";
  }
  ObservabilityOptions options;
  options.window_frames = session.configuration.backends.msckf.max_clones;
  options.min_observations = session.configuration.backends.msckf.min_observations;
  Progress progress("observability", 3 * information.frames(), "frames", FLAGS_quiet);
  Observability result;
  try {
    result = AnalyzeObservability(information, options, [&](int done) {
      progress.Update(done);
      if (Interrupted()) throw Interruption();
    });
  } catch (const Interruption&) {
    progress.Finish("interrupted");
    return kInterrupted;
  }
  progress.Finish();

  std::printf("%s, states of the %s, %s\n", recording.folder.string().c_str(),
              FLAGS_estimate.empty() ? "truth" : "estimate",
              everything ? "everything estimated (the configuration estimates nothing)"
                         : "estimated as configured");
  std::fputs(ObservabilityText(result).c_str(), stdout);
  if (!FLAGS_out.empty()) {
    nlohmann::ordered_json json = {{"dataset", recording.folder.string()},
                                   {"fingerprint", recording.fingerprint},
                                   {"states", source},
                                   {"frames_without_state", tracked.size() - frames.size()}};
    json.update(ObservabilityJson(result));
    WriteTextFile(FLAGS_out, json.dump(2) + "\n");
  }
  return kDone;
}

}  // namespace

Command ObservabilityCommand() {
  return {
      .name = "observability",
      .summary = "What a recording can calibrate: expected standard deviations, and what not.",
      .description =
          "Answers 'can my recording calibrate this?' before an estimator runs: for the "
          "recording's "
          "motion (its truth of 5 s or more, or --estimate: a run's folder or a trajectory) the "
          "information that "
          "IMU and tracks hold on each calibration state, the standard deviation to be expected at "
          "the end with tracks cut at the window (msckf.max_clones) and with whole ones, how it "
          "falls over time, and which combinations nothing tells apart (docs/observability.md). "
          "Priors and what is estimated are shared.calibration's; where that estimates nothing, "
          "everything is taken as estimated. A recording with images is tracked first; --tracks "
          "takes what duet track has written.",
      .example = "duet observability --dataset MH_01_easy --duration 60 --out mh01.json",
      .flags = {{.name = "dataset", .value = "DIR", .required = true},
                {.name = "out", .value = "FILE"},
                {.name = "estimate", .value = "DIR|FILE"},
                {.name = "tracks", .value = "DIR"},
                {.name = "config", .value = "FILE", .repeatable = true},
                {.name = "set", .value = "KEY=VALUE", .repeatable = true},
                {.name = "cameras", .value = "0|1|0,1", .choices = {"0", "1", "0,1"}},
                {.name = "start", .value = "S"},
                {.name = "duration", .value = "S"},
                {.name = "threads", .value = "N"},
                {.name = "seed", .value = "N"},
                {.name = "quiet"}},
      .run = RunObservability};
}

}  // namespace duet
