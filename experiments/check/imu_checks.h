#pragma once

#include <vector>

#include "common/dataset/asl_sensors.h"
#include "common/geometry/se3.h"
#include "common/imu/imu_sample.h"
#include "experiments/check/finding.h"

namespace duet {

/// A time during which the rig does not move.
struct RestSpan {
  Timestamp start = 0;
  Timestamp end = 0;
};

/// Spans of at least 0.5 s at rest. From the poses where there are any: less than 5 mm and 0.5 deg
/// away from where it was. Else from the IMU's means (the halves of every half second differ by
/// less than 4 of their measured standard deviations, and the specific force is gravity's): which
/// can't tell rest from a smooth straight flight.
[[nodiscard]] std::vector<RestSpan> FindRest(const std::vector<ImuSample>& imu,
                                             const std::vector<StampedPose>& truth,
                                             double gravity_m_per_s2);

/// Saturation, the size of the specific force, rest at the start, and the noise at rest against the
/// told densities.
[[nodiscard]] Findings CheckImu(const std::vector<ImuSample>& imu, const ImuSensor& sensor,
                                const std::vector<RestSpan>& rest, bool rest_from_truth);

}  // namespace duet
