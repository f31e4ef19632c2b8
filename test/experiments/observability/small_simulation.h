#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/measurement/told_errors.h"
#include "experiments/observability/fisher_information.h"
#include "experiments/observability/observed_simulation.h"
#include "experiments/simulation/monte_carlo.h"
#include "experiments/simulation/simulator.h"
#include "experiments/simulation/trajectory_library.h"

namespace duet {

/// Everything estimated.
inline CalibrationPriors AllEstimated() {
  CalibrationPriors priors;
  for (BlockPrior* block :
       {&priors.T_g, &priors.T_s, &priors.T_a, &priors.p_CB, &priors.R_CB, &priors.intrinsics,
        static_cast<BlockPrior*>(&priors.distortion), &priors.t_d, &priors.t_r}) {
    block->estimated = true;
  }
  return priors;
}

/// A simulated recording without noise in its readings (estimators are told EuRoC's densities), as
/// the observability functions take it.
struct ObservedSimulation {
  SimulatedRecording recording;
  ObservedMotion motion;

  static SimulationOptions Options(double duration_s) {
    SimulationOptions options;
    options.duration_s = duration_s;
    options.imu_rate_hz = 100.0;
    options.camera_rate_hz = 5.0;
    options.max_tracks = 30;
    options.mean_track_frames = 15.0;
    options.t_r_s = 0.02;
    options.noise_scale = 0.0;
    return options;
  }

  ObservedSimulation(const SimulationOptions& options, const CalibrationPriors& priors)
      : ObservedSimulation(Simulate(options), priors) {}
  ObservedSimulation(const SimulationOptions& options, std::shared_ptr<const Trajectory> trajectory,
                     const CalibrationPriors& priors)
      : ObservedSimulation(Simulate(options, std::move(trajectory)), priors) {}

 private:
  ObservedSimulation(SimulatedRecording simulated, const CalibrationPriors& priors)
      : recording(std::move(simulated)), motion(Observe(recording, priors)) {}

  static ObservedMotion Observe(const SimulatedRecording& recording,
                                const CalibrationPriors& priors) {
    SharedOptions shared;
    shared.calibration = priors;
    ObservedMotion motion =
        ObserveSimulation(recording, shared, StartCovariance(InitializationOptions{}, 1.0));
    const SimulationOptions told;
    motion.setup.imu_noise = {.gyroscope_density = told.gyroscope_density,
                              .accelerometer_density = told.accelerometer_density,
                              .gyroscope_random_walk = told.gyroscope_random_walk,
                              .accelerometer_random_walk = told.accelerometer_random_walk};
    motion.setup.shared.pixel_noise_px = 1.0;
    return motion;
  }
};

}  // namespace duet
