#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/imu/imu_model.h"

namespace duet {

/// The three integrals of 6.15 to 6.17: rotation, and the first and second integral of the rotated
/// specific force, all in the frame of the start.
struct MotionIncrement {
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d s = Eigen::Vector3d::Zero();  ///< m/s
  Eigen::Vector3d y = Eigen::Vector3d::Zero();  ///< m
};

/// One step of the classic fourth-order Runge-Kutta method on (R, s, y) from `*motion` over h_s
/// (may be negative), the corrected rates linear from `begin` to `end` (6.11 to 6.13). `R_middle`,
/// where not null, receives the rotation at the middle of the step (to fourth order), for
/// quadratures along it.
void RungeKuttaStep(const ImuRates& begin, const ImuRates& end, double h_s, MotionIncrement* motion,
                    Eigen::Quaterniond* R_middle = nullptr);

}  // namespace duet
