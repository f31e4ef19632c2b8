#include "experiments/observability/observed_simulation.h"

#include "common/measurement/gauge.h"

namespace duet {

ObservedMotion ObserveSimulation(const SimulatedRecording& recording, const SharedOptions& shared,
                                 const Matrix15d& start_covariance) {
  ObservedMotion motion{.setup = MakeSetup(recording, shared),
                        .start_covariance = start_covariance,
                        .frames = recording.frames,
                        .states = {},
                        .imu = recording.imu};
  const Eigen::Quaterniond gauge =
      GaugeRotation(recording.true_rig, recording.told_rig, shared.calibration);
  motion.setup.rig = Reoriented(recording.true_rig, gauge);
  for (const TrackFrameSet& frames : recording.frames) {
    const Timestamp instant = frames.timestamp + ToNanoseconds(motion.setup.rig.t_d_s);
    motion.states.push_back(Reoriented(recording.TruthAt(instant), gauge));
  }
  // Readings are the same in any axes.
  for (const InertialState& state : recording.truth) {
    const Kinematics k = recording.trajectory->At(SecondsBetween(recording.start, state.instant));
    const ImuRates read =
        DistortRates({.omega_B = k.omega_B, .a_B = k.T_GB.R.conjugate() * (k.a_G - recording.g_G)},
                     recording.true_rig.imu, state.biases);
    motion.readings.push_back({state.instant, read.omega_B, read.a_B});
  }
  return motion;
}

}  // namespace duet
