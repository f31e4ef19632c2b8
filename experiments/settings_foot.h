#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/config/config_sources.h"

namespace duet {

/// What stands in a table's foot of one estimator (DESIGN.md section 5.5): what was switched on,
/// from the settings, and how much the run used, from its record `folder` (skipped where there is
/// none).
[[nodiscard]] std::vector<std::pair<std::string, std::string>> SettingsFoot(
    const std::vector<ResolvedValue>& values, const std::string& estimator,
    const std::filesystem::path& folder);

}  // namespace duet
