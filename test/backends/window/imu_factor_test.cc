#include "backends/window/imu_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "common/geometry/so3.h"
#include "test/backends/window/random_window.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using window_test::RandomVector;
using window_test::RandomWindow;

struct FactorState {
  NavState nav_i, nav_j;
  ImuBiases biases_i, biases_j;
  ImuCalibration calibration;
};

Vector15d Residual(const ImuDelta& delta, const FactorState& x) {
  Vector15d r;
  EvaluateImuFactor(delta, x.nav_i, x.biases_i, x.nav_j, x.biases_j, x.calibration,
                    Eigen::Vector3d(0, 0, -9.81), &r);
  return r;
}

// x (+) error over (15 of i, 15 of j, 27).
FactorState Moved(const FactorState& x, const Eigen::Matrix<double, 57, 1>& error) {
  FactorState moved = x;
  const InertialState i = BoxPlus(InertialState{0, x.nav_i, x.biases_i}, error.segment<15>(0));
  const InertialState j = BoxPlus(InertialState{0, x.nav_j, x.biases_j}, error.segment<15>(15));
  moved.nav_i = i.nav;
  moved.biases_i = i.biases;
  moved.nav_j = j.nav;
  moved.biases_j = j.biases;
  moved.calibration = ImuCalibrationFromVector(ToVector(x.calibration) + error.tail<27>());
  return moved;
}

TEST(ImuFactor, JacobiansAgreeWithNumericDifferentiation) {
  Random random(1);
  const auto uniform = [&random](double bound) {
    return Eigen::Matrix3d::NullaryExpr([&]() { return random.Uniform(-bound, bound); }).eval();
  };
  for (int trial = 0; trial < 200; ++trial) {
    RandomWindow window(2, 0, 100 + trial);
    // Integrated with T matrices up to 5 % off the identity, and corrected to others as far away;
    // states far off the delta's prediction, so that no block is near its easy case (every other
    // one at it).
    ImuCalibration calibration;
    calibration.T_g += uniform(0.05);
    calibration.T_s += uniform(0.005);
    calibration.T_a += uniform(0.05);
    std::vector<ImuSample> readings;
    window.imu.Extract(window.frames[0].state.instant, window.frames[1].state.instant, &readings);
    const ImuDelta delta = IntegrateImu(readings, window.frames[0].state.biases, calibration,
                                        window_test::EurocNoise());
    FactorState x{window.frames[0].state.nav, window.frames[1].state.nav,
                  window.frames[0].state.biases, window.frames[1].state.biases, calibration};
    x.nav_j.R_GB = BoxPlus(x.nav_j.R_GB, RandomVector(&random, trial % 2 == 0 ? 0.3 : 1e-8));
    x.nav_j.v_GB += RandomVector(&random, 1.0);
    x.biases_i.b_g += RandomVector(&random, 0.02);
    x.calibration.T_g += uniform(0.05);
    x.calibration.T_s += uniform(0.005);
    x.calibration.T_a += uniform(0.05);

    Vector15d r;
    ImuFactorJacobians J;
    EvaluateImuFactor(delta, x.nav_i, x.biases_i, x.nav_j, x.biases_j, x.calibration,
                      Eigen::Vector3d(0, 0, -9.81), &r, &J);
    Eigen::Matrix<double, 15, 57> analytic;
    analytic << J.J_i, J.J_j, J.J_T;
    const Eigen::Matrix<double, 15, 57> numeric = test::NumericJacobian(
        [&](const Eigen::Matrix<double, 57, 1>& error) -> Vector15d {
          return Residual(delta, Moved(x, error));
        },
        Eigen::Matrix<double, 57, 1>::Zero(), 1e-2);
    // 3 x 3 blocks, relative to their largest number or to 1e-5: many blocks are zero, where the
    // differences round to 1e-12; the least that is none (y against b_g, 0.1 s) is 1e-3.
    for (int row = 0; row < 15; row += 3) {
      for (int column = 0; column < 57; column += 3) {
        EXPECT_LT(test::RelativeDifference(analytic.block<3, 3>(row, column),
                                           numeric.block<3, 3>(row, column), 1e-5),
                  1e-6)
            << "rows " << row << " columns " << column << " trial " << trial;
      }
    }
  }
}

