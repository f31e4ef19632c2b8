#pragma once

#include <string>

#include "experiments/session.h"
#include "experiments/simulation/monte_carlo.h"

namespace duet {

/// One estimator over a recording in memory, from its truth or at rest as the session says, with
/// these priors and the told calibration made wrong as they say. The recording's own calibration is
/// taken as the true one. NEES is left empty: a recording's truth is no measure of a covariance.
/// Errors are those that `duet compare` takes by the session's `evaluation:`.
/// A run that does not start, or whose poses can't be compared with the truth, counts as failed.
[[nodiscard]] MonteCarloRun RunRecorded(const Session& session,
                                        const std::vector<TrackFrameSet>& frames,
                                        const std::string& estimator_name,
                                        const CalibrationPriors& priors);

}  // namespace duet
