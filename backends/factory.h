#pragma once

#include <memory>
#include <string>
#include <vector>

#include "backends/estimator.h"
#include "backends/msckf/msckf_options.h"
#include "backends/window/window_options.h"

namespace duet {

/// The options of every estimator, as they stand in a configuration.
struct BackendOptions {
  MsckfOptions msckf;
  WindowOptions window;
};

/// Names that MakeEstimator takes: "msckf", "window".
[[nodiscard]] const std::vector<std::string>& EstimatorNames();

/// A new estimator, not yet initialized. Throws InputError for an unknown name.
[[nodiscard]] std::unique_ptr<Estimator> MakeEstimator(const std::string& name,
                                                       const EstimatorSetup& setup,
                                                       const BackendOptions& options);

}  // namespace duet
