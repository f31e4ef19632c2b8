// Both ways of making Phi, Gamma and Q, from the IMU delta and by the thesis's trapezoids (B.49 to
// B.63), against numeric differentiation of the integrator as the step shrinks.

#include "backends/msckf/trapezoid_delta.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "backends/msckf/transition.h"
#include "common/geometry/so3.h"
#include "test/backends/msckf/random_state.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using test::kGravity;
using test::RandomVector;

const ImuNoise kTrapezoidNoise = {.gyroscope_density = 2e-3,
                                  .accelerometer_density = 2e-2,
                                  .gyroscope_random_walk = 1e-4,
                                  .accelerometer_random_walk = 3e-3};

struct LinearInterval {
  InertialState start;
  ImuCalibration calibration;
  Eigen::Vector3d omega_0, omega_rate, a_0, a_rate;

  // Readings that are linear in time, so that their interpolation is exact and only the rule of a
  // step is left. 0.2 s in `steps` steps.
  [[nodiscard]] std::vector<ImuSample> Readings(int steps) const {
    std::vector<ImuSample> readings;
    for (int i = 0; i <= steps; ++i) {
      const double t = 0.2 * i / steps;
      readings.push_back({ToNanoseconds(t), omega_0 + t * omega_rate, a_0 + t * a_rate});
    }
    return readings;
  }
};

// T matrices up to 5 % off the identity, T_s up to 0.05 rad/s per g; 2 rad/s, a few m/s^2 beside g.
LinearInterval RandomLinearInterval(Random* random) {
  const auto uniform = [random](double bound) {
    Eigen::Matrix3d M;
    for (double& x : M.reshaped()) x = random->Uniform(-bound, bound);
    return M;
  };
  LinearInterval interval;
  interval.calibration.T_g += uniform(0.05);
  interval.calibration.T_s = uniform(0.005);
  interval.calibration.T_a += uniform(0.05);
  interval.start.nav.R_GB = ExpQuaternion(RandomVector(random, 1.0));
  interval.start.nav.p_GB = RandomVector(random, 3.0);
  interval.start.nav.v_GB = RandomVector(random, 1.0);
  interval.start.biases = {RandomVector(random, 0.02), RandomVector(random, 0.1)};
  interval.omega_0 = RandomVector(random, 1.0);
  interval.omega_rate = RandomVector(random, 5.0);
  interval.a_0 = Eigen::Vector3d(0, 0, 9.8) + RandomVector(random, 2.0);
  interval.a_rate = RandomVector(random, 20.0);
  return interval;
}

using TransitionRows = Eigen::Matrix<double, 9, 42>;  // Phi's first nine rows, then Gamma

// d(theta, p, v at the end) / d(state at the start, T matrices) of the integrator itself.
TransitionRows NumericTransition(const LinearInterval& interval,
                                 std::span<const ImuSample> readings) {
  const auto integrate = [&](const InertialState& start, const ImuCalibration& calibration) {
    const ImuDelta delta = IntegrateImu(
        readings, start.biases, calibration, kTrapezoidNoise,
        {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false});
    return Predict(start.nav, delta, kGravity);
  };
  const NavState end = integrate(interval.start, interval.calibration);
  return test::NumericJacobian(
      [&](const Eigen::Matrix<double, 42, 1>& error) -> Vector9d {
        return BoxMinus(
            integrate(BoxPlus(interval.start, Vector15d(error.head<15>())),
                      ImuCalibrationFromVector(ToVector(interval.calibration) + error.tail<27>())),
            end);
      },
      Eigen::Matrix<double, 42, 1>::Zero(), 1e-2);
}

Transition TransitionBy(bool trapezoids, const LinearInterval& interval,
                        std::span<const ImuSample> readings) {
  const ImuDelta delta =
      trapezoids
          ? IntegrateImuByTrapezoids(readings, interval.start.biases, interval.calibration,
                                     kTrapezoidNoise)
          : IntegrateImu(readings, interval.start.biases, interval.calibration, kTrapezoidNoise);
  const NavState end = Predict(interval.start.nav, delta, kGravity);
  return MakeTransition(delta, interval.start.nav, end, kGravity);
}

TransitionRows StackedRows(const Transition& transition) {
  TransitionRows rows;
  rows << transition.Phi.topRows<9>(), transition.Gamma;
  return rows;
}

struct NamedBlock {
  const char* name;
  int column;
  int width;
};
constexpr std::array<NamedBlock, 5> kParameterBlocks = {
    {{"b_g", 9, 3}, {"b_a", 12, 3}, {"T_g", 15, 9}, {"T_s", 24, 9}, {"T_a", 33, 9}}};
constexpr std::array<NamedBlock, 3> kStateBlocks = {{{"theta", 0, 3}, {"p", 3, 3}, {"v", 6, 3}}};

TEST(TrapezoidDelta, MotionIsTheDeltasToTheBit) {
  Random random(1);
  const LinearInterval interval = RandomLinearInterval(&random);
  const std::vector<ImuSample> readings = interval.Readings(40);
  const ImuDelta a =
      IntegrateImu(readings, interval.start.biases, interval.calibration, kTrapezoidNoise);
  const ImuDelta b = IntegrateImuByTrapezoids(readings, interval.start.biases, interval.calibration,
                                              kTrapezoidNoise);
  EXPECT_EQ(a.R.coeffs(), b.R.coeffs());
  EXPECT_EQ(a.s, b.s);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.end, b.end);
}

