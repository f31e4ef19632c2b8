// The equations of the thesis's chapters 4 to 6 written out as printed, against the functions that
// are them, and numbers behind their errata (docs/equations.md).

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "common/geometry/se3.h"
#include "common/geometry/so3.h"
#include "common/imu/imu_delta.h"
#include "common/imu/motion_increment.h"
#include "common/measurement/measurement_model.h"
#include "common/support/random.h"

namespace duet {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

const Vector3d kThesisGravity(0, 0, -9.81);

Vector3d RandomVector(Random* random, double sigma) { return sigma * random->NormalVector<3>(); }

Pose RandomPose(Random* random) {
  return {ExpQuaternion(RandomVector(random, 1.0)), RandomVector(random, 2.0)};
}

// Omega of 6.3.
Matrix4d Omega(const Vector3d& omega) {
  Matrix4d M;
  M << -Hat(omega), omega, -omega.transpose(), 0.0;
  return M;
}

// JPL's product q (x) p (A.6).
Vector4d JplProduct(const Vector4d& q, const Vector4d& p) {
  const Vector3d v = q[3] * p.head<3>() + p[3] * q.head<3>() - q.head<3>().cross(p.head<3>());
  return {v.x(), v.y(), v.z(), q[3] * p[3] - q.head<3>().dot(p.head<3>())};
}

// 6.11 to 6.13 as printed, from the unit quaternion: q of B_l+1 in B_l.
Vector4d PrintedRungeKutta(const Vector3d& omega_0, const Vector3d& omega_1, double dt) {
  const Vector4d q_0(0, 0, 0, 1);
  const Vector3d omega_middle = 0.5 * (omega_0 + omega_1);
  const Vector4d K1 = 0.5 * Omega(omega_0) * q_0;
  const Vector4d K2 = 0.5 * Omega(omega_middle) * (q_0 + 0.5 * dt * K1);
  const Vector4d K3 = 0.5 * Omega(omega_middle) * (q_0 + 0.5 * dt * K2);
  const Vector4d K4 = 0.5 * Omega(omega_1) * (q_0 + dt * K3);
  return (q_0 + dt / 6.0 * (K1 + 2 * K2 + 2 * K3 + K4)).normalized();
}

TEST(Chapter4, MeasuredForceInTheRateCostsTsTimesTheAccelerometersErrors) {
  // 4.5 with T_s on the measured force reads T_s (T_a a + b_a) in place of T_s a; corrected by 6.8,
  // which takes the true force, the rate is off by T_g^-1 T_s ((T_a - I) a + b_a).
  ImuCalibration calibration;
  calibration.T_a(2, 2) = 1.02;
  calibration.T_s = 1e-3 * Matrix3d::Identity();
  const ImuBiases biases{Vector3d::Zero(), Vector3d(0, 0, 0.2)};
  const ImuRates rates{Vector3d(0.1, -0.2, 0.3), Vector3d(0, 0, 9.81)};
  const ImuRates read = DistortRates(rates, calibration, biases);
  const Vector3d printed = calibration.T_g * rates.omega_B + calibration.T_s * read.a_B;  // 4.5
  const ImuCorrection correction(calibration, biases);
  EXPECT_LT((correction(read.omega_B, read.a_B).omega_B - rates.omega_B).norm(), 1e-15);
  const double off = (correction(printed, read.a_B).omega_B - rates.omega_B).norm();
  std::printf("4.5 as printed: %.2e rad/s off\n", off);
  EXPECT_NEAR(off, 1e-3 * (0.02 * 9.81 + 0.2), 1e-12);
}

TEST(Chapter4, MeasuredRateInItsOwnModelCannotBeSolvedForTheTrueOne) {
  // 4.4 and 4.5 have omega_m on both sides: (I - T_g) omega_m = b_g, without omega.
  const Vector3d omega(0.1, -0.2, 0.3);
  const ImuCalibration calibration;
  const Vector3d b_g(0.01, 0, 0);
  const Vector3d read =
      DistortRates({omega, Vector3d::Zero()}, calibration, {b_g, {0, 0, 0}}).omega_B;
  EXPECT_GT((read - (calibration.T_g * read + b_g)).norm(), 0.009);  // as printed: off by b_g
  EXPECT_LT((read - (calibration.T_g * omega + b_g)).norm(), 1e-16);
}

TEST(Chapter5, TheSecondLineOf52HasAPlus) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose T_C0Ci = RandomPose(&random);
    const Pose T_CiC0 = T_C0Ci.Inverse();
    const Vector3d p_C0F = Vector3d(0, 0, 4) + RandomVector(&random, 0.5);
    const Vector3d first_line = T_CiC0.R * (p_C0F - T_C0Ci.p);
    EXPECT_LT((first_line - (T_CiC0.R * p_C0F + T_CiC0.p)).norm(), 1e-14);
    const double printed = (first_line - (T_CiC0.R * p_C0F - T_CiC0.p)).norm();
    EXPECT_NEAR(printed, 2.0 * T_C0Ci.p.norm(), 1e-13);
    // 5.3 and 5.4: homogeneous in (alpha, beta, 1, rho).
    const InverseDepth landmark(p_C0F.x() / p_C0F.z(), p_C0F.y() / p_C0F.z(), 1.0 / p_C0F.z());
    const Vector3d g_i =
        T_CiC0.R * Vector3d(landmark.x(), landmark.y(), 1.0) + landmark.z() * T_CiC0.p;
    EXPECT_LT((first_line - p_C0F.z() * g_i).norm(), 1e-14);
  }
}

