#include "experiments/late_start.h"

#include "common/support/numeric_text.h"

namespace duet {

std::optional<std::string> LateStartWarning(const StartWait& wait) {
  if (wait.frames_waited <= 0) return std::nullopt;
  const double share = static_cast<double>(wait.frames_waited) / wait.frames;
  if (wait.waited_s <= kLateStartSeconds && share <= kLateStartShare) return std::nullopt;
  return "started only after " + FormatFixed(wait.waited_s, 2) +
         " s: " + std::to_string(wait.frames_waited) + " of " + std::to_string(wait.frames) +
         " frames (" + FormatFixed(100.0 * share, 1) + " %) have no estimate; until then " +
         wait.missing;
}

}  // namespace duet
