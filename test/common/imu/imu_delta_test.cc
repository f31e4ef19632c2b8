#include "common/imu/imu_delta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "common/geometry/so3.h"
#include "common/imu/imu_buffer.h"
#include "common/support/random.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using test::NumericJacobian;
using test::RelativeDifference;

Eigen::Vector3d RandomVector(Random* random, double sigma) {
  return {sigma * random->Normal(), sigma * random->Normal(), sigma * random->Normal()};
}

Eigen::Matrix3d RandomMatrix(Random* random, double sigma) {
  Eigen::Matrix3d M;
  for (int i = 0; i < 9; ++i) M(i / 3, i % 3) = sigma * random->Normal();
  return M;
}

ImuCalibration RandomCalibration(Random* random, double share) {
  ImuCalibration c;
  c.T_g += RandomMatrix(random, share);
  c.T_s = RandomMatrix(random, 1e-3);
  c.T_a += RandomMatrix(random, share);
  return c;
}

ImuBiases RandomBiases(Random* random) {
  return {RandomVector(random, 0.05), RandomVector(random, 0.2)};
}

constexpr ImuNoise kNoise = {1.7e-3, 2e-2, 2e-4, 3e-3};

// Smooth measured rates, t in s.
ImuSample SmoothReading(double t, Timestamp stamp) {
  ImuSample s;
  s.timestamp = stamp;
  s.omega_m = {0.8 * std::sin(2.1 * t + 0.3), 1.1 * std::cos(1.7 * t), 0.6 * std::sin(2.9 * t)};
  s.a_m = {1.5 * std::cos(3.1 * t), 2.0 * std::sin(1.3 * t + 1.0), 9.8 + std::sin(2.3 * t)};
  return s;
}

std::vector<ImuSample> SmoothReadings(double duration_s, int count) {
  std::vector<ImuSample> readings;
  for (int i = 0; i <= count; ++i) {
    const double t = duration_s * i / count;
    readings.push_back(SmoothReading(t, ToNanoseconds(t)));
  }
  return readings;
}

Eigen::Matrix<double, 9, 1> Difference(const ImuDelta& a, const ImuDelta& b) {
  Eigen::Matrix<double, 9, 1> d;
  d << BoxMinus(a.R, b.R), a.s - b.s, a.y - b.y;
  return d;
}

TEST(ImuDelta, ConstantRatesHaveTheClosedForm) {
  const Eigen::Vector3d omega(0.3, -0.5, 0.9);
  const Eigen::Vector3d a(1.0, 2.0, -9.0);
  std::vector<ImuSample> readings;
  for (int i = 0; i <= 200; ++i) readings.push_back({i * 5'000'000LL, omega, a});
  const ImuDelta delta = IntegrateImu(readings, {}, {}, kNoise);
  // s = J_l(omega t) a t; y = integral of s: with the rotation's axis split off, in closed form.
  const double t = 1.0;
  EXPECT_LT(BoxMinus(delta.R, ExpQuaternion(omega * t)).norm(), 1e-11);  // RK4 at h |omega| = 5e-3
  EXPECT_LT((delta.s - LeftJacobian(omega * t) * a * t).norm(), 1e-10);
  const double w = omega.norm();
  const Eigen::Matrix3d K = Hat(omega / w);
  const Eigen::Matrix3d second = 0.5 * t * t * Eigen::Matrix3d::Identity() +
                                 (t / w - std::sin(w * t) / (w * w)) / 1.0 * K +
                                 (0.5 * t * t - (1.0 - std::cos(w * t)) / (w * w)) * K * K;
  EXPECT_LT((delta.y - second * a).norm(), 1e-10);
}

TEST(ImuDelta, IntegratorIsOfFourthOrderInTheRates) {
  // Rates that are linear in time are exactly what the integrator sees, so what is left is the
  // Runge-Kutta error itself.
  const auto integrate = [](int count) {
    std::vector<ImuSample> readings;
    for (int i = 0; i <= count; ++i) {
      const double t = 1.0 * i / count;
      readings.push_back({ToNanoseconds(t), Eigen::Vector3d(2.0 * t, 1.0 - 3.0 * t, 0.5 + t),
                          Eigen::Vector3d(3.0 - t, 5.0 * t, 9.0)});
    }
    return IntegrateImu(readings, {}, {}, kNoise);
  };
  const ImuDelta exact = integrate(5000);
  const double coarse = Difference(integrate(20), exact).norm();
  const double fine = Difference(integrate(40), exact).norm();
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.3);
}

