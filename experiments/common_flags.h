#pragma once

#include <gflags/gflags_declare.h>

#include <vector>

#include "experiments/command_line.h"
#include "experiments/configuration.h"

DECLARE_string(dataset);
DECLARE_string(out);
DECLARE_string(init);
DECLARE_string(cameras);
DECLARE_double(start);
DECLARE_double(duration);
DECLARE_string(alignment);
DECLARE_int32(threads);
DECLARE_uint64(seed);
DECLARE_bool(quiet);

namespace duet {

/// The flags that track, run and compare have alike. `dataset_required`: compare can do without.
[[nodiscard]] std::vector<FlagUse> CommonFlags(bool dataset_required);

/// Defaults < --config files < --set < flags that stand for a key (--threads, --alignment).
Configuration LoadConfiguration(const CommandLine& line, ConfigSources* sources);

/// The numbers of --cameras: 0, 1 or both. Throws InputError.
[[nodiscard]] std::vector<int> CamerasAsked();

}  // namespace duet
