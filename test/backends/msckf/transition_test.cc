// Appendix B: the transition of the error over an IMU interval.

#include "backends/msckf/transition.h"

#include <gtest/gtest.h>

#include "backends/msckf/propagation.h"
#include "common/geometry/so3.h"
#include "common/imu/imu_buffer.h"
#include "test/backends/msckf/random_state.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using test::kGravity;
using test::RandomCovariance;
using test::RandomVector;

const ImuNoise kNoise = {.gyroscope_density = 2e-3,
                         .accelerometer_density = 2e-2,
                         .gyroscope_random_walk = 1e-4,
                         .accelerometer_random_walk = 3e-3};

struct Interval {
  std::vector<ImuSample> readings;
  InertialState start;
  ImuCalibration calibration;

  [[nodiscard]] ImuDelta Delta() const {
    return IntegrateImu(readings, start.biases, calibration, kNoise);
  }
};

Interval MakeInterval(Random* random) {
  Interval interval;
  test::MovingImu().Extract(ToNanoseconds(0.3012), ToNanoseconds(0.4034), &interval.readings);
  interval.calibration = test::StereoRig().imu;
  interval.start.nav.R_GB = ExpQuaternion(RandomVector(random, 1.0));
  interval.start.nav.p_GB = RandomVector(random, 3.0);
  interval.start.nav.v_GB = RandomVector(random, 1.0);
  interval.start.biases.b_g = RandomVector(random, 0.02);
  interval.start.biases.b_a = RandomVector(random, 0.1);
  return interval;
}

// The end state's error for an error (15) of the start and one (27) of the T matrices.
Vector9d EndError(const Interval& interval, const NavState& nominal_end,
                  const Eigen::VectorXd& error) {
  const InertialState start = BoxPlus(interval.start, Vector15d(error.head<15>()));
  const ImuCalibration calibration =
      ImuCalibrationFromVector(ToVector(interval.calibration) + error.tail<27>());
  const ImuDelta delta = IntegrateImu(interval.readings, start.biases, calibration, kNoise);
  return BoxMinus(Predict(start.nav, delta, kGravity), nominal_end);
}

TEST(Transition, EqualsTheDerivativeOfTheIntegratedState) {
  Random random(1);
  const Interval interval = MakeInterval(&random);
  const ImuDelta delta = interval.Delta();
  const NavState end = Predict(interval.start.nav, delta, kGravity);
  const Transition transition = MakeTransition(delta, interval.start.nav, end, kGravity);

  const Eigen::MatrixXd numeric = test::NumericJacobian(
      [&](const Eigen::VectorXd& error) { return EndError(interval, end, error); },
      Eigen::VectorXd::Zero(42));
  // The delta's Jacobians are quadratures of fourth order in the 5 ms step: 1e-7 of their size.
  EXPECT_LT((transition.Phi.topRows<9>() - numeric.leftCols<15>()).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((transition.Gamma - numeric.rightCols<27>()).cwiseAbs().maxCoeff(), 2e-7);
  EXPECT_EQ(transition.Phi.bottomRows<6>(),
            (Eigen::Matrix<double, 6, 15>() << Eigen::Matrix<double, 6, 9>::Zero(),
             Eigen::Matrix<double, 6, 6>::Identity())
                .finished());
}

TEST(Transition, NoiseIsTheDeltasTurnedIntoTheGlobalFrame) {
  Random random(2);
  const Interval interval = MakeInterval(&random);
  const ImuDelta delta = interval.Delta();
  const Transition transition = MakeTransition(
      delta, interval.start.nav, Predict(interval.start.nav, delta, kGravity), kGravity);

  // (theta, s, y, b_g, b_a) in the start's frame -> (theta, p, v, b_g, b_a) in G.
  Matrix15d G = Matrix15d::Zero();
  const Eigen::Matrix3d R_GB = interval.start.nav.R_GB.toRotationMatrix();
  G.block<3, 3>(0, 0) = R_GB;
  G.block<3, 3>(3, 6) = R_GB;
  G.block<3, 3>(6, 3) = R_GB;
  G.bottomRightCorner<6, 6>().setIdentity();
  const Matrix15d expected = G * delta.covariance * G.transpose();
  EXPECT_LT((transition.Q - expected).cwiseAbs().maxCoeff(), 1e-15 * expected.norm());
  EXPECT_TRUE(transition.Q == transition.Q.transpose());
}

// The unobservable directions of a navigation state: turning about gravity, shifting.
Eigen::Matrix<double, 15, 4> Unobservable(const NavState& nav) {
  Eigen::Matrix<double, 15, 4> N = Eigen::Matrix<double, 15, 4>::Zero();
  const Eigen::Vector3d up = -kGravity.normalized();
  N.block<3, 1>(0, 0) = up;
  N.block<3, 1>(3, 0) = up.cross(nav.p_GB);
  N.block<3, 1>(6, 0) = up.cross(nav.v_GB);
  N.block<3, 3>(3, 1).setIdentity();
  return N;
}

TEST(Transition, CarriesUnobservableDirectionsBetweenAnyTwoStates) {
  Random random(3);
  const Interval interval = MakeInterval(&random);
  const ImuDelta delta = interval.Delta();
  NavState start = interval.start.nav;
  NavState end = Predict(start, delta, kGravity);
  // States at which no IMU would arrive: first estimates that were corrected in between.
  start.p_GB += RandomVector(&random, 0.5);
  start.v_GB += RandomVector(&random, 0.5);
  end = BoxPlus(end, Vector9d::Constant(0.3));
  const Transition transition = MakeTransition(delta, start, end, kGravity);
  EXPECT_LT((transition.Phi * Unobservable(start) - Unobservable(end)).cwiseAbs().maxCoeff(),
            1e-14);
}

TEST(Propagation, EqualsTheDenseProduct) {
  Random random(4);
  const Interval interval = MakeInterval(&random);
  const ImuDelta delta = interval.Delta();
  const Transition transition = MakeTransition(
      delta, interval.start.nav, Predict(interval.start.nav, delta, kGravity), kGravity);
  const RigCalibration rig = test::StereoRig();

  struct Case {
    bool T_g, T_s, T_a;
  };
  for (const Case& c : {Case{false, false, false}, Case{true, true, true}, Case{false, true, false},
                        Case{true, false, true}}) {
    CalibrationPriors priors;
    priors.T_g.estimated = c.T_g;
    priors.T_s.estimated = c.T_s;
    priors.T_a.estimated = c.T_a;
    priors.p_CB.estimated = true;
    priors.t_d.estimated = true;
    const CalibrationLayout layout(priors, rig);
    const int n = 15 + layout.size() + 18;
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(n, n);
    F.topLeftCorner<15, 15>() = transition.Phi;
    int column = 15;
    if (c.T_g) F.block<9, 9>(0, column) = transition.Gamma.leftCols<9>(), column += 9;
    if (c.T_s) F.block<9, 9>(0, column) = transition.Gamma.middleCols<9>(9), column += 9;
    if (c.T_a) F.block<9, 9>(0, column) = transition.Gamma.rightCols<9>();

    Eigen::MatrixXd P = RandomCovariance(&random, n);
    Eigen::MatrixXd expected = F * P * F.transpose();
    expected.topLeftCorner<15, 15>() += transition.Q;
    PropagationWorkspace workspace;
    PropagateCovariance(transition, layout, P, &workspace);
    EXPECT_LT((P - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.norm());
    EXPECT_TRUE(P == P.transpose());
  }
}

}  // namespace
}  // namespace duet
