#include "backends/failure_rule.h"

namespace duet {
namespace {

std::string Beyond(const char* what, double value, const char* unit, const char* key) {
  return std::string(what) + " is " + std::to_string(value) + " " + unit +
         ", beyond shared.failure." + key;
}

}  // namespace

std::string FailureOf(const InertialState& state, const FailureRule& rule) {
  if (!state.nav.R_GB.coeffs().allFinite() || !state.nav.p_GB.allFinite() ||
      !state.nav.v_GB.allFinite() || !state.biases.b_g.allFinite() ||
      !state.biases.b_a.allFinite()) {
    return "the state is not finite";
  }
  if (const double v = state.nav.v_GB.norm(); v > rule.max_velocity_m_per_s) {
    return Beyond("the velocity", v, "m/s", "max_velocity_m_per_s");
  }
  if (const double b = state.biases.b_g.norm(); b > rule.max_b_g_rad_per_s) {
    return Beyond("the gyroscope's bias", b, "rad/s", "max_b_g_rad_per_s");
  }
  if (const double b = state.biases.b_a.norm(); b > rule.max_b_a_m_per_s2) {
    return Beyond("the accelerometer's bias", b, "m/s^2", "max_b_a_m_per_s2");
  }
  return "";
}

}  // namespace duet
