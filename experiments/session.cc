#include "experiments/session.h"

#include <cmath>
#include <utility>

#include "common/measurement/gauge.h"
#include "common/measurement/told_checks.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "experiments/common_flags.h"
#include "experiments/interrupt.h"
#include "experiments/progress.h"

namespace duet {

void CheckTimeBounds(const RigCalibration& told, const SharedOptions& shared) {
  const auto check = [](const std::string& name, double value_s, double bound_s) {
    if (std::abs(value_s) <= bound_s) return;
    throw InputError("shared.max_abs_" + name + "_s: is " + FormatNumber(bound_s) +
                     "; expected at least the told " + name + ", " + FormatNumber(value_s) + " s");
  };
  check("t_d", told.t_d_s, shared.max_abs_t_d_s);
  check("t_r", told.t_r_s, shared.max_abs_t_r_s);
}

EstimatorSetup Session::SetupWith(const SharedOptions& shared) const {
  EstimatorSetup setup{.rig = ToldRig(recording.rig, shared.calibration),
                       .imu_noise = shared.imu_noise_factors.Times(recording.imu_sensor.noise),
                       .g_G = recording.g_G(),
                       .shared = shared};
  CheckTold(setup.rig, shared.calibration);
  CheckTimeBounds(setup.rig, shared);
  return setup;
}

std::vector<StampedPose> Session::TruthFor(const EstimatorSetup& setup) const {
  const Eigen::Quaterniond gauge =
      GaugeRotation(recording.rig, setup.rig, setup.shared.calibration);
  std::vector<StampedPose> poses = recording.truth->poses;
  for (StampedPose& pose : poses) pose.T_GB.R = (pose.T_GB.R * gauge.conjugate()).normalized();
  return poses;
}

GroundTruth Session::TruthStatesFor(const EstimatorSetup& setup) const {
  GroundTruth truth = *recording.truth;
  truth.poses = TruthFor(setup);
  return truth;
}

EstimatorStart Session::StartWith(const EstimatorSetup& setup) const {
  const StartMode mode = init == "groundtruth" ? StartMode::kGroundTruth : StartMode::kRest;
  const bool from_truth = init == "groundtruth" || init == "drawn";
  if (from_truth && !recording.truth) {
    throw InputError("--init " + init + ": " + recording.folder.string() +
                     " has no ground truth (state_groundtruth_estimate0/data.csv)");
  }
  if (init == "drawn") {
    if (!recording.truth->has_velocities() || !recording.truth->has_biases()) {
      throw InputError(recording.truth_file, 0, "",
                       "has no velocities or no biases; --init drawn starts from them");
    }
    return {setup, configuration.initialization, TruthStatesFor(setup), seed};
  }
  return {mode, setup, configuration.initialization,
          mode == StartMode::kGroundTruth ? TruthFor(setup) : std::vector<StampedPose>(),
          recording.imu};
}

Session OpenSession(const CommandLine& line, const std::string& dataset,
                    const std::string& tracks_folder) {
  Session session;
  session.init = FLAGS_init;
  session.seed = FLAGS_seed;
  session.configuration = LoadConfiguration(line, &session.sources);
  RecordingOptions options;
  options.cameras = CamerasAsked();
  options.start_s = FLAGS_start;
  options.duration_s = FLAGS_duration;
  if (!tracks_folder.empty()) {
    options.source = RecordingOptions::Source::kTracks;
    options.tracks_folder = tracks_folder;
  }
  session.recording = LoadRecording(dataset, options);
  for (const std::string& warning : session.recording.warnings) LOG(WARNING) << warning;
  const Recording& recording = session.recording;
  LOG(INFO) << recording.folder.string() << ": " << recording.FrameStamps().size()
            << (recording.vision == Vision::kImages ? " stamps of images, " : " frames of tracks, ")
            << recording.rig.cameras.size() << " cameras, " << recording.imu.size()
            << " IMU samples, " << (recording.truth ? recording.truth->poses.size() : 0)
            << " true poses";
  return session;
}

std::unique_ptr<LiveTracker> StartTracking(const Session& session, LiveTracker::Observer observer) {
  std::vector<ImageFiles> files;
  for (const ImageStamp& stamp : session.recording.images) {
    files.push_back({stamp.timestamp, stamp.paths});
  }
  return std::make_unique<LiveTracker>(std::move(files), session.recording.rig,
                                       session.configuration.frontend,
                                       session.configuration.shared.max_tracks, session.seed,
                                       session.recording.imu, std::move(observer));
}

std::vector<TrackFrameSet> TracksOf(const Session& session, bool quiet) {
  if (session.recording.vision != Vision::kImages) return session.recording.tracks.frames;
  std::vector<TrackFrameSet> frames;
  const std::unique_ptr<LiveTracker> tracker = StartTracking(
      session,
      [&](const TrackFrameSet& tracks, const ImageSet& /*images*/) { frames.push_back(tracks); });
  Progress progress("tracking", tracker->count(), "frames", quiet);
  while (!Interrupted() && tracker->Next() != nullptr) {
    progress.Update(static_cast<std::int64_t>(frames.size()));
  }
  progress.Finish(Interrupted() ? "interrupted" : "");
  if (Interrupted()) frames.clear();
  return frames;
}

}  // namespace duet