TEST(Chapter5, PredictPixelIsProjectOfGi) {
  // With the camera as the body, anchor and observing state at the cameras' poses, 5.5's h(g_i).
  Random random(2);
  RigCalibration rig;
  CameraModel::Parameters parameters(9);
  parameters << 458.6, 457.3, 367.2, 248.4, -0.283, 0.0739, 1.9e-4, 1.8e-5, 0.002;
  rig.cameras.push_back({CameraModel(DistortionModel::kRadialTangential, 752, 480, parameters),
                         Eigen::Quaterniond::Identity(), Vector3d::Zero()});
  for (int trial = 0; trial < 20; ++trial) {
    const Pose anchor = RandomPose(&random);
    ObservingState state;
    state.nav.R_GB = ExpQuaternion(RandomVector(&random, 0.1)) * anchor.R;
    state.nav.p_GB = anchor.p + RandomVector(&random, 0.2);
    const InverseDepth landmark(random.Uniform(-0.3, 0.3), random.Uniform(-0.2, 0.2), 0.25);
    const Pose T_CiC0 = state.nav.pose().Inverse() * anchor;
    const Vector3d g_i =
        T_CiC0.R * Vector3d(landmark.x(), landmark.y(), 1.0) + landmark.z() * T_CiC0.p;
    Eigen::Vector2d expected;
    Eigen::Vector2d uv;
    ASSERT_TRUE(rig.cameras[0].model.Project(g_i, &expected));
    ASSERT_TRUE(PredictPixel(rig, anchor, landmark, state, {0, {}}, kThesisGravity, &uv));
    EXPECT_LT((uv - expected).norm(), 1e-10);
  }
}

TEST(Chapter6, OmegaIsTheDerivativeOfTheQuaternion) {
  // 6.1: the axis and the sine of half the angle. 6.2, 6.3: R_GB turns by omega in B; the four
  // numbers of R_GB are those of the thesis's B_G q.
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3d theta = RandomVector(&random, 0.5);
    Vector4d axis_angle;
    axis_angle << theta.normalized() * std::sin(0.5 * theta.norm()), std::cos(0.5 * theta.norm());
    EXPECT_LT((ExpQuaternion(theta).coeffs() - axis_angle).norm(), 1e-15);
    const Eigen::Quaterniond R_GB = ExpQuaternion(RandomVector(&random, 1.0));
    const Vector3d omega = RandomVector(&random, 1.0);
    constexpr double kStep = 1e-5;
    const Vector4d numeric = ((R_GB * ExpQuaternion(kStep * omega)).coeffs() -
                              (R_GB * ExpQuaternion(-kStep * omega)).coeffs()) /
                             (2.0 * kStep);
    EXPECT_LT((numeric - 0.5 * Omega(omega) * R_GB.coeffs()).norm(), 1e-9);
  }
}

TEST(Chapter6, RungeKuttaAsPrintedIsTheStepsRotation) {
  // 6.11 to 6.13 against RungeKuttaStep from the identity, to rounding; 6.9 with B_l's orientation
  // on the right is Predict, with B_l+1's there (as printed) it is not.
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const ImuRates begin{RandomVector(&random, 1.0), RandomVector(&random, 9.0)};
    const ImuRates end{RandomVector(&random, 1.0), RandomVector(&random, 9.0)};
    constexpr double kStep_s = 0.01;
    MotionIncrement motion;
    RungeKuttaStep(begin, end, kStep_s, &motion);
    const Vector4d q = PrintedRungeKutta(begin.omega_B, end.omega_B, kStep_s);
    EXPECT_LT((q - motion.R.coeffs()).norm(), 1e-15);

    NavState start;
    start.R_GB = ExpQuaternion(RandomVector(&random, 1.0));
    ImuDelta delta;
    delta.R = motion.R;
    delta.dt_s = kStep_s;
    const Eigen::Quaterniond after = Predict(start, delta, kThesisGravity).R_GB;
    EXPECT_LT((JplProduct(q, start.R_GB.coeffs()) - after.coeffs()).norm(), 1e-15);
    const double printed = (JplProduct(q, after.coeffs()) - after.coeffs()).norm();
    EXPECT_NEAR(printed, 2.0 * std::sin(0.25 * Log(motion.R).norm()), 1e-12);  // a step's turn
  }
}

