#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/simulation/recorded_motion.h"
#include "experiments/simulation/scene.h"
#include "experiments/simulation/simulator.h"
#include "experiments/simulation/world/world.h"

namespace duet {

/// Where, along what and with which sensors a recording is simulated: what the options name, made.
struct Scenario {
  std::shared_ptr<const Trajectory> trajectory;
  Timestamp start = 0;                 ///< the stamp of the trajectory's t = 0
  std::shared_ptr<const World> world;  ///< null: a box, tracks alone
  std::shared_ptr<const Scene> scene;  ///< where tracks have their points
  RigCalibration true_rig;
  ImuNoise noise;  ///< scaled
  double gravity_m_per_s2 = kStandardGravity;
  double imu_rate_hz = 0.0;
  double camera_rate_hz = 0.0;
  /// Of options.imu: its IMU, placed as the trajectory is.
  std::optional<RecordedMotion> recorded;
  /// For tables: what was simulated, and what of it was real.
  std::string label;
};

/// True for a file that is not also the name of a trajectory: names win.
[[nodiscard]] bool IsTrajectoryFile(const std::string& trajectory);

/// Sensors (options.sensors, else EuRoC's), motion (a named trajectory, a truth file or a recorded
/// IMU with its truth) and world. A truth's trajectory is moved, and turned by a quarter where that
/// fits better, into the middle of the world's flight space; where options.world_scale is 0 the
/// world is as much larger as that takes. `textures`: for rendering.
/// Throws InputError for what does not exist or does not fit.
[[nodiscard]] Scenario MakeScenario(const SimulationOptions& options, bool textures);

/// The same for a recorded IMU at hand.
[[nodiscard]] Scenario MakeScenario(const SimulationOptions& options, RecordedMotion motion,
                                    bool textures);
/// The same along a given motion, which is not moved; without textures.
[[nodiscard]] Scenario MakeScenario(const SimulationOptions& options,
                                    std::shared_ptr<const Trajectory> trajectory);

/// The true calibration of it alone: the sensors, without motion and world. Throws InputError for a
/// file of sensors that does not fit.
[[nodiscard]] RigCalibration TrueRigOf(const SimulationOptions& options);

/// The stamps of the frames. Throws InputError where the motion is too short for one.
[[nodiscard]] std::vector<Timestamp> FrameStamps(const Scenario& scenario,
                                                 const SimulationOptions& options);

/// InputError where a camera is inside something or outside of the world at a stamp.
void CheckIsFree(const Scenario& scenario, Timestamp stamp);

/// Simulate(options) in a scenario that was made from them.
[[nodiscard]] SimulatedRecording SimulateIn(const Scenario& scenario,
                                            const SimulationOptions& options);

}  // namespace duet
