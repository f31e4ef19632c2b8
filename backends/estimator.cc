#include "backends/estimator.h"

#include <algorithm>
#include <cmath>

namespace duet {

const char* EstimatorStatusName(EstimatorStatus status) {
  switch (status) {
    case EstimatorStatus::kInitializing:
      return "initializing";
    case EstimatorStatus::kTracking:
      return "tracking";
    case EstimatorStatus::kDeadReckoning:
      return "dead reckoning";
    case EstimatorStatus::kFailed:
      return "failed";
  }
  return "unknown";
}

void IncludeTold(const RigCalibration& told, SharedOptions* shared) {
  shared->max_abs_t_d_s = std::max(shared->max_abs_t_d_s, std::abs(told.t_d_s));
  shared->max_abs_t_r_s = std::max(shared->max_abs_t_r_s, std::abs(told.t_r_s));
}

double ImuHorizon(const SharedOptions& options) {
  return options.max_abs_t_d_s + 0.5 * options.max_abs_t_r_s;
}

}  // namespace duet
