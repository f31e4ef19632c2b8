#include "experiments/simulation/scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "common/dataset/rig_file.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "experiments/simulation/trajectory_library.h"
#include "experiments/simulation/world/world_library.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

// Late enough that a stamp kept in a double would show: 1.4e18 ns has a spacing of 256 ns there.
constexpr Timestamp kEpoch = 1'400'000'000'000'000'000;

ImuNoise Scaled(const ImuNoise& noise, double scale) {
  return {.gyroscope_density = scale * noise.gyroscope_density,
          .accelerometer_density = scale * noise.accelerometer_density,
          .gyroscope_random_walk = scale * noise.gyroscope_random_walk,
          .accelerometer_random_walk = scale * noise.accelerometer_random_walk};
}

void SetSensors(const SimulationOptions& options, Scenario* scenario) {
  scenario->gravity_m_per_s2 = options.gravity_m_per_s2;
  scenario->imu_rate_hz = options.imu_rate_hz;
  ImuNoise noise = {.gyroscope_density = options.gyroscope_density,
                    .accelerometer_density = options.accelerometer_density,
                    .gyroscope_random_walk = options.gyroscope_random_walk,
                    .accelerometer_random_walk = options.accelerometer_random_walk};
  if (options.true_rig) {
    scenario->true_rig = *options.true_rig;
  } else if (!options.sensors.empty()) {
    RigFile file = ReadRigFile(options.sensors);
    if (static_cast<int>(file.cameras.size()) < options.cameras) {
      throw InputError(options.sensors, 0, "",
                       "has one camera; expected two (simulation.cameras)");
    }
    file.cameras.resize(static_cast<std::size_t>(options.cameras));
    scenario->true_rig = MakeRig(file.imu.calibration, file.cameras, options.sensors);
    scenario->gravity_m_per_s2 = file.imu.gravity;
    if (file.imu.rate_hz > 0.0) scenario->imu_rate_hz = file.imu.rate_hz;
    noise = file.imu.noise;
  } else {
    scenario->true_rig = EurocLikeRig(options.cameras);
    scenario->true_rig.t_d_s = options.t_d_s;
    scenario->true_rig.t_r_s = options.t_r_s;
  }
  scenario->noise = Scaled(noise, options.noise_scale);
}

struct Box {
  Eigen::Vector3d low, high;
};

