#pragma once

#include <memory>
#include <string>

#include "experiments/simulation/world/world_library.h"

namespace duet {

// One function a world, each in a file of its own; MakeWorld chooses.

[[nodiscard]] std::shared_ptr<const World> MakeRoomWorld(const std::string& name,
                                                         const WorldOptions& options, bool bare);
[[nodiscard]] std::shared_ptr<const World> MakeHallWorld(const std::string& name,
                                                         const WorldOptions& options);
[[nodiscard]] std::shared_ptr<const World> MakeStreetWorld(const std::string& name,
                                                           const WorldOptions& options);

}  // namespace duet
