#pragma once

#include <string>

namespace duet {

/// "TARGET.partial-<host>-<pid>": what is being written stands there until it is renamed, and says
/// whose it is (RemoveAbandonedPartials).
[[nodiscard]] std::string PartialName(const std::string& target);

}  // namespace duet