TEST(ImuDelta, JacobiansAreDerivativesOfTheIntegrator) {
  // 0.2 s at 200 Hz, both ways in time; T matrices up to 5 % off the identity (T_s up to 5e-3 rad/s
  // per m/s^2). Every block of (theta, s, y) against (b_g, b_a, T_g, T_s, T_a) by itself.
  Random random(11);
  double worst = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    ImuCalibration calibration;
    const auto uniform = [&random](double bound) {
      return Eigen::Matrix3d::NullaryExpr([&]() { return random.Uniform(-bound, bound); }).eval();
    };
    calibration.T_g += uniform(0.05);
    calibration.T_s += uniform(0.005);
    calibration.T_a += uniform(0.05);
    const ImuBiases biases = RandomBiases(&random);
    std::vector<ImuSample> readings;
    const double begin_s = random.Uniform(0.0, 10.0);
    for (int i = 0; i <= 40; ++i) {
      readings.push_back(SmoothReading(begin_s + 0.005 * i, ToNanoseconds(0.005 * i)));
    }
    if (trial % 2 == 1) std::reverse(readings.begin(), readings.end());
    const ImuDelta delta = IntegrateImu(readings, biases, calibration, kNoise);
    const auto moved = [&](const Eigen::Matrix<double, 33, 1>& x) -> Vector9d {
      ImuBiases b = biases;
      b.b_g += x.segment<3>(0);
      b.b_a += x.segment<3>(3);
      const ImuCalibration c = ImuCalibrationFromVector(ToVector(calibration) + x.segment<27>(6));
      return Difference(
          IntegrateImu(
              readings, b, c, kNoise,
              {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false}),
          delta);
    };
    const Eigen::Matrix<double, 9, 33> numeric =
        NumericJacobian(moved, Eigen::Matrix<double, 33, 1>::Zero(), 1e-2);
    Eigen::Matrix<double, 9, 33> analytic;
    analytic << delta.J_b_g, delta.J_b_a, delta.J_T;
    constexpr std::array<std::pair<int, int>, 5> kColumns = {
        {{0, 3}, {3, 3}, {6, 9}, {15, 9}, {24, 9}}};
    for (int row = 0; row < 9; row += 3) {
      for (const auto& [column, width] : kColumns) {
        // No block vanishes: relative to its largest number.
        const double off = RelativeDifference(analytic.block(row, column, 3, width),
                                              numeric.block(row, column, 3, width));
        worst = std::max(worst, off);
        // Simpson's rule along the step is off by (|omega| h)^4 of a block, 1e-8.
        EXPECT_LT(off, 1e-6) << "rows " << row << " columns " << column << " trial " << trial;
      }
    }
  }
  std::printf("largest relative difference of a block: %.1e\n", worst);
}

TEST(ImuDelta, CompositionEqualsTheWhole) {
  Random random(5);
  const ImuCalibration calibration = RandomCalibration(&random, 0.05);
  const ImuBiases biases = RandomBiases(&random);
  const auto readings = SmoothReadings(0.4, 80);
  const std::span<const ImuSample> all(readings);
  const ImuDelta whole = IntegrateImu(all, biases, calibration, kNoise);
  const ImuDelta composed = Compose(IntegrateImu(all.first(31), biases, calibration, kNoise),
                                    IntegrateImu(all.subspan(30), biases, calibration, kNoise));
  EXPECT_LT(Difference(composed, whole).norm(), 1e-12);  // rounding
  EXPECT_LT(RelativeDifference(composed.J_b_g, whole.J_b_g), 1e-12);
  EXPECT_LT(RelativeDifference(composed.J_b_a, whole.J_b_a), 1e-12);
  EXPECT_LT(RelativeDifference(composed.J_T, whole.J_T), 1e-12);
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      EXPECT_LT(RelativeDifference(composed.covariance.block<3, 3>(3 * i, 3 * j),
                                   whole.covariance.block<3, 3>(3 * i, 3 * j), 1e-16),
                1e-9)
          << i << j;
    }
  }
}

