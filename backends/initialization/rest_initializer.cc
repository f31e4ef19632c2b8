#include <Eigen/Geometry>
#include <cmath>

#include "backends/initialization/initialization.h"
#include "common/geometry/so3.h"

namespace duet {
namespace {

// The detector judges over the whole time that a start at rest asks for.
StandstillOptions DetectorOptions(const StandstillOptions& shared, double rest_duration_s) {
  StandstillOptions options = shared;
  options.enabled = true;
  options.window_s = rest_duration_s;
  return options;
}

struct Mean {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double sigma = 0.0;  // of the mean, largest axis
};

template <class Member>
Mean MeanOf(const std::vector<ImuSample>& readings, Member member) {
  Mean result;
  const double n = static_cast<double>(readings.size());
  for (const ImuSample& s : readings) result.mean += s.*member / n;
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  for (const ImuSample& s : readings) variance += (s.*member - result.mean).cwiseAbs2() / (n - 1.0);
  result.sigma = std::sqrt(variance.maxCoeff() / n);
  return result;
}

// R_GB with this direction up and B's x axis in the plane of G's x and z: yaw 0. Where x points up
// or down, yaw means nothing, and B's y axis becomes G's.
Eigen::Quaterniond WithoutYaw(const Eigen::Vector3d& up_B) {
  constexpr double kVertical = 1e-6;
  Eigen::Vector3d y_B = up_B.cross(Eigen::Vector3d::UnitX());
  y_B = y_B.norm() > kVertical ? y_B.normalized() : Eigen::Vector3d::UnitY();
  Eigen::Matrix3d R_GB;
  R_GB.row(0) = y_B.cross(up_B).transpose();
  R_GB.row(1) = y_B.transpose();
  R_GB.row(2) = up_B.transpose();
  return Eigen::Quaterniond(R_GB).normalized();
}

// What errors of T_s and T_a make of the first state: the readings are what they are, so that a
// wrong T_s a_B is taken for a bias of the gyroscope, and of a wrong T_a a_B the part along gravity
// for one of the accelerometer, the part across for a tilt.
Eigen::MatrixXd GainOfInexactMatrices(const CalibrationLayout& layout, const Eigen::Vector3d& a_B,
                                      const Eigen::Matrix3d& R_GB) {
  Eigen::MatrixXd gain = Eigen::MatrixXd::Zero(15, layout.size());
  const Eigen::Vector3d up_B = a_B.normalized();
  for (const CalibrationLayout::Entry& entry : layout.entries()) {
    const bool of_rate = entry.block == CalibrationBlock::kTs;
    if (!of_rate && entry.block != CalibrationBlock::kTa) continue;
    for (int k = 0; k < entry.size; ++k) {
      const int row = entry.number[k] / 3;
      const Eigen::Vector3d read = a_B[entry.number[k] % 3] * Eigen::Vector3d::Unit(row);
      auto column = gain.col(entry.offset + k);
      if (of_rate) {
        column.segment<3>(9) = -read;
      } else {
        column.head<3>() = R_GB * up_B.cross(read) / a_B.norm();
        column.segment<3>(12) = -up_B * up_B.dot(read);
      }
    }
  }
  return gain;
}

}  // namespace

RestInitializer::RestInitializer(const EstimatorSetup& setup, const InitializationOptions& options)
    : setup_(setup),
      options_(options),
      detector_(DetectorOptions(setup.shared.standstill, options.rest_duration_s)) {}

InitializationResult RestInitializer::Update(const TrackFrameSet& frames, const ImuBuffer& imu) {
  const Timestamp instant = frames.timestamp + ToNanoseconds(setup_.rig.t_d_s);
  const Timestamp start = instant - ToNanoseconds(options_.rest_duration_s);
  const bool at_rest = detector_.Update(frames, instant, imu);
  if (!imu.Covers(start, instant)) {
    return InitializationFailure{"a start at rest needs IMU over the last " +
                                 std::to_string(options_.rest_duration_s) + " s"};
  }
  if (!at_rest) {
    return InitializationFailure{
        "the rig has not been at rest for " + std::to_string(options_.rest_duration_s) +
        " s (tracks moved, or the means of the IMU changed); start at rest, or with "
        "--init groundtruth"};
  }
  std::vector<ImuSample> readings;
  imu.Extract(start, instant, &readings);
  const Mean omega = MeanOf(readings, &ImuSample::omega_m);
  const Mean force = MeanOf(readings, &ImuSample::a_m);

  // At rest the specific force is -g: its direction is up, and what its length is off by is the
  // accelerometer's offset along it. Yaw is free: 0.
  const ImuCalibration& imu_calibration = setup_.rig.imu;
  const Eigen::Vector3d up_B = (imu_calibration.T_a.inverse() * force.mean).normalized();
  const double g = setup_.g_G.norm();
  const Eigen::Vector3d a_B = g * up_B;
  InitialCondition result;
  result.state.instant = instant;
  result.state.biases.b_a = force.mean - imu_calibration.T_a * a_B;
  result.state.biases.b_g = omega.mean - imu_calibration.T_s * a_B;
  result.state.nav.R_GB = WithoutYaw(up_B);

  // Tilt and the accelerometer's lateral bias are one unknown: theta = up x (R b_a) / g. Drawn from
  // the bias prior and mapped; what is known is the bias along gravity, to the noise of the mean.
  const Eigen::Matrix3d R_final = result.state.nav.R_GB.toRotationMatrix();
  const Eigen::Vector3d up_G = -setup_.g_G / g;
  const double lateral = options_.sigma_b_a_m_per_s2;
  // Vibration is no white noise; its mean over half a second is trusted to 0.02 m/s^2 at best.
  const double vertical = std::hypot(force.sigma, 0.02);
  Matrix15d& P = result.covariance;
  P.setZero();
  const Eigen::Matrix3d bias_G =
      lateral * lateral * (Eigen::Matrix3d::Identity() - up_G * up_G.transpose()) +
      vertical * vertical * up_G * up_G.transpose();
  const Eigen::Matrix3d J_theta_bias = Hat(up_G) / g * R_final;
  const Eigen::Matrix3d bias_B = R_final.transpose() * bias_G * R_final;
  P.block<3, 3>(12, 12) = bias_B;
  P.block<3, 3>(0, 0) = J_theta_bias * bias_B * J_theta_bias.transpose();
  P.block<3, 3>(0, 12) = J_theta_bias * bias_B;
  P.block<3, 3>(12, 0) = P.block<3, 3>(0, 12).transpose();
  const double tilt_noise = std::hypot(force.sigma / g, 1e-3);
  P.block<3, 3>(0, 0) +=
      tilt_noise * tilt_noise * Eigen::Matrix3d::Identity() +
      (options_.sigma_yaw_rad * options_.sigma_yaw_rad - tilt_noise * tilt_noise) * up_G *
          up_G.transpose();
  P.block<3, 3>(3, 3).diagonal().setConstant(options_.sigma_position_m * options_.sigma_position_m);
  P.block<3, 3>(6, 6).diagonal().setConstant(setup_.shared.standstill.velocity_sigma_m_per_s *
                                             setup_.shared.standstill.velocity_sigma_m_per_s);
  const double gyro = std::min(options_.sigma_b_g_rad_per_s, std::hypot(omega.sigma, 1e-3));
  P.block<3, 3>(9, 9).diagonal().setConstant(gyro * gyro);
  result.calibration_gain =
      GainOfInexactMatrices(CalibrationLayout(setup_.shared.calibration, setup_.rig), a_B, R_final);
  return result;
}

}  // namespace duet
