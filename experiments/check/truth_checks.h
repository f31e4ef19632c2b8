#pragma once

#include <vector>

#include "common/dataset/recording.h"
#include "experiments/check/finding.h"

namespace duet {

/// The truth: rate and gaps, jumps against the IMU, signs of quaternions, columns that are unknown,
/// velocities against positions; and the IMU against it: time shift and constant rotation of the
/// gyroscope, size and direction of gravity. Stamps in sentences count from `origin`.
[[nodiscard]] Findings CheckTruth(const Recording& recording, Timestamp origin);

}  // namespace duet