TEST(ImuDelta, BackwardsUndoesForwards) {
  const auto forwards = SmoothReadings(0.3, 60);
  auto backwards = forwards;
  std::reverse(backwards.begin(), backwards.end());
  const ImuDelta delta =
      Compose(IntegrateImu(forwards, {}, {}, kNoise), IntegrateImu(backwards, {}, {}, kNoise));
  EXPECT_EQ(delta.dt_s, 0.0);
  // Each way has its own fourth-order error.
  EXPECT_LT(BoxMinus(delta.R, Eigen::Quaterniond::Identity()).norm(), 1e-10);
  EXPECT_LT(delta.s.norm(), 1e-9);
  EXPECT_LT(delta.y.norm(), 1e-9);
}

TEST(ImuDelta, CovarianceIsThatOfSimulatedNoise) {
  Random random(77);
  const ImuCalibration calibration = RandomCalibration(&random, 0.05);
  const auto clean = SmoothReadings(0.5, 100);
  const double dt = 0.005;
  // Exaggerated walks, so that every block is visible.
  const ImuNoise noise = {1e-2, 1e-1, 2e-2, 0.2};
  const ImuDelta nominal = IntegrateImu(clean, {}, calibration, noise);
  constexpr int kRuns = 4000;
  Matrix15d sum = Matrix15d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    auto noisy = clean;
    ImuBiases walk;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      // Truth has walking biases; the estimate integrates the same readings with constant ones, so
      // its error is that of minus the noise.
      noisy[i].omega_m -= walk.b_g + RandomVector(&random, noise.gyroscope_density / std::sqrt(dt));
      noisy[i].a_m -= walk.b_a + RandomVector(&random, noise.accelerometer_density / std::sqrt(dt));
      walk.b_g += RandomVector(&random, noise.gyroscope_random_walk * std::sqrt(dt));
      walk.b_a += RandomVector(&random, noise.accelerometer_random_walk * std::sqrt(dt));
    }
    const ImuDelta truth = IntegrateImu(
        noisy, {}, calibration, noise,
        {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false});
    Vector15d e;
    e << Difference(truth, nominal), walk.b_g, walk.b_a;
    sum += e * e.transpose();
  }
  const Matrix15d sampled = sum / kRuns;
  // Whitened by the claimed covariance it must be the identity: an entry has a standard deviation
  // of sqrt(2 / 4000) = 0.022; 5 sigma, plus 1 % for the ends of the sampled noise.
  const Eigen::LLT<Matrix15d> llt(nominal.covariance);
  ASSERT_EQ(llt.info(), Eigen::Success);
  const Matrix15d L = llt.matrixL();
  const Matrix15d white = L.triangularView<Eigen::Lower>().solve(
      L.triangularView<Eigen::Lower>().solve(sampled).transpose());
  EXPECT_LT((white - Matrix15d::Identity()).cwiseAbs().maxCoeff(), 0.13);
}

TEST(ImuDelta, FirstOrderCorrectionIsOfFirstOrder) {
  Random random(3);
  const auto readings = SmoothReadings(0.2, 40);
  const ImuDelta delta = IntegrateImu(readings, {}, {}, kNoise);
  const ImuBiases direction = RandomBiases(&random);
  const Eigen::Matrix<double, 27, 1> dT = Eigen::Matrix<double, 27, 1>::Constant(0.02);
  const auto error_at = [&](double scale) {
    const ImuBiases b = {scale * direction.b_g, scale * direction.b_a};
    const ImuCalibration c = ImuCalibrationFromVector(ToVector({}) + scale * dT);
    const CorrectedDelta corrected = CorrectToFirstOrder(delta, b, c);
    const ImuDelta exact = IntegrateImu(readings, b, c, kNoise);
    return BoxMinus(corrected.R, exact.R).norm() + (corrected.s - exact.s).norm() +
           (corrected.y - exact.y).norm();
  };
  EXPECT_NEAR(std::log2(error_at(0.2) / error_at(0.1)), 2.0, 0.15);
  EXPECT_EQ(DistanceFromLinearization(delta, {}, {}), 0.0);
}

