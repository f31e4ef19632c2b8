#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "experiments/simulation/world/world.h"

namespace duet {

/// How a world is made beyond its name.
struct WorldOptions {
  std::uint64_t seed = 1;      ///< of textures and furnishing
  bool textures = true;        ///< false: geometry alone (for simulated tracks; fast)
  double texel_m = 0.0;        ///< of near surfaces, others in proportion; 0: the world's own
  bool moving_bodies = false;  ///< walkers and cars
  int threads = 1;             ///< for baking; any number gives the same bytes
};

/// room (9 x 8 x 3.2 m around the origin, as EuRoC's Vicon room), bare_room (the same with little
/// texture), hall (a machine hall), street (outdoors, facades on both sides).
[[nodiscard]] const std::vector<std::string>& WorldNames();

/// Deterministic: the same name and options make the same world. Throws InputError for an unknown
/// name.
[[nodiscard]] std::shared_ptr<const World> MakeWorld(const std::string& name,
                                                     const WorldOptions& options);

/// The box that a simulated flight may use: at any time everything of the world, moving bodies as
/// well, is at least kFlightMargin_m away. Throws InputError for an unknown name.
struct FlightSpace {
  Eigen::Vector3d low, high;  ///< m
};
inline constexpr double kFlightMargin_m = 0.3;
[[nodiscard]] FlightSpace FlightSpaceOf(const std::string& world_name);

}  // namespace duet
