#pragma once

#include <Eigen/Core>

#include "common/support/timestamp.h"

namespace duet {

/// One reading: rates as measured, in B. omega_m [rad/s], a_m [m/s^2] (specific force).
struct ImuSample {
  Timestamp timestamp = 0;
  Eigen::Vector3d omega_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d a_m = Eigen::Vector3d::Zero();
};

}  // namespace duet