Box BoxOfPath(const Trajectory& trajectory, double duration_s) {
  Box box{trajectory.At(0.0).T_GB.p, trajectory.At(0.0).T_GB.p};
  for (double t_s = 0.0; t_s <= duration_s; t_s += 0.05) {
    const Eigen::Vector3d p = trajectory.At(t_s).T_GB.p;
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

struct Placement {
  double yaw_rad = 0.0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double scale = 1.0;  ///< by which the flight space must grow
};

// The middle of the path's box into the middle of the flight space, turned by a quarter where that
// needs less of it.
Placement Place(const Box& path, const FlightSpace& space) {
  const Eigen::Vector3d room = space.high - space.low;
  const Eigen::Vector3d size = path.high - path.low;
  const Eigen::Vector3d middle = 0.5 * (path.low + path.high);
  Placement best;
  best.scale = 1e9;
  for (int quarter = 0; quarter < 2; ++quarter) {
    const Eigen::Vector3d turned =
        quarter == 0 ? size : Eigen::Vector3d(size.y(), size.x(), size.z());
    const double scale = std::max(1.0, turned.cwiseQuotient(room).maxCoeff());
    if (scale >= best.scale) continue;
    best.scale = scale;
    best.yaw_rad = 0.5 * std::numbers::pi * quarter;
    const Eigen::Vector3d middle_turned =
        quarter == 0 ? middle : Eigen::Vector3d(-middle.y(), middle.x(), middle.z());
    best.shift = 0.5 * scale * (space.low + space.high) - middle_turned;
  }
  return best;
}

void PlaceRecorded(const PlacedTrajectory& placed, RecordedMotion* motion) {
  for (InertialState& state : motion->states) {
    const Pose T_GB = placed.placement() * Pose{state.nav.R_GB, state.nav.p_GB};
    state.nav.R_GB = T_GB.R;
    state.nav.p_GB = T_GB.p;
    state.nav.v_GB = placed.placement().R * state.nav.v_GB;
  }
}

// Sets trajectory, start and recorded; what the path needs of the world's size.
double SetMotion(const SimulationOptions& options, Scenario* scenario) {
  std::shared_ptr<const Trajectory> recorded;
  if (!options.imu.empty()) {
    scenario->recorded = LoadRecordedMotion(options.imu);
    recorded = scenario->recorded->trajectory;
    scenario->start = scenario->recorded->start;
    scenario->noise = scenario->recorded->imu_sensor.noise;
    scenario->gravity_m_per_s2 = scenario->recorded->imu_sensor.gravity;
    scenario->true_rig.imu = scenario->recorded->imu_sensor.calibration;
    scenario->label = scenario->recorded->report.label;
  } else if (fs::exists(options.trajectory)) {
    const auto spline = SplineThroughFile(options.trajectory, {});
    recorded = spline;
    scenario->start = spline->spline().start();
    scenario->label = "simulated along " + fs::path(options.trajectory).filename().string();
  }
  if (recorded == nullptr) {
    const NamedMotion& motion = FindMotion(options.trajectory);
    double duration_s = options.duration_s + 2.0 * kImuMargin_s;
    if (options.duration_s <= 0.0) {
      if (motion.longest_s <= 0.0) {
        throw InputError("", 0, "duration_s",
                         "expected above 0 s: trajectory " + motion.name + " has no end");
      }
      duration_s = motion.longest_s;
    }
    scenario->trajectory = MakeTrajectory(options.trajectory, duration_s, options.rest_s);
    scenario->start = kEpoch;
    scenario->label = "simulated: " + options.trajectory;
    return 1.0;
  }
  if (options.world == kBoxWorld) {
    scenario->trajectory = recorded;
    return 1.0;
  }
  const double duration_s = options.duration_s > 0.0
                                ? std::min(recorded->duration_s(), options.duration_s)
                                : recorded->duration_s();
  const Placement placement =
      Place(BoxOfPath(*recorded, duration_s), FlightSpaceOf(options.world));
  const auto placed =
      std::make_shared<PlacedTrajectory>(recorded, placement.yaw_rad, placement.shift);
  scenario->trajectory = placed;
  if (scenario->recorded) PlaceRecorded(*placed, &*scenario->recorded);
  return placement.scale;
}

}  // namespace

Scenario MakeScenario(const SimulationOptions& options, bool textures) {
  if (options.cameras < 1 || options.cameras > 2) {
    throw InputError("", 0, "cameras", "expected 1 or 2");
  }
  if (options.world != kBoxWorld) CheckWorldName(options.world);
  Scenario scenario;
  SetSensors(options, &scenario);
  const double needed_scale = SetMotion(options, &scenario);
  if (options.world == kBoxWorld) {
    scenario.label += ", points on the walls of a box";
    return scenario;
  }
  if (options.world_scale > 0.0 && options.world_scale < needed_scale) {
    throw InputError("", 0, "world_scale",
                     "the path does not fit into " + options.world + ": expected at least " +
                         FormatNumber(std::ceil(100.0 * needed_scale) / 100.0) +
                         ", or 0 for a world as large as it takes");
  }
  // Whatever the path was placed for; a larger world has its middle elsewhere than its floor.
  const double scale = options.world_scale > 0.0 ? options.world_scale : needed_scale;
  scenario.world = MakeWorld(options.world, {.seed = static_cast<std::uint64_t>(options.seed),
                                             .textures = textures,
                                             .scale = scale,
                                             .moving_bodies = options.moving_bodies});
  scenario.label += ", world " + options.world;
  if (scale != 1.0) {
    scenario.label += " (x " + FormatNumber(std::round(100.0 * scale) / 100.0) + ")";
  }
  if (options.moving_bodies) scenario.label += " with moving bodies";
  return scenario;
}

}  // namespace duet
