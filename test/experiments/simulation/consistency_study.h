#pragma once

#include <string>
#include <vector>

#include "backends/factory.h"
#include "experiments/simulation/monte_carlo.h"

namespace duet {

/// The matched study of an estimator by name: Duet's own simulation (room_easy, 30 s, mono), the
/// estimator's defaults, start errors drawn from the start covariance.
inline MonteCarloResult RunStudy(const std::string& backend, const MonteCarloOptions& options) {
  const BackendOptions backends;
  return RunMonteCarlo(options, [&](const EstimatorSetup& setup) {
    return MakeEstimator(backend, setup, backends);
  });
}

}  // namespace duet
