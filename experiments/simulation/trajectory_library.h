#pragma once

#include <memory>
#include <string>
#include <vector>

#include "experiments/simulation/trajectory.h"

namespace duet {

/// A trajectory that has a name.
struct NamedMotion {
  std::string name;
  std::string world;    ///< the world that it belongs to: room, hall or street
  std::string summary;  ///< one line
  /// From setting off to the end of its space; no longer ones are made. 0: any.
  double longest_s = 0.0;
};

/// Every trajectory that MakeTrajectory makes: flights and walks, the motions under which parts of
/// a state or calibration cannot be observed (Yang, Geneva, Zuo and Huang, "Online IMU intrinsic
/// calibration: is it necessary?", RSS 2020, and "Degenerate motion analysis for aided INS with
/// online spatial and temporal sensor calibration", RA-L 2019), and one like each sequence of EuRoC
/// (euroc_sequences.h).
[[nodiscard]] const std::vector<NamedMotion>& NamedMotions();
[[nodiscard]] std::vector<std::string> TrajectoryNames();
/// A line each: name, world, what it is and, where it ends, its longest duration.
[[nodiscard]] std::string NamedMotionsText();

/// Throws InputError for an unknown name.
[[nodiscard]] const NamedMotion& FindMotion(const std::string& name);

/// The motion over [0, duration_s]; the same motion for any duration. `rest_s` > 0: at rest for
/// that long first, then off within a second. Throws InputError for an unknown name and for a
/// duration beyond the motion's longest.
[[nodiscard]] std::shared_ptr<const Trajectory> MakeTrajectory(const std::string& name,
                                                               double duration_s, double rest_s);

}  // namespace duet
