#pragma once

#include <string>

#include "common/config/options.h"
#include "common/imu/nav_state.h"

namespace duet {

/// When a run counts as failed, the same for every estimator (configuration `shared.failure`):
/// beyond these bounds nothing that a rig does is estimated any more.
struct FailureRule {
  double max_velocity_m_per_s = 50.0;
  double max_b_g_rad_per_s = 1.0;
  double max_b_a_m_per_s2 = 5.0;
  double max_imu_outage_s = 1.0;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("max_velocity_m_per_s", &max_velocity_m_per_s,
            {.doc = "A faster state has failed.", .unit = "m/s", .min = 0.1});
    v.Field(
        "max_b_g_rad_per_s", &max_b_g_rad_per_s,
        {.doc = "A state with a larger gyroscope bias has failed.", .unit = "rad/s", .min = 1e-3});
    v.Field("max_b_a_m_per_s2", &max_b_a_m_per_s2,
            {.doc = "A state with a larger accelerometer bias has failed.",
             .unit = "m/s^2",
             .min = 1e-2});
    v.Field("max_imu_outage_s", &max_imu_outage_s,
            {.doc = "Frames that a gap in the IMU leaves out for longer end the run.",
             .unit = "s",
             .min = 0});
  }
};

/// Why a state has failed; empty where it has not.
[[nodiscard]] std::string FailureOf(const InertialState& state, const FailureRule& rule);

}  // namespace duet
