#pragma once

#include <memory>
#include <string>
#include <vector>

#include "experiments/simulation/world/world.h"

namespace duet {

/// How a world is made beyond its name.
struct WorldOptions {
  std::uint64_t seed = 1;      ///< of textures and furnishing
  bool textures = true;        ///< false: geometry alone (for simulated tracks; fast)
  double texel_m = 0.0;        ///< 0: the world's own
  bool moving_bodies = false;  ///< walkers and cars
};

/// room (9 x 8 x 3.2 m around the origin, as EuRoC's Vicon room), bare_room (the same with little
/// texture), hall (a machine hall), street (outdoors, facades on both sides).
[[nodiscard]] const std::vector<std::string>& WorldNames();

/// Deterministic: the same name and options make the same world. Throws InputError for an unknown
/// name.
[[nodiscard]] std::shared_ptr<const World> MakeWorld(const std::string& name,
                                                     const WorldOptions& options);

}  // namespace duet
