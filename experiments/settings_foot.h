#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/config/config_sources.h"

namespace duet {

/// What stands in a table's foot of one estimator (DESIGN.md section 5.5): what was switched on,
/// from the settings, and how much was used, the mean over the records in `folders` (those without
/// features.csv are skipped; of a run that failed, how much it used tells nothing: leave it out).
[[nodiscard]] std::vector<std::pair<std::string, std::string>> SettingsFoot(
    const std::vector<ResolvedValue>& values, const std::string& estimator,
    const std::vector<std::filesystem::path>& folders);

}  // namespace duet
