#include "common/imu/motion_between_poses.h"

#include "common/imu/imu_buffer.h"
#include "common/imu/imu_delta.h"

namespace duet {

std::vector<std::optional<RelativeMotion>> MotionBetweenPoses(const std::vector<StampedPose>& poses,
                                                              const std::vector<ImuSample>& imu,
                                                              const ImuCalibration& calibration) {
  constexpr Timestamp kLongest = 100'000'000;
  if (poses.empty()) return {};
  ImuBuffer buffer;
  for (const ImuSample& sample : imu) buffer.Add(sample);
  std::vector<std::optional<RelativeMotion>> motion(poses.size() - 1);
  std::vector<ImuSample> readings;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Timestamp t0 = poses[i].timestamp;
    const Timestamp t1 = poses[i + 1].timestamp;
    if (!buffer.Covers(t0, t1) || t1 - t0 > kLongest) continue;
    buffer.Extract(t0, t1, &readings);
    const ImuDelta delta = IntegrateImu(
        readings, {}, calibration, {},
        {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false});
    motion[i] = RelativeMotion{.R = delta.R, .s = delta.s, .y = delta.y};
  }
  return motion;
}

}  // namespace duet
