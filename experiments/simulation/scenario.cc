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
  scenario->camera_rate_hz = options.camera_rate_hz;
  ImuNoise noise = {.gyroscope_density = options.gyroscope_density,
                    .accelerometer_density = options.accelerometer_density,
                    .gyroscope_random_walk = options.gyroscope_random_walk,
                    .accelerometer_random_walk = options.accelerometer_random_walk};
  if (options.true_rig) {
    scenario->true_rig = *options.true_rig;
  } else if (!options.sensors.empty()) {
    RigFile file = ReadRigFile(options.sensors);
    if (static_cast<int>(file.cameras.size()) < options.cameras) {
      throw InputError(options.sensors, 0, "", "has one camera; expected two (simulation.cameras)");
    }
    file.cameras.resize(static_cast<std::size_t>(options.cameras));
    scenario->true_rig = MakeRig(file.imu.calibration, file.cameras, options.sensors);
    scenario->gravity_m_per_s2 = file.imu.gravity;
    if (file.imu.rate_hz > 0.0) scenario->imu_rate_hz = file.imu.rate_hz;
    if (file.cameras.front().rate_hz > 0.0) {
      scenario->camera_rate_hz = file.cameras.front().rate_hz;
    }
    noise = file.imu.noise;
  } else {
    scenario->true_rig = EurocLikeRig(options.cameras);
    scenario->true_rig.t_d_s = options.t_d_s;
    scenario->true_rig.t_r_s = options.t_r_s;
  }
  scenario->noise = Scaled(noise, options.noise_scale);
  if (!(scenario->imu_rate_hz >= 10.0 && scenario->imu_rate_hz <= 20000.0) ||
      !(scenario->camera_rate_hz >= 1.0 && scenario->camera_rate_hz <= 200.0)) {
    throw InputError(options.sensors, 0, "rate_hz",
                     "expected an IMU of 10 to 20000 Hz and cameras of 1 to 200 Hz");
  }
  const RigCalibration& rig = scenario->true_rig;
  // Half an exposure of at most 0.1 s comes on top; all of it has to lie within the margin.
  constexpr double kLargestDelay_s = kImuMargin_s - 0.05;
  if (std::abs(rig.t_d_s) + 0.5 * std::abs(rig.t_r_s) > kLargestDelay_s) {
    throw InputError(
        options.sensors, 0, "time_offset_s, readout_time_s",
        "expected |t_d| + |t_r| / 2 of at most " + FormatNumber(kLargestDelay_s) + " s");
  }
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
  double world_scale = 1.0;
};

// The middle of the path's box into the middle of the flight space, turned by a quarter where that
// needs a smaller world.
Placement Place(const Box& path, const SimulationOptions& options) {
  const FlightSpace space = FlightSpaceOf(options.world);
  const Eigen::Vector3d room = space.high - space.low;
  const Eigen::Vector3d size = path.high - path.low;
  const Eigen::Vector3d turned_size(size.y(), size.x(), size.z());
  const double straight = size.cwiseQuotient(room).maxCoeff();
  const double turned = turned_size.cwiseQuotient(room).maxCoeff();
  const double needed = std::min(straight, turned);
  if (options.world_scale > 0.0 && options.world_scale < needed) {
    throw InputError("", 0, "world_scale",
                     "the path does not fit into " + options.world + ": expected at least " +
                         FormatNumber(std::ceil(100.0 * needed) / 100.0) +
                         ", or 0 for a world as large as it takes");
  }
  Placement placement;
  placement.world_scale = options.world_scale > 0.0 ? options.world_scale : std::max(1.0, needed);
  placement.yaw_rad = turned < straight ? 0.5 * std::numbers::pi : 0.0;
  const Eigen::Vector3d middle = 0.5 * (path.low + path.high);
  const Eigen::AngleAxisd yaw(placement.yaw_rad, Eigen::Vector3d::UnitZ());
  placement.shift = 0.5 * placement.world_scale * (space.low + space.high) - yaw * middle;
  return placement;
}

void PlaceRecorded(const PlacedTrajectory& placed, RecordedMotion* motion) {
  for (InertialState& state : motion->states) {
    const Pose T_GB = placed.placement() * Pose{state.nav.R_GB, state.nav.p_GB};
    state.nav.R_GB = T_GB.R;
    state.nav.p_GB = T_GB.p;
    state.nav.v_GB = placed.placement().R * state.nav.v_GB;
  }
}

// What a recorded IMU brings along.
void SetRecorded(RecordedMotion motion, Scenario* scenario) {
  scenario->trajectory = motion.trajectory;
  scenario->start = motion.start;
  scenario->noise = motion.imu_sensor.noise;
  scenario->gravity_m_per_s2 = motion.imu_sensor.gravity;
  if (motion.imu_sensor.rate_hz > 0.0) scenario->imu_rate_hz = motion.imu_sensor.rate_hz;
  scenario->true_rig.imu = motion.imu_sensor.calibration;
  scenario->label = motion.report.label;
  scenario->recorded = std::move(motion);
}

void SetNamedMotion(const SimulationOptions& options, Scenario* scenario) {
  const NamedMotion& motion = FindMotion(options.trajectory);
  if (options.duration_s <= 0.0 && motion.longest_s <= 0.0) {
    throw InputError("", 0, "duration_s",
                     "expected above 0 s: trajectory " + motion.name + " has no end");
  }
  const double duration_s =
      options.duration_s > 0.0 ? options.duration_s + 2.0 * kImuMargin_s : motion.longest_s;
  scenario->trajectory = MakeTrajectory(options.trajectory, duration_s, options.rest_s);
  scenario->start = kEpoch;
  scenario->label = "simulated: " + options.trajectory;
}

