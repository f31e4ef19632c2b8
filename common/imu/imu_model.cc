#include "common/imu/imu_model.h"

#include <Eigen/LU>

namespace duet {

ImuCorrection::ImuCorrection(const ImuCalibration& calibration, const ImuBiases& biases)
    : calibration_(calibration),
      biases_(biases),
      T_g_inverse_(calibration.T_g.inverse()),
      T_a_inverse_(calibration.T_a.inverse()),
      J_omega_ba_(T_g_inverse_ * calibration.T_s * T_a_inverse_) {}

void ImuCorrection::CalibrationJacobians(const ImuRates& rates,
                                         Eigen::Matrix<double, 3, 27>* J_omega,
                                         Eigen::Matrix<double, 3, 27>* J_a) const {
  // d(T x)/d(T by rows): row i of T multiplies x, so column 3 i + j is x_j e_i; what follows from
  // it is -T_g^-1 e_i x_j (and so on), a column of the inverse times a number.
  J_a->leftCols<18>().setZero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      J_omega->col(3 * i + j) = -T_g_inverse_.col(i) * rates.omega_B[j];
      J_omega->col(9 + 3 * i + j) = -T_g_inverse_.col(i) * rates.a_B[j];
      J_omega->col(18 + 3 * i + j) = J_omega_ba_.col(i) * rates.a_B[j];
      J_a->col(18 + 3 * i + j) = -T_a_inverse_.col(i) * rates.a_B[j];
    }
  }
}

ImuRates DistortRates(const ImuRates& rates, const ImuCalibration& calibration,
                      const ImuBiases& biases) {
  ImuRates measured;
  measured.omega_B = calibration.T_g * rates.omega_B + calibration.T_s * rates.a_B + biases.b_g;
  measured.a_B = calibration.T_a * rates.a_B + biases.b_a;
  return measured;
}

}  // namespace duet
