#include "common/imu/motion_increment.h"

namespace duet {
namespace {

using QuaternionCoefficients = Eigen::Vector4d;  // x, y, z, w

// Derivative of a quaternion, q (omega, 0) / 2 (6.2, in Hamilton's convention).
QuaternionCoefficients Derivative(const QuaternionCoefficients& q, const Eigen::Vector3d& omega) {
  QuaternionCoefficients result;
  result.head<3>() = 0.5 * (q[3] * omega + q.head<3>().cross(omega));
  result[3] = -0.5 * q.head<3>().dot(omega);
  return result;
}

}  // namespace

void RungeKuttaStep(const ImuRates& begin, const ImuRates& end, double h_s, MotionIncrement* motion,
                    Eigen::Quaterniond* R_middle) {
  const Eigen::Vector3d omega_middle = 0.5 * (begin.omega_B + end.omega_B);
  const Eigen::Vector3d a_middle = 0.5 * (begin.a_B + end.a_B);
  const double half = 0.5 * h_s;

  const QuaternionCoefficients q0 = motion->R.coeffs();
  const QuaternionCoefficients dq1 = Derivative(q0, begin.omega_B);
  const QuaternionCoefficients q2 = q0 + half * dq1;
  const QuaternionCoefficients dq2 = Derivative(q2, omega_middle);
  const QuaternionCoefficients q3 = q0 + half * dq2;
  const QuaternionCoefficients dq3 = Derivative(q3, omega_middle);
  const QuaternionCoefficients q4 = q0 + h_s * dq3;
  const QuaternionCoefficients dq4 = Derivative(q4, end.omega_B);

  const Eigen::Vector3d ds1 = motion->R * begin.a_B;
  const Eigen::Vector3d ds2 = Eigen::Quaterniond(q2).normalized() * a_middle;
  const Eigen::Vector3d ds3 = Eigen::Quaterniond(q3).normalized() * a_middle;
  const Eigen::Vector3d ds4 = Eigen::Quaterniond(q4).normalized() * end.a_B;

  // y' = s: its four slopes are s, s + h/2 ds1, s + h/2 ds2, s + h ds3.
  motion->y += h_s * motion->s + (h_s * h_s / 6.0) * (ds1 + ds2 + ds3);
  motion->s += (h_s / 6.0) * (ds1 + 2.0 * ds2 + 2.0 * ds3 + ds4);
  motion->R.coeffs() = (q0 + (h_s / 6.0) * (dq1 + 2.0 * dq2 + 2.0 * dq3 + dq4)).normalized();
  if (R_middle != nullptr) {
    // Cubic Hermite interpolation between both ends, of fourth order.
    const QuaternionCoefficients& q1 = motion->R.coeffs();
    R_middle->coeffs() =
        (0.5 * (q0 + q1) + (h_s / 8.0) * (dq1 - Derivative(q1, end.omega_B))).normalized();
  }
}

}  // namespace duet
