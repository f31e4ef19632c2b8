#pragma once

#include <Eigen/Core>

namespace duet {

/// Continuous noise densities (thesis 4.6, 4.7), the same for the three axes.
struct ImuNoise {
  double gyroscope_density = 0.0;          ///< rad/s/sqrt(Hz)
  double accelerometer_density = 0.0;      ///< m/s^2/sqrt(Hz)
  double gyroscope_random_walk = 0.0;      ///< rad/s^2/sqrt(Hz)
  double accelerometer_random_walk = 0.0;  ///< m/s^3/sqrt(Hz)
};

/// The IMU's deterministic errors (thesis 4.3, 6.2.2, B.8, B.9):
///   a_m = T_a a + b_a + n_a,   omega_m = T_g omega + T_s a + b_g + n_g
/// with a, omega in B. As one vector: T_g, T_s, T_a, each by rows (27 numbers).
struct ImuCalibration {
  Eigen::Matrix3d T_g = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d T_s = Eigen::Matrix3d::Zero();  ///< rad/s per m/s^2
  Eigen::Matrix3d T_a = Eigen::Matrix3d::Identity();
};

struct ImuBiases {
  Eigen::Vector3d b_g = Eigen::Vector3d::Zero();  ///< rad/s
  Eigen::Vector3d b_a = Eigen::Vector3d::Zero();  ///< m/s^2
};

struct ImuRates {
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< rad/s
  Eigen::Vector3d a_B = Eigen::Vector3d::Zero();      ///< specific force, m/s^2
};

/// The inverse of the error model (6.8, 6.14, B.8, B.9) with the inverses of the T matrices taken
/// once. Affine in the measurement: interpolating measurements or corrected rates is the same.
class ImuCorrection {
 public:
  ImuCorrection(const ImuCalibration& calibration, const ImuBiases& biases);

  [[nodiscard]] ImuRates operator()(const Eigen::Vector3d& omega_m,
                                    const Eigen::Vector3d& a_m) const {
    ImuRates rates;
    rates.a_B = T_a_inverse_ * (a_m - biases_.b_a);
    rates.omega_B = T_g_inverse_ * (omega_m - calibration_.T_s * rates.a_B - biases_.b_g);
    return rates;
  }

  [[nodiscard]] const Eigen::Matrix3d& T_g_inverse() const { return T_g_inverse_; }
  [[nodiscard]] const Eigen::Matrix3d& T_a_inverse() const { return T_a_inverse_; }
  /// T_g^-1 T_s T_a^-1 = d omega_B / d b_a (B.16).
  [[nodiscard]] const Eigen::Matrix3d& J_omega_ba() const { return J_omega_ba_; }

  /// d omega_B / d (T_g, T_s, T_a) and d a_B / d (same), B.17 to B.19 and B.34 to B.36, at the
  /// corrected rates.
  void CalibrationJacobians(const ImuRates& rates, Eigen::Matrix<double, 3, 27>* J_omega,
                            Eigen::Matrix<double, 3, 27>* J_a) const;

 private:
  ImuCalibration calibration_;
  ImuBiases biases_;
  Eigen::Matrix3d T_g_inverse_;
  Eigen::Matrix3d T_a_inverse_;
  Eigen::Matrix3d J_omega_ba_;
};

/// The forward model without noise: what the IMU reads when the true rates are `rates`.
[[nodiscard]] ImuRates DistortRates(const ImuRates& rates, const ImuCalibration& calibration,
                                    const ImuBiases& biases);

}  // namespace duet
