#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/estimator.h"
#include "common/dataset/recording.h"
#include "common/imu/imu_buffer.h"
#include "common/imu/nav_state.h"

namespace duet {

/// States with velocities and biases along a recording's motion, ascending in time: from its truth
/// where that has them (EuRoC's state_groundtruth_estimate0, a simulation's), else from its poses
/// and the IMU (FollowRecording). Throws InputError where there is no truth, or one that the IMU
/// cannot be laid along.
[[nodiscard]] std::vector<InertialState> StatesOfTruth(const Recording& recording);

/// The same from an estimate: a run's folder (its states.csv), a states.csv, or a trajectory in
/// EuRoC's or TUM's form. Throws InputError.
[[nodiscard]] std::vector<InertialState> StatesOfEstimate(const std::string& path,
                                                          const Recording& recording);

/// The state at `instant`: the nearest of `states` taken there by the IMU with its biases. Nothing
/// where the nearest is more than 60 ms away or the IMU does not cover the way.
[[nodiscard]] std::optional<InertialState> StateAt(const std::vector<InertialState>& states,
                                                   Timestamp instant, const ImuBuffer& imu,
                                                   const EstimatorSetup& setup);

}  // namespace duet
