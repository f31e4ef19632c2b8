#pragma once

#include "common/measurement/told_errors.h"
#include "experiments/simulation/simulator.h"

namespace duet::test {

/// Every block of the calibration estimated, with the default standard deviations.
inline CalibrationPriors EverythingEstimated(ImuFrame imu_frame = ImuFrame::kGyroscope) {
  CalibrationPriors priors;
  priors.imu_frame = imu_frame;
  for (BlockPrior* block : {&priors.T_g, &priors.T_s, &priors.T_a, &priors.p_CB, &priors.R_CB,
                            &priors.intrinsics, &priors.t_d, &priors.t_r}) {
    block->estimated = true;
  }
  priors.distortion.estimated = true;
  return priors;
}

/// A rolling shutter (20 ms) with a shifted clock (5 ms) that moves in all six degrees of freedom
/// after `rest_s` at rest; its calibration is told wrong by as much as `priors` say.
inline SimulationOptions CalibratedFlight(double duration_s, double rest_s,
                                          const CalibrationPriors& priors) {
  SimulationOptions options = SimulationPreset("excited");
  options.duration_s = duration_s;
  options.rest_s = rest_s;
  options.t_d_s = 0.005;
  options.t_r_s = 0.02;
  options.told_errors = ToldErrorsOfPriors(priors);
  options.told_imu_frame = priors.imu_frame;
  return options;
}

}  // namespace duet::test
