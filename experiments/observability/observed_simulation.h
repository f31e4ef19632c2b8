#pragma once

#include "experiments/observability/fisher_information.h"
#include "experiments/simulation/simulator.h"

namespace duet {

/// A simulated recording as FisherInformation takes it: its true states, calibration and noiseless
/// readings, in the axes that the estimators' gauge ties the body to. What an estimator that is
/// told `shared` and starts with `start_covariance` can know of this recording, at best. Keeps
/// references to the recording's frames and IMU.
[[nodiscard]] ObservedMotion ObserveSimulation(const SimulatedRecording& recording,
                                               const SharedOptions& shared,
                                               const Matrix15d& start_covariance);

}  // namespace duet
