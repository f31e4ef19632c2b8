#pragma once

#include <cmath>
#include <cstdint>

namespace duet {

/// Instants are integer nanoseconds of the IMU's clock. Differences are taken on the integers and
/// only then become seconds: stamps of 1.4e18 ns do not fit a double.
using Timestamp = std::int64_t;

/// end - start in seconds.
[[nodiscard]] inline double SecondsBetween(Timestamp start, Timestamp end) {
  return static_cast<double>(end - start) * 1e-9;
}

/// A duration in nanoseconds, rounded to the nearest (halves away from zero).
[[nodiscard]] inline Timestamp ToNanoseconds(double seconds) {
  return static_cast<Timestamp>(std::llround(seconds * 1e9));
}

}  // namespace duet
