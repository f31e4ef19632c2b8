#pragma once

namespace duet {

/// From here on the first SIGINT or SIGTERM only sets a flag that loops look at between frames; a
/// second one ends the program at once.
void InstallInterruptHandler();

[[nodiscard]] bool Interrupted();

}  // namespace duet