TEST(ImuFactor, ResidualIsZeroAtThePredictedState) {
  RandomWindow window(2, 0, 7);
  const ImuDelta& delta = window.frames[1].link->delta;
  FactorState x{window.frames[0].state.nav, {}, delta.biases, delta.biases, delta.calibration};
  x.nav_j = Predict(x.nav_i, delta, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_LT(Residual(delta, x).norm(), 1e-13);  // rounding of numbers of order 1
}

TEST(ImuFactor, ResidualIsTheDeltasError) {
  // Where the true motion is Exp(theta) dR, s + ds, y + dy, the residual reads (theta, ds, dy): the
  // vector that the delta's covariance belongs to.
  RandomWindow window(2, 0, 8);
  ImuDelta delta = window.frames[1].link->delta;
  FactorState x{window.frames[0].state.nav, {}, delta.biases, delta.biases, delta.calibration};
  const Eigen::Vector3d theta(0.02, -0.01, 0.03);
  ImuDelta moved = delta;
  moved.R = BoxPlus(delta.R, theta);
  moved.s += Eigen::Vector3d(0.1, 0.2, 0.3);
  moved.y += Eigen::Vector3d(-0.1, 0.0, 0.1);
  x.nav_j = Predict(x.nav_i, moved, Eigen::Vector3d(0, 0, -9.81));
  Vector15d expected = Vector15d::Zero();
  expected.head<9>() << theta, 0.1, 0.2, 0.3, -0.1, 0.0, 0.1;
  EXPECT_LT((Residual(delta, x) - expected).norm(), 1e-13);
}

TEST(ImuFactor, WhiteningTurnsTheCovarianceIntoTheIdentity) {
  RandomWindow window(2, 0, 9);
  const ImuLink& link = *window.frames[1].link;
  const Matrix15d& W = link.sqrt_information;
  const Matrix15d whitened = W * link.delta.covariance * W.transpose();
  // Covariances of 1e-9 (position) beside 1e-6: condition number 1e7 of a 15 x 15 Cholesky.
  EXPECT_LT((whitened - Matrix15d::Identity()).norm(), 1e-8);
}

TEST(ImuFactor, FirstOrderCorrectionIsWrongByTheSquareOfTheMove) {
  // The ground of reintegration_threshold: at a distance d from the linearization point (largest
  // change of theta, s, y) the corrected delta is off by about d^2.
  RandomWindow window(2, 0, 10);
  const ImuDelta& delta = window.frames[1].link->delta;
  std::vector<ImuSample> readings;
  window.imu.Extract(delta.start, delta.end, &readings);
  for (const double scale : {0.01, 0.1, 1.0}) {
    ImuBiases biases = delta.biases;
    biases.b_g += scale * Eigen::Vector3d(0.1, -0.2, 0.1);
    biases.b_a += scale * Eigen::Vector3d(0.3, 0.1, -0.2);
    const double distance = DistanceFromLinearization(delta, biases, delta.calibration);
    const CorrectedDelta corrected = CorrectToFirstOrder(delta, biases, delta.calibration);
    const ImuDelta exact =
        IntegrateImu(readings, biases, delta.calibration, window_test::EurocNoise());
    const double error = std::max({BoxMinus(exact.R, corrected.R).norm(),
                                   (exact.s - corrected.s).norm(), (exact.y - corrected.y).norm()});
    EXPECT_LT(error, 2.0 * distance * distance + 1e-14) << "distance " << distance;
  }
}

}  // namespace
}  // namespace duet
