#pragma once

#include <string>
#include <vector>

namespace duet {

/// The commonest reason of failures, the first of equals; empty where there is none. Reasons that
/// differ in their numbers alone ("the velocity is 1.602 m/s", "... 1.9 m/s") are one reason: a
/// number in which they differ is written with its range, "the velocity is 1.602 to 1.9 m/s". Where
/// there are other reasons too, how many failures have this one follows in brackets.
[[nodiscard]] std::string CommonestReason(const std::vector<std::string>& reasons);

}  // namespace duet
