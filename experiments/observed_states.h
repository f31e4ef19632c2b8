#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/estimator.h"
#include "common/dataset/recording.h"
#include "common/imu/imu_buffer.h"
#include "common/imu/nav_state.h"

namespace duet {

/// A motion with velocities and biases, at stamps that ascend.
struct KnownMotion {
  std::vector<InertialState> states;
  /// What the IMU would have read along it without noise; empty: not known.
  std::vector<ImuSample> readings = {};
};

/// From a recording's truth: a spline through its poses, with biases fitted to the IMU
/// (FollowRecording). Throws InputError where there is no truth, or one that the IMU cannot be laid
/// along.
[[nodiscard]] KnownMotion MotionOfTruth(const Recording& recording);

/// From an estimate: the states of a run's folder (its states.csv) or of a states.csv, as they are;
/// or a trajectory in EuRoC's or TUM's form, with velocities and biases as from a truth. An
/// estimate's steps are no motion, so that the IMU's own readings stand for the noiseless ones.
/// Throws InputError.
[[nodiscard]] KnownMotion MotionOfEstimate(const std::string& path, const Recording& recording);

/// The state at `instant`: the nearest of `states` taken there by the IMU with its biases. Nothing
/// where the nearest is more than 60 ms away or the IMU does not cover the way.
[[nodiscard]] std::optional<InertialState> StateAt(const std::vector<InertialState>& states,
                                                   Timestamp instant, const ImuBuffer& imu,
                                                   const EstimatorSetup& setup);

}  // namespace duet
