#include "backends/factory.h"

#include "backends/msckf/msckf.h"
#include "backends/window/window_estimator.h"
#include "common/support/input_error.h"

namespace duet {

const std::vector<std::string>& EstimatorNames() {
  static const std::vector<std::string> names = {"msckf", "window"};
  return names;
}

std::unique_ptr<Estimator> MakeEstimator(const std::string& name, const EstimatorSetup& setup,
                                         const BackendOptions& options) {
  if (name == "msckf") return std::make_unique<Msckf>(setup, options.msckf);
  if (name == "window") return std::make_unique<WindowEstimator>(setup, options.window);
  throw InputError("unknown back end '" + name + "'; expected msckf or window");
}

}  // namespace duet
