#pragma once

#include <numbers>

namespace duet {

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

}  // namespace duet
