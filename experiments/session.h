#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/dataset/recording.h"
#include "experiments/command_line.h"
#include "experiments/configuration.h"
#include "experiments/estimator_start.h"
#include "experiments/live_tracker.h"

namespace duet {

/// What the common flags ask for: the settings in force and the recording, read and checked.
struct Session {
  ConfigSources sources;
  Configuration configuration;
  Recording recording;
  std::string init = "auto";  ///< --init
  std::uint64_t seed = 0;     ///< --seed

  /// What estimators are told. Throws InputError where no estimator can start from it (CheckTold).
  [[nodiscard]] EstimatorSetup Setup() const { return SetupWith(configuration.shared); }
  [[nodiscard]] EstimatorSetup SetupWith(const SharedOptions& shared) const;
  /// The true poses (which there must be) in the axes that the setup's gauge ties the body to; the
  /// recording's calibration is taken as the true one.
  [[nodiscard]] std::vector<StampedPose> TruthFor(const EstimatorSetup& setup) const;
  /// The whole truth in these axes.
  [[nodiscard]] GroundTruth TruthStatesFor(const EstimatorSetup& setup) const;
  /// By --init. Throws InputError for a start from a truth that the recording does not have.
  [[nodiscard]] EstimatorStart Start() const { return StartWith(Setup()); }
  [[nodiscard]] EstimatorStart StartWith(const EstimatorSetup& setup) const;
};

/// Throws InputError where |t_d| or |t_r| is above its bound (shared.max_abs_*), which estimates
/// stay within: it is to hold what they start from.
void CheckTimeBounds(const RigCalibration& told, const SharedOptions& shared);

/// Reads configuration and recording. Tracks are taken from `tracks_folder` where it is not empty,
/// else what the recording has: images before tracks. Throws InputError.
[[nodiscard]] Session OpenSession(const CommandLine& line, const std::string& dataset,
                                  const std::string& tracks_folder);

/// The front end on the session's images (which it must have).
[[nodiscard]] std::unique_ptr<LiveTracker> StartTracking(const Session& session,
                                                         LiveTracker::Observer observer);

/// The session's tracks: recorded ones, or those of the front end on its images (with progress).
/// Empty after an interruption.
[[nodiscard]] std::vector<TrackFrameSet> TracksOf(const Session& session, bool quiet);

}  // namespace duet
