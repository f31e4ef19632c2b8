#pragma once

#include <cstdint>
#include <filesystem>

namespace duet {

/// The sequence that `duet compare` makes where no data set is named: the simulator's easy flight
/// through a room, in ASL form, with tracks in place of images.
void WriteDefaultRecording(const std::filesystem::path& folder, int cameras, std::uint64_t seed);

}  // namespace duet
