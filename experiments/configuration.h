#pragma once

#include <string>
#include <vector>

#include "backends/factory.h"
#include "backends/initialization/initialization.h"
#include "common/config/config_sources.h"
#include "experiments/evaluation_settings.h"
#include "frontend/frontend_options.h"

namespace duet {

/// Every setting of the program. Each group is documented field by field beside its struct.
struct Configuration {
  SharedOptions shared;
  FrontendOptions frontend;
  InitializationOptions initialization;
  BackendOptions backends;
  EvaluationSettings evaluation;

  /// Fills all groups and refuses keys that none of them has.
  void Read(ConfigSources* sources);
};

/// The settings read so far as a configuration file in which each key has its meaning, unit and
/// range above it; with defaults only, this is configs/estimators/default.yaml.
[[nodiscard]] std::string DocumentedYaml(const std::vector<ResolvedValue>& values);

}  // namespace duet