TEST(ImuModel, CorrectionInvertsTheErrorModelAndItsJacobiansAreDerivatives) {
  Random random(9);
  for (int trial = 0; trial < 200; ++trial) {
    const ImuCalibration calibration = RandomCalibration(&random, 0.05);
    const ImuBiases biases = RandomBiases(&random);
    const ImuRates rates = {RandomVector(&random, 1.0), RandomVector(&random, 9.0)};
    const ImuRates measured = DistortRates(rates, calibration, biases);
    const ImuCorrection correction(calibration, biases);
    const ImuRates back = correction(measured.omega_B, measured.a_B);
    EXPECT_LT((back.omega_B - rates.omega_B).norm(), 1e-13);
    EXPECT_LT((back.a_B - rates.a_B).norm(), 1e-13);
    Eigen::Matrix<double, 3, 27> J_omega;
    Eigen::Matrix<double, 3, 27> J_a;
    correction.CalibrationJacobians(rates, &J_omega, &J_a);
    const Eigen::MatrixXd numeric = NumericJacobian(
        [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
          const ImuCorrection c(ImuCalibrationFromVector(ToVector(calibration) + x.head<27>()),
                                biases);
          const ImuRates r = c(measured.omega_B, measured.a_B);
          Eigen::VectorXd stacked(6);
          stacked << r.omega_B, r.a_B;
          return stacked;
        },
        Eigen::VectorXd::Zero(27));
    EXPECT_LT(RelativeDifference(J_omega, numeric.topRows<3>()), 1e-8);
    EXPECT_LT(RelativeDifference(J_a, numeric.bottomRows<3>()), 1e-8);
  }
}

TEST(ImuBuffer, ExtractsIntervalsWithInterpolatedEndsBothWays) {
  ImuBuffer buffer;
  for (int i = 0; i < 10; ++i) {
    buffer.Add({i * 100LL, Eigen::Vector3d::Constant(i), Eigen::Vector3d::Constant(-i)});
  }
  std::vector<ImuSample> out;
  buffer.Extract(150, 420, &out);
  ASSERT_EQ(out.size(), 5U);
  EXPECT_EQ(out.front().timestamp, 150);
  EXPECT_DOUBLE_EQ(out.front().omega_m.x(), 1.5);
  EXPECT_EQ(out[1].timestamp, 200);
  EXPECT_EQ(out.back().timestamp, 420);
  EXPECT_DOUBLE_EQ(out.back().a_m.x(), -4.2);
  std::vector<ImuSample> reversed;
  buffer.Extract(420, 150, &reversed);
  std::reverse(reversed.begin(), reversed.end());
  ASSERT_EQ(reversed.size(), out.size());
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i].timestamp, reversed[i].timestamp);
  buffer.Extract(300, 300, &out);
  EXPECT_EQ(out.size(), 1U);
  buffer.Extract(300, 400, &out);
  EXPECT_EQ(out.size(), 2U);
  EXPECT_FALSE(buffer.Covers(-1, 100));
  EXPECT_FALSE(buffer.Covers(901, 100));
  buffer.DropBefore(450);
  EXPECT_EQ(buffer.first(), 400);
  EXPECT_TRUE(buffer.Covers(450, 900));
}

TEST(ImuBuffer, FindsTheLongestGapAroundAnInterval) {
  ImuBuffer buffer;
  for (Timestamp t : {0LL, 10LL, 20LL, 70LL, 80LL}) buffer.Add({t * 1'000'000, {}, {}});
  EXPECT_DOUBLE_EQ(buffer.LongestGap(0, 20'000'000), 0.01);
  EXPECT_DOUBLE_EQ(buffer.LongestGap(15'000'000, 75'000'000), 0.05);
  EXPECT_DOUBLE_EQ(buffer.LongestGap(30'000'000, 40'000'000), 0.05);
}

}  // namespace
}  // namespace duet
