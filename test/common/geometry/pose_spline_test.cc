#include "common/geometry/pose_spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/banded_cholesky.h"
#include "common/support/input_error.h"
#include "test/common/geometry/rotation_vectors.h"

namespace duet {
namespace {

constexpr Timestamp kStart = 1403636583763555584;

// A smooth motion of known derivatives: up to 3 rad/s and 2 m/s about all axes.
Kinematics Motion(double t) {
  const auto wave = [t](double amplitude, double rate, double phase, int derivative) {
    return amplitude * std::pow(rate, derivative) *
           std::sin(rate * t + phase + derivative * std::numbers::pi / 2.0);
  };
  const auto position = [&](int n) {
    return Eigen::Vector3d(wave(1.0, 1.1, 0.3, n), wave(0.8, 1.7, 1.0, n), wave(0.5, 2.3, 2.0, n));
  };
  const auto angles = [&](int n) {
    return Eigen::Vector3d(wave(0.9, 1.3, 0.0, n), wave(0.6, 2.1, 0.5, n), wave(2.0, 0.9, 1.5, n));
  };
  Kinematics k;
  k.T_GB.R = ExpQuaternion(angles(0));
  k.omega_B = RightJacobian(angles(0)) * angles(1);
  k.T_GB.p = Eigen::Vector3d(100.0, -50.0, 3.0) + position(0);
  k.v_GB = position(1);
  k.a_G = position(2);
  return k;
}

std::vector<StampedPose> Sample(double rate_hz, double duration_s) {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= std::lround(rate_hz * duration_s); ++i) {
    const double t = i / rate_hz;
    poses.push_back({kStart + ToNanoseconds(t), Motion(t).T_GB});
    if (i % 3 == 0) poses.back().T_GB.R.coeffs() *= -1.0;
  }
  return poses;
}

struct Errors {
  double rotation = 0.0, position = 0.0, velocity = 0.0, rate = 0.0, acceleration = 0.0;
};

Errors WorstErrors(const PoseSpline& spline, double margin_s) {
  Errors worst;
  const double end = SecondsBetween(spline.start(), spline.end()) - margin_s;
  for (double t = margin_s; t < end; t += 0.00317) {
    // The curve is asked at whole nanoseconds.
    const Timestamp stamp = kStart + ToNanoseconds(t);
    const Kinematics k = spline.At(stamp);
    const Kinematics truth = Motion(SecondsBetween(kStart, stamp));
    worst.rotation = std::max(worst.rotation, BoxMinus(k.T_GB.R, truth.T_GB.R).norm());
    worst.position = std::max(worst.position, (k.T_GB.p - truth.T_GB.p).norm());
    worst.velocity = std::max(worst.velocity, (k.v_GB - truth.v_GB).norm());
    worst.rate = std::max(worst.rate, (k.omega_B - truth.omega_B).norm());
    worst.acceleration = std::max(worst.acceleration, (k.a_G - truth.a_G).norm());
  }
  return worst;
}

TEST(BandedCholesky, SolvesAsADenseFactorDoes) {
  Random random(1);
  for (const int n : {1, 3, 6, 40}) {
    const int width = 5;
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
      for (int j = std::max(0, i - width); j <= i; ++j) B(i, j) = random.Normal();
      B(i, i) += 6.0;
    }
    const Eigen::MatrixXd A = B * B.transpose();
    Eigen::MatrixXd lower = Eigen::MatrixXd::Constant(width + 1, n, 7.0);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k <= width && i + k < n; ++k) lower(k, i) = A(i + k, i);
    }
    const Eigen::MatrixXd x = Eigen::MatrixXd::Random(n, 3);
    Eigen::MatrixXd solved = A * x;
    BandedCholesky(lower).SolveInPlace(solved);
    EXPECT_LT((solved - x).norm(), 1e-12) << n;  // condition number about 100
  }
}

