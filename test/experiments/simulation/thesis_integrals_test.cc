// The integrals of appendix B (B.7 to B.48), evaluated finely with the signs as printed and as they
// have to be, against the delta's Jacobians (held to numeric differentiation by the IMU's own
// tests). Numbers behind the errata of docs/equations.md.

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <vector>

#include "common/geometry/so3.h"
#include "common/imu/imu_delta.h"
#include "common/support/random.h"

namespace duet {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic>;

// 0.1 s of constant rates, in the frame of its start (the thesis's transposed R_l drops out).
class Integrals : public testing::Test {
 protected:
  Integrals() {
    Random random(1);
    const auto uniform = [&random](double bound) {
      return Matrix3d::NullaryExpr([&]() { return random.Uniform(-bound, bound); }).eval();
    };
    calibration_.T_g += uniform(0.05);
    calibration_.T_s = uniform(0.02);
    calibration_.T_a += uniform(0.05);
    const ImuRates read = DistortRates(rates_, calibration_, {});
    std::vector<ImuSample> readings;
    for (int i = 0; i <= 100; ++i) {
      readings.push_back({i * 1'000'000LL, read.omega_B, read.a_B});
    }
    delta_ = IntegrateImu(readings, {}, calibration_, {});
    const ImuCorrection correction(calibration_, {});
    Eigen::Matrix<double, 3, 27> W_T;
    Eigen::Matrix<double, 3, 27> A_T;
    correction.CalibrationJacobians(rates_, &W_T, &A_T);  // B.17 to B.19, B.34 to B.36
    parameters_ = {
        {{"b_g", -correction.T_g_inverse(), Matrix3d::Zero(), delta_.J_b_g},
         {"b_a", correction.J_omega_ba(), -correction.T_a_inverse(), delta_.J_b_a},
         {"T_g", W_T.leftCols<9>(), A_T.leftCols<9>(), delta_.J_T.leftCols<9>()},
         {"T_s", W_T.middleCols<9>(9), A_T.middleCols<9>(9), delta_.J_T.middleCols<9>(9)},
         {"T_a", W_T.rightCols<9>(), A_T.rightCols<9>(), delta_.J_T.rightCols<9>()}}};
  }

  struct Parameter {
    const char* name;
    Columns W;                                       // d omega
    Columns A;                                       // d a
    Eigen::Matrix<double, 9, Eigen::Dynamic> exact;  // rows theta, s, y
  };

  struct Result {
    Columns theta, s, y;
  };

  // theta = integral of R W; s of R A + sign [R a]x theta; y of s (trapezoids, 2,000 steps).
  [[nodiscard]] Result Integrate(const Parameter& parameter, double sign) const {
    constexpr int kSteps = 2000;
    const double h = 0.1 / kSteps;
    const Eigen::Index width = parameter.W.cols();
    Result x{Columns::Zero(3, width), Columns::Zero(3, width), Columns::Zero(3, width)};
    for (int i = 0; i < kSteps; ++i) {
      const Matrix3d R_0 = Exp(rates_.omega_B * (h * i));
      const Matrix3d R_1 = Exp(rates_.omega_B * (h * (i + 1)));
      const Columns theta_1 = x.theta + 0.5 * h * (R_0 + R_1) * parameter.W;
      const Columns s_1 =
          x.s + 0.5 * h *
                    ((R_0 + R_1) * parameter.A + sign * Hat(R_0 * rates_.a_B) * x.theta +
                     sign * Hat(R_1 * rates_.a_B) * theta_1);
      x.y += 0.5 * h * (x.s + s_1);
      x.theta = theta_1;
      x.s = s_1;
    }
    return x;
  }

