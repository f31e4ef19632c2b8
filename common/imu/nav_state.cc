#include "common/imu/nav_state.h"

namespace duet {

NavState BoxPlus(const NavState& x, const Vector9d& error) {
  return {BoxPlus(x.R_GB, error.head<3>()), x.p_GB + error.segment<3>(3), x.v_GB + error.tail<3>()};
}

Vector9d BoxMinus(const NavState& a, const NavState& b) {
  Vector9d error;
  error << BoxMinus(a.R_GB, b.R_GB), a.p_GB - b.p_GB, a.v_GB - b.v_GB;
  return error;
}

InertialState BoxPlus(const InertialState& x, const Vector15d& error) {
  InertialState result = x;
  result.nav = BoxPlus(x.nav, Vector9d(error.head<9>()));
  result.biases.b_g += error.segment<3>(9);
  result.biases.b_a += error.segment<3>(12);
  return result;
}

Vector15d BoxMinus(const InertialState& a, const InertialState& b) {
  Vector15d error;
  error << BoxMinus(a.nav, b.nav), a.biases.b_g - b.biases.b_g, a.biases.b_a - b.biases.b_a;
  return error;
}

}  // namespace duet