TEST(PoseSpline, RatesAreTheDerivativesOfThePose) {
  const PoseSpline spline = PoseSpline::Fit(Sample(200.0, 2.0), 0.08);
  // Inside one knot interval (the sixth derivative does not exist at a knot): central differences
  // over six points 2 ms apart.
  const Timestamp h = 2000000;
  int tested = 0;
  for (Timestamp t = spline.start() + 10000000; t < spline.end() - 10000000; t += 7777777) {
    const Timestamp in_knot = (t - spline.start()) % 80000000;
    if (in_knot < 3 * h || in_knot > 80000000 - 3 * h) continue;
    ++tested;
    const Kinematics k = spline.At(t);
    const double weights[3] = {45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0};
    Eigen::Vector3d v = Eigen::Vector3d::Zero(), a = v, omega = v;
    for (int i = 1; i <= 3; ++i) {
      const Kinematics above = spline.At(t + i * h), below = spline.At(t - i * h);
      v += weights[i - 1] / 2e-3 * (above.T_GB.p - below.T_GB.p);
      a += weights[i - 1] / 2e-3 * (above.v_GB - below.v_GB);
      omega +=
          weights[i - 1] / 2e-3 *
          (Log(k.T_GB.R.conjugate() * above.T_GB.R) - Log(k.T_GB.R.conjugate() * below.T_GB.R));
    }
    // Roundings of positions of 100 m over 2 ms; truncation of the stencil.
    EXPECT_LT((k.v_GB - v).norm(), 3e-11);
    EXPECT_LT((k.a_G - a).norm(), 3e-12);
    EXPECT_LT((k.omega_B - omega).norm(), 1e-11);
  }
  EXPECT_GT(tested, 100);
}

TEST(PoseSpline, IsContinuousAtKnots) {
  const PoseSpline spline = PoseSpline::Fit(Sample(200.0, 2.0), 0.08);
  for (int knot = 1; knot < 25; ++knot) {
    const Timestamp t = spline.start() + knot * 80000000LL;
    const Kinematics before = spline.At(t - 1), after = spline.At(t);
    // One nanosecond apart: rates of change of up to 20 per second, and roundings.
    EXPECT_LT(BoxMinus(after.T_GB.R, before.T_GB.R).norm(), 1e-8);
    EXPECT_LT((after.T_GB.p - before.T_GB.p).norm(), 1e-8);
    EXPECT_LT((after.v_GB - before.v_GB).norm(), 1e-7);
    EXPECT_LT((after.a_G - before.a_G).norm(), 1e-7);
    EXPECT_LT((after.omega_B - before.omega_B).norm(), 1e-7);
  }
}

TEST(PoseSpline, ErrorsFallWithTheKnotSpacing) {
  // Degree 5: position to order 6, velocity to 5, acceleration to 4; half the spacing takes 64, 32
  // and 16 of them. Rotations do not commute: order 3 and 2 where the axis turns. Smoothing so
  // small that it plays no part.
  const std::vector<StampedPose> poses = Sample(200.0, 4.0);
  const Errors coarse = WorstErrors(PoseSpline::Fit(poses, 0.2, 1e-12), 1.0);
  const Errors middle = WorstErrors(PoseSpline::Fit(poses, 0.1, 1e-12), 1.0);
  const Errors fine = WorstErrors(PoseSpline::Fit(poses, 0.05, 1e-12), 1.0);
  EXPECT_NEAR(std::log2(coarse.position / middle.position), 6.0, 0.5);
  EXPECT_NEAR(std::log2(coarse.velocity / middle.velocity), 5.0, 0.5);
  EXPECT_NEAR(std::log2(coarse.acceleration / middle.acceleration), 4.0, 0.5);
  EXPECT_NEAR(std::log2(middle.rotation / fine.rotation), 3.0, 0.5);
  EXPECT_NEAR(std::log2(middle.rate / fine.rate), 2.0, 0.5);
}

TEST(PoseSpline, FollowsTruthAtBothRates) {
  for (const double rate_hz : {20.0, 200.0}) {
    for (const double spacing_s : {0.05, 0.1}) {
      const Errors worst = WorstErrors(PoseSpline::Fit(Sample(rate_hz, 10.0), spacing_s), 0.3);
      // Measured: 6e-7 rad, 4e-7 m, 1.3e-5 m/s, 4e-5 rad/s, 5e-4 m/s^2 at 0.1 s; a tenth of a
      // millimetre and of the noise of an IMU's samples would do.
      EXPECT_LT(worst.rotation, 2e-6);
      EXPECT_LT(worst.position, 2e-6);
      EXPECT_LT(worst.velocity, 5e-5);
      EXPECT_LT(worst.rate, 1e-4);
      EXPECT_LT(worst.acceleration, 2e-3);
    }
  }
}

