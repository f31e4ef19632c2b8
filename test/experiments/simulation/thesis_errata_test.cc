// Numbers behind the errata of docs/equations.md: the thesis's approximations of appendix B.4, with
// the signs as printed and as they have to be, against the delta's Jacobians (which are held to
// numeric differentiation by the IMU's own tests).

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "common/geometry/so3.h"
#include "common/imu/imu_delta.h"

namespace duet {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix39 = Eigen::Matrix<double, 3, 9>;

// dT/d(T by rows) * x, a column for each of the nine numbers (B.14).
Matrix39 ByElement(const Vector3d& x) {
  Matrix39 J = Matrix39::Zero();
  for (int row = 0; row < 3; ++row) J.block<1, 3>(row, 3 * row) = x.transpose();
  return J;
}

// |a - b| / |b|.
template <class A, class B>
double Off(const A& a, const B& b) {
  return (a - b).norm() / b.norm();
}

class AppendixB : public testing::Test {
 protected:
  AppendixB() {
    calibration_.T_g += 0.01 * Matrix3d::Random();
    calibration_.T_a += 0.01 * Matrix3d::Random();
    calibration_.T_s = 0.02 * Matrix3d::Random();
    const ImuRates read = DistortRates({omega_, a_}, calibration_, {});
    const std::array<ImuSample, 2> readings = {
        ImuSample{.timestamp = 0, .omega_m = read.omega_B, .a_m = read.a_B},
        ImuSample{.timestamp = 5'000'000, .omega_m = read.omega_B, .a_m = read.a_B}};
    delta_ = IntegrateImu(readings, {}, calibration_, {}, {});
    // The body at the start is G, so that G's acceleration without gravity is R a and the thesis's
    // transposed rotations are R_GB.
    sum_R_ = Matrix3d::Identity() + delta_.R.toRotationMatrix();
    dt_ = delta_.dt_s;
    a_cross_ = Hat(delta_.R * a_);
    T_g_inverse_ = calibration_.T_g.inverse();
    T_a_inverse_ = calibration_.T_a.inverse();
  }

  // The approximations take the rates of the end for those of the interval: a few |omega| dt off,
  // 1e-2 here. A wrong sign is off by 2.
  static constexpr double kRight = 0.02;

  Vector3d omega_{0.5, -0.3, 0.8};
  Vector3d a_{1.0, -2.0, 9.5};
  ImuCalibration calibration_;
  ImuDelta delta_;
  Matrix3d sum_R_, a_cross_, T_g_inverse_, T_a_inverse_;
  double dt_ = 0.0;
};

TEST_F(AppendixB, OrientationTermsHoldAsPrinted) {
  const Matrix3d G = 0.5 * dt_ * sum_R_ * T_g_inverse_;
  const Matrix3d S = calibration_.T_s * T_a_inverse_;
  EXPECT_LT(Off(-G, delta_.J_b_g.topRows<3>()), kRight);                         // B.49
  EXPECT_LT(Off(G * S, delta_.J_b_a.topRows<3>()), kRight);                      // B.52
  EXPECT_LT(Off(-G * ByElement(omega_), delta_.J_T.block<3, 9>(0, 0)), kRight);  // B.55
  EXPECT_LT(Off(-G * ByElement(a_), delta_.J_T.block<3, 9>(0, 9)), kRight);      // B.58
  EXPECT_LT(Off(G * S * ByElement(a_), delta_.J_T.block<3, 9>(0, 18)), kRight);  // B.61
}

TEST_F(AppendixB, VelocityTermsHaveTheOtherSign) {
  const Matrix3d G = 0.25 * dt_ * dt_ * a_cross_ * sum_R_ * T_g_inverse_;
  const Matrix3d S = calibration_.T_s * T_a_inverse_;
  const Matrix3d A = -0.5 * dt_ * sum_R_ * T_a_inverse_;
  EXPECT_LT(Off(G, delta_.J_b_g.middleRows<3>(3)), kRight);  // B.50 holds

  const Matrix39 Tg = delta_.J_T.block<3, 9>(3, 0);
  const Matrix39 Ts = delta_.J_T.block<3, 9>(3, 9);
  EXPECT_LT(Off(G * ByElement(omega_), Tg), kRight);
  EXPECT_GT(Off(-G * ByElement(omega_), Tg), 1.9);  // B.56 as printed
  EXPECT_LT(Off(G * ByElement(a_), Ts), kRight);
  EXPECT_GT(Off(-G * ByElement(a_), Ts), 1.9);  // B.59 as printed
  // The terms through T_s, apart from the direct ones of T_a.
  const Matrix3d b_a = delta_.J_b_a.middleRows<3>(3);
  const Matrix3d indirect = -G * S;
  const double direct_off = (b_a - A).norm();
  EXPECT_LT((b_a - A - indirect).norm(), direct_off);
  EXPECT_GT((b_a - A + indirect).norm(), direct_off);  // B.53 as printed
}

TEST_F(AppendixB, PositionTermsOfTheGyroscopeAreHalfAgainTooLarge) {
  const Matrix3d half = 0.5 * dt_ * delta_.J_b_g.middleRows<3>(3);  // B.51
  const double ratio = half.norm() / delta_.J_b_g.bottomRows<3>().norm();
  std::printf("B.51 over the exact block: %.3f\n", ratio);
  // dt^3 / 4 in place of dt^3 / 6.
  EXPECT_NEAR(ratio, 1.5, 0.02);
}

TEST_F(AppendixB, TheSpecificForceEntersTheRateWithAPlus) {
  const ImuCorrection correction(calibration_, {});
  Eigen::Matrix<double, 3, 27> J_omega;
  Eigen::Matrix<double, 3, 27> J_a;
  correction.CalibrationJacobians({omega_, a_}, &J_omega, &J_a);
  const Matrix39 printed = -T_g_inverse_ * calibration_.T_s * T_a_inverse_ * ByElement(a_);  // B.19
  const Matrix39 exact = J_omega.rightCols<9>();
  EXPECT_LT(Off(Matrix39(-printed), exact), 1e-12);
  EXPECT_GT(Off(printed, exact), 1.9);
}

}  // namespace
}  // namespace duet
