#pragma once

#include <string>
#include <vector>

#include "backends/estimator.h"
#include "experiments/estimator_start.h"
#include "experiments/frame_source.h"
#include "experiments/progress.h"
#include "experiments/run_record.h"
#include "experiments/timing_log.h"

namespace duet {

enum class LoopOutcome { kDone, kFailed, kInterrupted };

/// Everything that one frame passes through.
struct LoopParts {
  FrameSource& frames;
  const std::vector<ImuSample>& imu;
  double imu_horizon_s;  ///< ImuHorizon(shared)
  EstimatorStart& start;
  Estimator& estimator;
  RunRecorder& recorder;
  TimingLog& timing;
  Progress& progress;
};

/// The loop that is the whole system: in order of time each IMU sample goes to the estimator, each
/// frame comes from the live tracker or the track log, goes to the estimator, and what it says goes
/// to the recorder. Ends after the last frame, when the estimator fails, or between two frames when
/// the program is interrupted.
[[nodiscard]] LoopOutcome RunEstimationLoop(const LoopParts& parts);

}  // namespace duet