TEST(PoseSpline, BridgesGaps) {
  std::vector<StampedPose> poses = Sample(200.0, 10.0);
  // 0.2 s without a pose: four knots.
  std::erase_if(poses, [](const StampedPose& pose) {
    const double t = SecondsBetween(kStart, pose.timestamp);
    return t > 5.0 && t < 5.195;
  });
  const Errors worst = WorstErrors(PoseSpline::Fit(poses, 0.05), 0.3);
  // Interpolated by a smooth curve, no swing: half a gap of 0.2 s, fourth derivatives of 14 m/s^4.
  EXPECT_LT(worst.position, 5e-3);
  EXPECT_LT(worst.rotation, 5e-3);
}

TEST(PoseSpline, AveragesNoise) {
  Random random(2);
  std::vector<StampedPose> poses = Sample(200.0, 10.0);
  for (StampedPose& pose : poses) {
    pose.T_GB.p += 1e-3 * RandomVector(&random);
    pose.T_GB.R = BoxPlus(pose.T_GB.R, 1e-3 * RandomVector(&random));
  }
  const PoseSpline spline = PoseSpline::Fit(poses, 0.1);
  // 2001 poses, about 105 control points: residuals keep sqrt(1 - 105/2001) of sigma.
  double rotation2 = 0.0, position2 = 0.0;
  for (const StampedPose& pose : poses) {
    rotation2 += spline.Residual(pose).head<3>().squaredNorm();
    position2 += spline.Residual(pose).tail<3>().squaredNorm();
  }
  const double n = 3.0 * static_cast<double>(poses.size());
  // Relative spread of a standard deviation from 6000 numbers: 0.9 %; three of it.
  const double expected = 1e-3 * std::sqrt(1.0 - 105.0 / 2001.0);
  EXPECT_NEAR(std::sqrt(rotation2 / n), expected, 0.03 * expected);
  EXPECT_NEAR(std::sqrt(position2 / n), expected, 0.03 * expected);
  EXPECT_LT(WorstErrors(spline, 0.3).position, 2e-3);
}

TEST(PoseSpline, FitIsTheLeastSquaresOptimum) {
  // A quintic in time is in the spline's span: fitted exactly, rotation about one axis as well.
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.01 * i;
    const double f = 1.0 + t - 2.0 * t * t + std::pow(t, 3) - std::pow(t, 4) + 3.0 * std::pow(t, 5);
    poses.push_back({ToNanoseconds(t), {ExpQuaternion({0.0, 0.6 * f, 0.8 * f}), {f, -f, 2 * f}}});
  }
  const PoseSpline spline = PoseSpline::Fit(poses, 0.1, 1e-14);
  for (const StampedPose& pose : poses) EXPECT_LT(spline.Residual(pose).norm(), 1e-10);
  const Kinematics k = spline.At(500000000);
  const double f1 = 1.0 - 2.0 + 0.75 - 0.5 + 15.0 / 16.0;
  const double f2 = -4.0 + 3.0 - 3.0 + 60.0 / 8.0;
  EXPECT_LT((k.v_GB - f1 * Eigen::Vector3d(1, -1, 2)).norm(), 1e-9);
  EXPECT_LT((k.omega_B - f1 * Eigen::Vector3d(0, 0.6, 0.8)).norm(), 1e-9);
  EXPECT_LT((k.a_G - f2 * Eigen::Vector3d(1, -1, 2)).norm(), 1e-7);
}

TEST(PoseSpline, RefusesWhatItCannotFit) {
  std::vector<StampedPose> poses = Sample(20.0, 2.0);
  EXPECT_THROW((void)PoseSpline::Fit({poses.begin(), poses.begin() + 5}, 0.1), InputError);
  EXPECT_NO_THROW((void)PoseSpline::Fit({poses.begin(), poses.begin() + 6}, 0.1));
  EXPECT_THROW((void)PoseSpline::Fit(poses, 0.01), InputError) << "0.05 s are five knots";
  std::swap(poses[10], poses[11]);
  EXPECT_THROW((void)PoseSpline::Fit(poses, 0.1), InputError);
  poses[10] = poses[11];
  EXPECT_THROW((void)PoseSpline::Fit(poses, 0.1), InputError);
}

TEST(PoseSplineDeathTest, RefusesInstantsOutside) {
  const PoseSpline spline = PoseSpline::Fit(Sample(20.0, 2.0), 0.1);
  EXPECT_EQ(spline.start(), kStart);
  EXPECT_EQ(spline.end(), kStart + 2000000000);
  (void)spline.At(spline.end());
  EXPECT_DEATH((void)spline.At(spline.start() - 1), "");
  EXPECT_DEATH((void)spline.At(spline.end() + 1), "");
}

}  // namespace
}  // namespace duet
