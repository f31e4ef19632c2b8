#pragma once

#include <optional>
#include <string>

namespace duet {

/// How long a run waited for its first state.
struct StartWait {
  int frames_waited = 0;
  int frames = 0;  ///< all, waited ones included
  /// From the first frame to the one that the run started at; to the last one where it did not.
  double waited_s = 0.0;
  std::string missing = {};  ///< until then, a sentence
};

/// A start is late after more than this, or after more than this share of the frames. What a run
/// that started late says of a recording must not be read without that.
inline constexpr double kLateStartSeconds = 5.0;
inline constexpr double kLateStartShare = 0.2;

/// "started only after 12.30 s, ..." for a late start, else nothing.
[[nodiscard]] std::optional<std::string> LateStartWarning(const StartWait& wait);

}  // namespace duet
