#pragma once

#include <string>
#include <variant>
#include <vector>

#include "backends/estimator.h"
#include "common/geometry/se3.h"
#include "common/imu/imu_buffer.h"

namespace duet {

/// The first state's uncertainty (1 sigma) and the settings of both ways to start; shared by all
/// estimators, which start from the very same InitialCondition.
struct InitializationOptions {
  double sigma_yaw_rad = 1e-4;
  double sigma_tilt_rad = 0.01;
  double sigma_position_m = 1e-4;
  double sigma_velocity_m_per_s = 0.05;
  double sigma_b_g_rad_per_s = 0.01;
  double sigma_b_a_m_per_s2 = 0.1;
  double drawn_error_scale = 1.0;
  double fit_half_width_s = 0.25;
  double rest_duration_s = 0.5;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("sigma_yaw_rad", &sigma_yaw_rad,
            {.doc = "First yaw (a gauge: small).", .unit = "rad", .min = 0});
    v.Field("sigma_tilt_rad", &sigma_tilt_rad,
            {.doc = "First roll and pitch.", .unit = "rad", .min = 0});
    v.Field("sigma_position_m", &sigma_position_m,
            {.doc = "First position (a gauge: small).", .unit = "m", .min = 0});
    v.Field("sigma_velocity_m_per_s", &sigma_velocity_m_per_s,
            {.doc = "First velocity.", .unit = "m/s", .min = 0});
    v.Field("sigma_b_g_rad_per_s", &sigma_b_g_rad_per_s,
            {.doc = "First gyroscope bias.", .unit = "rad/s", .min = 0});
    v.Field("sigma_b_a_m_per_s2", &sigma_b_a_m_per_s2,
            {.doc = "First accelerometer bias.", .unit = "m/s^2", .min = 0});
    v.Field("drawn_error_scale", &drawn_error_scale,
            {.doc = "A start that is drawn is off by this many times what sigma_* promise.",
             .min = 0,
             .max = 100});
    v.Field(
        "fit_half_width_s", &fit_half_width_s,
        {.doc = "Poses of the truth this far to either side give the first velocity and biases.",
         .unit = "s",
         .min = 0.05,
         .max = 5});
    v.Field(
        "rest_duration_s", &rest_duration_s,
        {.doc = "A start at rest needs this long at rest.", .unit = "s", .min = 0.1, .max = 30});
  }
};

/// Why there is no first state, in a sentence that says what was missing.
struct InitializationFailure {
  std::string reason;
};
using InitializationResult = std::variant<InitialCondition, InitializationFailure>;

/// Start at `instant` from poses of the truth alone: a fit of velocity and biases to the poses
/// within fit_half_width_s and the IMU between them, robust against jumps of the truth.
[[nodiscard]] InitializationResult InitializeFromPoses(const std::vector<StampedPose>& poses,
                                                       const ImuBuffer& imu, Timestamp instant,
                                                       const EstimatorSetup& setup,
                                                       const InitializationOptions& options);

/// Start at rest: collects frames and IMU until the rig has been at rest for rest_duration_s, then
/// gives gravity's direction (yaw 0, position 0), the gyro's bias and the accelerometer's offset
/// along gravity (7.3.3).
class RestInitializer {
 public:
  RestInitializer(const EstimatorSetup& setup, const InitializationOptions& options);

  /// The condition at this frame's instant (stamp + told t_d) once the rig has been at rest up to
  /// it; else a failure that says what is missing so far. `imu` covers the past rest_duration_s.
  [[nodiscard]] InitializationResult Update(const TrackFrameSet& frames, const ImuBuffer& imu);

 private:
  EstimatorSetup setup_;
  InitializationOptions options_;
  StandstillDetector detector_;
};

}  // namespace duet