  const ImuRates rates_{Vector3d(0.5, -0.3, 0.8), Vector3d(1.0, -2.0, 9.5)};
  ImuCalibration calibration_;
  ImuDelta delta_;
  std::array<Parameter, 5> parameters_;
};

double RelativeError(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

TEST_F(Integrals, OrientationHoldsAsPrinted) {
  // B.7 with B.15 to B.18 and the plus of B.24: B.20 to B.24.
  for (const Parameter& parameter : parameters_) {
    EXPECT_LT(RelativeError(Integrate(parameter, 1.0).theta, parameter.exact.topRows<3>()), 1e-6)
        << parameter.name;
  }
}

TEST_F(Integrals, B13TurnsTheErrorOnceTooOften) {
  // R_l+1 R_l' before the integral in place of R_l': off by the interval's own turn.
  const Matrix3d turn = delta_.R.toRotationMatrix().transpose();
  const Parameter& b_g = parameters_[0];
  const double off = RelativeError(turn * Integrate(b_g, 1.0).theta, b_g.exact.topRows<3>());
  std::printf("B.13 as printed: %.1f %% off over %.3f rad\n", 100.0 * off, Log(delta_.R).norm());
  EXPECT_GT(off, 0.05);
}

TEST_F(Integrals, TheTrueRotationOfB27HasAPlus) {
  // A gyroscope's bias makes R_true = (I + [theta]x) R to first order with theta of B.7, printed -.
  const Vector3d b_g(1e-3, -2e-3, 1e-3);
  const Matrix3d R = delta_.R.toRotationMatrix();
  const Vector3d theta = delta_.J_b_g.topRows<3>() * b_g;
  const ImuRates read = DistortRates(rates_, calibration_, {});
  const std::array<ImuSample, 2> readings = {ImuSample{0, read.omega_B, read.a_B},
                                             ImuSample{100'000'000, read.omega_B, read.a_B}};
  const auto integrate = [&](const ImuBiases& biases) {
    return IntegrateImu(readings, biases, calibration_, {}).R.toRotationMatrix();
  };
  const Matrix3d change = integrate({b_g, {0, 0, 0}}) - integrate({});
  EXPECT_LT(RelativeError(Hat(theta) * R, change), 1e-3);   // second order in theta, 2e-4 rad
  EXPECT_GT(RelativeError(-Hat(theta) * R, change), 1.99);  // B.27
}

TEST_F(Integrals, VelocityAndPositionHaveAMinusInFrontOfTheRotatedForce) {
  // B.31 and what is made of it: B.37 to B.41 and B.44 to B.48, as printed (+ [R a]x theta in B.31)
  // and with the minus that follows from B.27's plus.
  std::printf("%-4s %12s %12s %12s %12s\n", "", "v printed", "v minus", "p printed", "p minus");
  for (const Parameter& parameter : parameters_) {
    const Result printed = Integrate(parameter, 1.0);
    const Result right = Integrate(parameter, -1.0);
    const Columns v = parameter.exact.middleRows<3>(3);
    const Columns p = parameter.exact.bottomRows<3>();
    std::printf("%-4s %12.2e %12.2e %12.2e %12.2e\n", parameter.name, RelativeError(printed.s, v),
                RelativeError(right.s, v), RelativeError(printed.y, p), RelativeError(right.y, p));
    EXPECT_LT(RelativeError(right.s, v), 1e-5) << parameter.name;
    EXPECT_LT(RelativeError(right.y, p), 1e-5) << parameter.name;
    if (parameter.A.isZero(0.0)) {
      EXPECT_NEAR(RelativeError(printed.s, v), 2.0, 1e-4) << parameter.name;
      EXPECT_NEAR(RelativeError(printed.y, p), 2.0, 1e-4) << parameter.name;
    } else {
      // Only the terms through T_s: without them it is nearer.
      const Columns direct = 0.5 * (printed.s + right.s);
      EXPECT_NEAR((printed.s - v).norm() / (direct - v).norm(), 2.0, 1e-2) << parameter.name;
      const Columns direct_p = 0.5 * (printed.y + right.y);
      EXPECT_NEAR((printed.y - p).norm() / (direct_p - p).norm(), 2.0, 1e-2) << parameter.name;
    }
  }
}

}  // namespace
}  // namespace duet
