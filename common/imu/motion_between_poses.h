#pragma once

#include <optional>
#include <vector>

#include "common/geometry/pose_jumps.h"
#include "common/imu/imu_model.h"
#include "common/imu/imu_sample.h"

namespace duet {

/// What the IMU measured between neighbouring poses (strictly increasing stamps), without biases,
/// for FindPoseJumps: entry i from pose i to i + 1; nothing where the samples do not cover the
/// interval or it is longer than 0.1 s. One fewer than poses; none for no poses.
[[nodiscard]] std::vector<std::optional<RelativeMotion>> MotionBetweenPoses(
    const std::vector<StampedPose>& poses, const std::vector<ImuSample>& imu,
    const ImuCalibration& calibration);

}  // namespace duet
