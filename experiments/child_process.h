#pragma once

#include <optional>
#include <string>
#include <vector>

namespace duet {

struct ChildResult {
  int exit_status = 0;  ///< where it ended by itself
  int signal = 0;       ///< that ended it; 0: none
};

/// Runs this program once more with these arguments, on one core where one is named, and waits.
/// Time and memory of a part of a comparison are measured like that: alone, in a process of its
/// own. The child's stdout is dropped, stderr is shared. An interruption is passed on to the child,
/// which finishes its frame; the child does not outlive this process.
[[nodiscard]] ChildResult RunSelf(const std::vector<std::string>& arguments,
                                  std::optional<int> core);

/// The last core that this process may run on (the first ones serve interrupts more often); nothing
/// where the system does not say.
[[nodiscard]] std::optional<int> CoreForMeasuring();

}  // namespace duet