TEST(Chapter6, PositionOf616NeedsTheVelocityTimesTheInterval) {
  // Constant rates: x(t) of a body that falls and is pushed. As printed p moves by v in 5 ms.
  NavState start;
  start.v_GB = Vector3d(1.0, 0.5, 0.0);
  const Vector3d a(0.2, 0.0, 9.0);
  const std::array<ImuSample, 2> readings = {ImuSample{0, Vector3d::Zero(), a},
                                             ImuSample{5'000'000, Vector3d::Zero(), a}};
  const ImuDelta delta = IntegrateImu(readings, {}, {}, {});
  const double dt = delta.dt_s;
  const Vector3d exact = start.v_GB * dt + 0.5 * dt * dt * (a + kThesisGravity);
  EXPECT_LT((Predict(start, delta, kThesisGravity).p_GB - exact).norm(), 1e-16);
  const Vector3d printed = start.v_GB + delta.y + 0.5 * dt * dt * kThesisGravity;
  EXPECT_NEAR((printed - exact).norm(), start.v_GB.norm() * (1.0 - dt), 1e-12);
}

TEST(Chapter6, ThePointOf621IsInTheGlobalFrame) {
  // p_f in the camera's frame, as printed, is moved by the whole pose of the camera.
  Random random(5);
  const Pose T_GB = RandomPose(&random);
  const Pose T_CB = RandomPose(&random);
  const Vector3d p_GF = RandomVector(&random, 5.0);
  const Vector3d exact = (T_CB * T_GB.Inverse()) * p_GF;
  const auto with = [&](const Vector3d& p_F) -> Vector3d {
    return T_CB.R * (T_GB.R.conjugate() * (p_F - T_GB.p)) + T_CB.p;
  };
  EXPECT_LT((with(p_GF) - exact).norm(), 1e-14);
  EXPECT_GT((with(exact) - exact).norm(), 1.0);
}

TEST(Chapter6, TheGateOf625NeedsTheMeasurementsNoise) {
  // Good tracks seen 10 times: k = 17; what the state's uncertainty does is a quarter of sigma^2.
  constexpr int kDegrees = 17;
  constexpr double kBound = 27.587;  // chi-squared, 17 degrees of freedom, 95 %
  constexpr double kStateShare = 0.25;
  constexpr int kTracks = 4000;
  Random random(6);
  double printed_mean = 0.0;
  int refused = 0;
  int refused_as_printed = 0;
  for (int track = 0; track < kTracks; ++track) {
    double squared = 0.0;
    for (int i = 0; i < kDegrees; ++i) {
      const double r = std::sqrt(1.0 + kStateShare) * random.Normal();
      squared += r * r;
    }
    const double gamma = squared / (1.0 + kStateShare);
    const double printed = squared / kStateShare;
    printed_mean += printed / kTracks;
    refused += gamma > kBound;
    refused_as_printed += printed > kBound;
  }
  std::printf("6.25 as printed: mean gamma %.1f, %.1f %% refused; with the noise %.1f %%\n",
              printed_mean, 100.0 * refused_as_printed / kTracks, 100.0 * refused / kTracks);
  EXPECT_NEAR(printed_mean, 85.0, 2.0);               // five times 17, 5 sigma of the mean
  EXPECT_GT(refused_as_printed, 99 * kTracks / 100);  // good ones
  EXPECT_NEAR(static_cast<double>(refused) / kTracks, 0.05, 0.015);
}

// Integral of f over [from, to], Simpson.
double Integral(const std::function<double(double)>& f, double from, double to) {
  constexpr int kSteps = 200'000;
  const double h = (to - from) / kSteps;
  double sum = f(from) + f(to);
  for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(from + i * h);
  return sum * h / 3.0;
}

TEST(Chapter6, TheDistributionOf626DividesByTheCompleteGamma) {
  // k = 3 at its 95 % quantile. t = u^2 takes the root out of the integrand.
  constexpr double kHalf = 1.5;
  const auto integrand = [](double u) { return 2.0 * u * u * std::exp(-u * u); };
  const double lower = Integral(integrand, 0.0, std::sqrt(0.5 * 7.8147));
  const double upper = Integral(integrand, std::sqrt(kHalf), 12.0);
  const double complete = std::tgamma(kHalf);
  std::printf("6.26 as printed: %.3f, with the complete gamma function %.4f\n", lower / upper,
              lower / complete);
  EXPECT_NEAR(lower / complete, 0.95, 1e-5);
  EXPECT_NEAR(lower / upper, 2.43, 0.01);  // no probability
}

}  // namespace
}  // namespace duet