// Moves a truth's trajectory into the world; returns the world's scale.
double PlaceInWorld(const SimulationOptions& options, Scenario* scenario) {
  const double duration_s = scenario->trajectory->duration_s();
  const Placement placement =
      Place(BoxOfPath(*scenario->trajectory,
                      options.duration_s > 0.0
                          ? std::min(duration_s, options.duration_s + 2.0 * kImuMargin_s)
                          : duration_s),
            options);
  const auto placed =
      std::make_shared<PlacedTrajectory>(scenario->trajectory, placement.yaw_rad, placement.shift);
  scenario->trajectory = placed;
  if (scenario->recorded) PlaceRecorded(*placed, &*scenario->recorded);
  return placement.world_scale;
}

void SetWorld(const SimulationOptions& options, bool textures, double scale, Scenario* scenario) {
  if (options.world == kBoxWorld) {
    scenario->label += ", points on the walls of a box";
    return;
  }
  scenario->world = MakeWorld(options.world, {.seed = static_cast<std::uint64_t>(options.seed),
                                              .textures = textures,
                                              .moving_bodies = options.moving_bodies});
  if (scale != 1.0) scenario->world = std::make_shared<World>(scenario->world->Scaled(scale));
  scenario->scene = std::make_shared<WorldScene>(scenario->world);
  scenario->label += ", world " + options.world;
  if (scale != 1.0) {
    scenario->label += " x " + FormatNumber(std::round(100.0 * scale) / 100.0);
  }
  if (options.moving_bodies) scenario->label += ", moving bodies";
}

// A box 2 m around the path.
std::shared_ptr<const Scene> BoxAroundPath(const Trajectory& trajectory, double clutter_share) {
  const Box path = BoxOfPath(trajectory, trajectory.duration_s());
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(2.0);
  return std::make_shared<BoxScene>(path.low - margin, path.high + margin, clutter_share);
}

// A box like the walls around the flight space of a named motion's world.
std::shared_ptr<const Scene> BoxOfMotion(const std::string& name, double clutter_share) {
  const std::string& world = FindMotion(name).world;
  if (world == "room") {
    return std::make_shared<BoxScene>(Eigen::Vector3d(-4.5, -4.0, 0.0),
                                      Eigen::Vector3d(4.5, 4.0, 3.2), clutter_share);
  }
  const FlightSpace space = FlightSpaceOf(world);
  return std::make_shared<BoxScene>(Eigen::Vector3d(space.low.x() - 2.0, space.low.y() - 3.0, 0.0),
                                    Eigen::Vector3d(space.high + Eigen::Vector3d(2.0, 3.0, 3.0)),
                                    clutter_share);
}

// A truth's path is moved into its world; others are made for theirs.
void AddWorldAroundTruth(const SimulationOptions& options, bool textures, Scenario* scenario) {
  const bool has_world = options.world != kBoxWorld;
  SetWorld(options, textures, has_world ? PlaceInWorld(options, scenario) : 1.0, scenario);
  if (!has_world) scenario->scene = BoxAroundPath(*scenario->trajectory, options.clutter_share);
}

double ToldScale(const SimulationOptions& options) {
  return options.world_scale > 0.0 ? options.world_scale : 1.0;
}

}  // namespace

bool IsTrajectoryFile(const std::string& trajectory) {
  const std::vector<std::string> names = TrajectoryNames();
  return std::find(names.begin(), names.end(), trajectory) == names.end() &&
         fs::is_regular_file(trajectory);
}

RigCalibration TrueRigOf(const SimulationOptions& options) {
  Scenario scenario;
  SetSensors(options, &scenario);
  return scenario.true_rig;
}

Scenario MakeScenario(const SimulationOptions& options, bool textures) {
  if (!options.imu.empty()) {
    RecordedMotionOptions motion_options;
    motion_options.apply_time_shift = options.imu_apply_time_shift;
    motion_options.apply_rotation = options.imu_apply_rotation;
    return MakeScenario(options, LoadRecordedMotion(options.imu, motion_options), textures);
  }
  Scenario scenario;
  SetSensors(options, &scenario);
  if (IsTrajectoryFile(options.trajectory)) {
    const auto spline = SplineThroughFile(options.trajectory);
    scenario.trajectory = spline;
    scenario.start = spline->spline().start();
    scenario.label = "simulated along " + fs::path(options.trajectory).filename().string();
    AddWorldAroundTruth(options, textures, &scenario);
    return scenario;
  }
  SetNamedMotion(options, &scenario);
  SetWorld(options, textures, ToldScale(options), &scenario);
  if (!scenario.scene) scenario.scene = BoxOfMotion(options.trajectory, options.clutter_share);
  return scenario;
}

Scenario MakeScenario(const SimulationOptions& options, RecordedMotion motion, bool textures) {
  Scenario scenario;
  SetSensors(options, &scenario);
  SetRecorded(std::move(motion), &scenario);
  AddWorldAroundTruth(options, textures, &scenario);
  return scenario;
}

Scenario MakeScenario(const SimulationOptions& options,
                      std::shared_ptr<const Trajectory> trajectory) {
  Scenario scenario;
  SetSensors(options, &scenario);
  scenario.trajectory = std::move(trajectory);
  scenario.start = kEpoch;
  scenario.label = "simulated";
  SetWorld(options, false, ToldScale(options), &scenario);
  if (!scenario.scene) scenario.scene = BoxAroundPath(*scenario.trajectory, options.clutter_share);
  return scenario;
}

}  // namespace duet
