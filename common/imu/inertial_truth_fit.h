#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/se3.h"
#include "common/imu/imu_sample.h"

namespace duet {

/// How the gyroscope and a trajectory belong together: mean rates over intervals of the poses,
///   omega_m(t + time_shift) = R_IB omega_truth(t) + bias.
struct GyroTruthFit {
  double time_shift_s = 0.0;  ///< the IMU's stamp of what the truth has at t, minus t
  double time_sigma_s = 0.0;  ///< from the residuals
  Eigen::Quaterniond R_IB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< rad/s
  double rms_rad_per_s = 0.0;                      ///< of the residuals kept
  int intervals = 0;                               ///< kept
  int left_out = 0;                                ///< as outliers (jumps of the truth)
};
/// Nothing where the rates vary too little for it (less than 0.05 rad/s root mean square, or about
/// one axis only). Shifts up to 0.1 s are searched.
[[nodiscard]] std::optional<GyroTruthFit> FitGyroToTruth(const std::vector<ImuSample>& imu,
                                                         const std::vector<StampedPose>& truth);

/// Gravity as accelerometer and trajectory have it: from second differences of the positions,
///   double mean of (R a_m - R b_a) = second difference + gamma,   gamma = -g_G.
struct GravityFit {
  Eigen::Vector3d minus_g_G = Eigen::Vector3d::Zero();  ///< m/s^2
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();      ///< 1 sigma of it
  Eigen::Vector3d b_a = Eigen::Vector3d::Zero();        ///< a prior of 0.2 m/s^2 on it
  double rms_m_per_s2 = 0.0;
  int intervals = 0;
};
/// `time_shift_s` as fitted above. Nothing for less than a second.
[[nodiscard]] std::optional<GravityFit> FitGravityToTruth(const std::vector<ImuSample>& imu,
                                                          const std::vector<StampedPose>& truth,
                                                          double time_shift_s);

}  // namespace duet
