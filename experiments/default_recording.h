#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace duet {

/// Where what can be made again is kept: $DUET_CACHE, else $XDG_CACHE_HOME/duet, else
/// ~/.cache/duet.
[[nodiscard]] std::filesystem::path CacheFolder();

/// The sequence that `duet compare` runs on where no data set is named: 20 s of a flight like
/// EuRoC's V1_01_easy, rendered (preset easy_room). It is made on its first use and kept in
/// CacheFolder(), below a name that depends on its settings and on the program's commit.
struct DefaultRecording {
  std::filesystem::path folder;
  bool interrupted = false;  ///< while it was made; there is no folder then
};
[[nodiscard]] DefaultRecording FindOrMakeDefaultRecording(int cameras, std::uint64_t seed,
                                                          bool quiet);

}  // namespace duet