TEST(TrapezoidDelta, OrdersOfConvergence) {
  // Blocks against biases and T matrices at 8 and 16 steps over 0.2 s (25 and 12.5 ms: coarse, so
  // that the delta's errors stand above rounding) against the integrator's derivative at 640.
  Random random(2);
  std::array<std::array<TransitionRows, 2>, 2> errors =
      {};  // [rule][steps], squares summed over intervals
  for (auto& rule : errors) rule.fill(TransitionRows::Zero());
  TransitionRows scale = TransitionRows::Zero();
  for (int trial = 0; trial < 10; ++trial) {
    const LinearInterval interval = RandomLinearInterval(&random);
    const TransitionRows exact = NumericTransition(interval, interval.Readings(640));
    scale += exact.cwiseAbs2();
    for (int rule = 0; rule < 2; ++rule) {
      for (int halved = 0; halved < 2; ++halved) {
        const Transition transition =
            TransitionBy(rule == 1, interval, interval.Readings(halved == 0 ? 8 : 16));
        errors[rule][halved] += (StackedRows(transition) - exact).cwiseAbs2();
      }
    }
  }
  std::printf("%-12s %-10s %-10s %5s   %-10s %-10s %5s\n", "block", "delta 25ms", "12.5 ms",
              "order", "trap. 25ms", "12.5 ms", "order");
  for (const NamedBlock& row : kStateBlocks) {
    for (const NamedBlock& column : kParameterBlocks) {
      const auto norm = [&](const TransitionRows& squares) {
        return std::sqrt(squares.block(row.column, column.column, row.width, column.width).sum());
      };
      std::array<double, 2> order = {};
      std::array<std::array<double, 2>, 2> relative = {};
      for (int rule = 0; rule < 2; ++rule) {
        for (int halved = 0; halved < 2; ++halved) {
          relative[rule][halved] = norm(errors[rule][halved]) / norm(scale);
        }
        order[rule] = std::log2(relative[rule][0] / relative[rule][1]);
      }
      std::printf("%-5s %-6s %10.2e %10.2e %5.2f   %10.2e %10.2e %5.2f\n", row.name, column.name,
                  relative[0][0], relative[0][1], order[0], relative[1][0], relative[1][1],
                  order[1]);
      const std::string name = std::string(row.name) + " " + column.name;
      const bool bias = column.width == 3;
      EXPECT_GT(order[0], 3.7) << name;
      EXPECT_NEAR(order[1], bias ? 2.0 : 1.0, 0.3) << name;
    }
  }
}

TEST(TrapezoidDelta, TransitionAgreesWithTheIntegratorAt200Hz) {
  Random random(3);
  std::array<std::array<double, 42>, 2> worst = {};
  for (int trial = 0; trial < 200; ++trial) {
    const LinearInterval interval = RandomLinearInterval(&random);
    const std::vector<ImuSample> readings = interval.Readings(40);
    const TransitionRows exact = NumericTransition(interval, readings);
    for (int rule = 0; rule < 2; ++rule) {
      const Transition transition = TransitionBy(rule == 1, interval, readings);
      const TransitionRows rows = StackedRows(transition);
      // Against the state at the start both are exact.
      EXPECT_LT((rows - exact).leftCols<9>().cwiseAbs().maxCoeff(), 1e-11);
      EXPECT_TRUE(transition.Phi.bottomRows<6>().leftCols<9>().isZero(0.0));
      EXPECT_TRUE((transition.Phi.bottomRightCorner<6, 6>().isIdentity(0.0)));
      for (const NamedBlock& column : kParameterBlocks) {
        for (const NamedBlock& row : kStateBlocks) {
          const auto block = [&](const TransitionRows& all) {
            return all.block(row.column, column.column, row.width, column.width);
          };
          double& off = worst[rule][column.column];
          off = std::max(off, test::RelativeDifference(block(rows), block(exact)));
        }
      }
    }
  }
  for (const NamedBlock& column : kParameterBlocks) {
    std::printf("d/d %s: largest relative difference at 5 ms: delta %.1e, trapezoids %.1e\n",
                column.name, worst[0][column.column], worst[1][column.column]);
    EXPECT_LT(worst[0][column.column], 1e-6);
    // Second order in |omega| h = 1e-2 for biases; first order for T matrices: over a step the
    // rates change by 5 ms of 5 rad/s^2 and 20 m/s^3, a few percent of what they are, more where a
    // draw of omega is small.
    EXPECT_LT(worst[1][column.column], column.width == 3 ? 2e-3 : 0.3);
  }
}

TEST(TrapezoidDelta, CovarianceIsTheDeltasToSecondOrder) {
  Random random(4);
  const LinearInterval interval = RandomLinearInterval(&random);
  const auto whitened_difference = [&](int steps) {
    const Matrix15d exact = TransitionBy(false, interval, interval.Readings(steps)).Q;
    const Matrix15d Q = TransitionBy(true, interval, interval.Readings(steps)).Q;
    const Eigen::LLT<Matrix15d> llt(exact);
    EXPECT_EQ(llt.info(), Eigen::Success);
    const Matrix15d L = llt.matrixL();
    const auto lower = L.triangularView<Eigen::Lower>();
    const Matrix15d white = lower.solve(Matrix15d(lower.solve(Q).transpose()));
    return (white - Matrix15d::Identity()).norm();
  };
  const double coarse = whitened_difference(20);
  const double fine = whitened_difference(40);
  std::printf("whitened difference of Q at 100 Hz %.2e, at 200 Hz %.2e\n", coarse, fine);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.3);
  EXPECT_LT(fine, 0.02);
}

}  // namespace
}  // namespace duet
