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
  const Matrix39 T_a = delta_.J_T.block<3, 9>(3, 18) - A * ByElement(a_);
  EXPECT_LT((T_a - indirect * ByElement(a_)).norm(), T_a.norm());
  EXPECT_GT((T_a + indirect * ByElement(a_)).norm(), T_a.norm());  // B.62 as printed
}

TEST_F(AppendixB, PositionTermsThroughTheOrientationAreHalfAgainTooLarge) {
  // Half dt times the velocity's term, dt^3 / 4 in place of dt^3 / 6: B.51, B.57, B.60.
  const auto ratio = [this](const auto& velocity, const auto& position) {
    return 0.5 * dt_ * velocity.norm() / position.norm();
  };
  const std::array<double, 3> ratios = {
      ratio(delta_.J_b_g.middleRows<3>(3), delta_.J_b_g.bottomRows<3>()),
      ratio(delta_.J_T.block<3, 9>(3, 0), delta_.J_T.block<3, 9>(6, 0)),
      ratio(delta_.J_T.block<3, 9>(3, 9), delta_.J_T.block<3, 9>(6, 9))};
  std::printf("B.51, B.57, B.60 over the exact blocks: %.3f %.3f %.3f\n", ratios[0], ratios[1],
              ratios[2]);
  for (const double r : ratios) EXPECT_NEAR(r, 1.5, 0.02);

  // B.54 and B.63: right for the direct term of the accelerometer; what T_s adds to it, found as
  // the difference to the same without T_s, is again 1.5 times too large.
  ImuCalibration without = calibration_;
  without.T_s.setZero();
  const ImuRates read = DistortRates({omega_, a_}, without, {});
  const std::array<ImuSample, 2> readings = {
      ImuSample{.timestamp = 0, .omega_m = read.omega_B, .a_m = read.a_B},
      ImuSample{.timestamp = 5'000'000, .omega_m = read.omega_B, .a_m = read.a_B}};
  const ImuDelta direct = IntegrateImu(readings, {}, without, {}, {});
  const Eigen::Matrix<double, 9, 3> through_b_a = delta_.J_b_a - direct.J_b_a;
  const Eigen::Matrix<double, 9, 9> through_T_a =
      delta_.J_T.rightCols<9>() - direct.J_T.rightCols<9>();
  const std::array<double, 4> of_a = {
      ratio(direct.J_b_a.middleRows<3>(3), direct.J_b_a.bottomRows<3>()),
      ratio(direct.J_T.block<3, 9>(3, 18), direct.J_T.block<3, 9>(6, 18)),
      ratio(through_b_a.middleRows<3>(3), through_b_a.bottomRows<3>()),
      ratio(through_T_a.middleRows<3>(3), through_T_a.bottomRows<3>())};
  std::printf("B.54, B.63: direct terms %.3f %.3f, terms through T_s %.3f %.3f\n", of_a[0], of_a[1],
              of_a[2], of_a[3]);
  EXPECT_NEAR(of_a[0], 1.0, 0.01);
  EXPECT_NEAR(of_a[1], 1.0, 0.01);
  EXPECT_NEAR(of_a[2], 1.5, 0.02);
  EXPECT_NEAR(of_a[3], 1.5, 0.02);
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
