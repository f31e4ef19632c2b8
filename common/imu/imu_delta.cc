#include "common/imu/imu_delta.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/so3.h"
#include "common/imu/delta_step.h"
#include "common/imu/motion_increment.h"
#include "common/support/logging.h"

// How Jacobians and covariance come about. With e = (theta, s, y), theta the left error of R in the
// frame of the start, and rate errors d_omega, d_a:
//
//   theta' = R d_omega,    s' = -[R a]x theta + R d_a,    y' = s
//
// A constant parameter x makes d_omega = W x and d_a = A x. Over one step from zero its effect is
// integrated by Simpson's rule with the rotation of the Runge-Kutta step at both ends and in the
// middle; the effect that came before is carried on as delta_step.h says.

namespace duet {
namespace {

using Matrix3d = Eigen::Matrix3d;
using Vector3d = Eigen::Vector3d;

// Effect of d_omega = W x, d_a = A x over one step; W and A at begin, middle, end.
template <int kColumns>
void SimpsonEffect(const StepGeometry& step,
                   const std::array<Eigen::Matrix<double, 3, kColumns>, 3>& W,
                   const std::array<Eigen::Matrix<double, 3, kColumns>, 3>& A,
                   StepEffect<kColumns>* effect) {
  using Block = Eigen::Matrix<double, 3, kColumns>;
  const double h = step.h_s;
  const Block w0 = step.R[0] * W[0];
  const Block w1 = step.R[1] * W[1];
  const Block w2 = step.R[2] * W[2];
  const Block theta_middle = (h / 24.0) * (5.0 * w0 + 8.0 * w1 - w2);
  effect->theta = (h / 6.0) * (w0 + 4.0 * w1 + w2);
  const Block f0 = step.R[0] * A[0];
  const Block f1 = step.minus_Ra_hat[1] * theta_middle + step.R[1] * A[1];
  const Block f2 = step.minus_Ra_hat[2] * effect->theta + step.R[2] * A[2];
  effect->s = (h / 6.0) * (f0 + 4.0 * f1 + f2);
  effect->y = (h * h / 6.0) * (f0 + 2.0 * f1);
}

// Process noise of one step by two-point Gauss quadrature of the impulse responses to the four
// noises (positive semidefinite by construction; exact for white noise up to the step's rotation).
void AddStepNoise(const StepGeometry& step, const ImuCorrection& correction, const ImuNoise& noise,
                  Matrix15d* P) {
  const Matrix3d RWg = -step.R[1] * correction.T_g_inverse();
  const Matrix3d RWa = step.R[1] * correction.J_omega_ba();
  const Matrix3d RA = -step.R[1] * correction.T_a_inverse();
  const Matrix3d KWg = step.minus_Ra_hat[1] * RWg;
  const Matrix3d KWa = step.minus_Ra_hat[1] * RWa;
  const double root_weight = std::sqrt(0.5 * std::abs(step.h_s));
  Eigen::Matrix<double, 15, 24> G = Eigen::Matrix<double, 15, 24>::Zero();
  for (int point = 0; point < 2; ++point) {
    const double u = step.h_s * (0.5 + (point == 0 ? -0.5 : 0.5) / std::sqrt(3.0));
    const double u2 = 0.5 * u * u;
    const double u3 = u * u * u / 6.0;
    auto block = G.middleCols<12>(12 * point);
    const double g = root_weight * noise.gyroscope_density;
    block.block<3, 3>(0, 0) = g * RWg;
    block.block<3, 3>(3, 0) = g * u * KWg;
    block.block<3, 3>(6, 0) = g * u2 * KWg;
    const double a = root_weight * noise.accelerometer_density;
    block.block<3, 3>(0, 3) = a * RWa;
    block.block<3, 3>(3, 3) = a * (RA + u * KWa);
    block.block<3, 3>(6, 3) = a * (u * RA + u2 * KWa);
    const double wg = root_weight * noise.gyroscope_random_walk;
    block.block<3, 3>(0, 6) = wg * u * RWg;
    block.block<3, 3>(3, 6) = wg * u2 * KWg;
    block.block<3, 3>(6, 6) = wg * u3 * KWg;
    block.block<3, 3>(9, 6) = wg * Matrix3d::Identity();
    const double wa = root_weight * noise.accelerometer_random_walk;
    block.block<3, 3>(0, 9) = wa * u * RWa;
    block.block<3, 3>(3, 9) = wa * (u * RA + u2 * KWa);
    block.block<3, 3>(6, 9) = wa * (u2 * RA + u3 * KWa);
    block.block<3, 3>(12, 9) = wa * Matrix3d::Identity();
  }
  P->noalias() += G * G.transpose();
}

Eigen::Matrix<double, 9, 1> FirstOrderChange(const ImuDelta& delta, const ImuBiases& biases,
                                             const ImuCalibration& calibration) {
  Eigen::Matrix<double, 9, 1> change =
      delta.J_b_g * (biases.b_g - delta.biases.b_g) + delta.J_b_a * (biases.b_a - delta.biases.b_a);
  const Eigen::Matrix<double, 27, 1> dT = ToVector(calibration) - ToVector(delta.calibration);
  if (!dT.isZero(0.0)) change += delta.J_T * dT;
  return change;
}

}  // namespace

ImuDelta IntegrateImu(std::span<const ImuSample> readings, const ImuBiases& biases,
                      const ImuCalibration& calibration, const ImuNoise& noise,
                      const ImuDeltaOptions& options) {
  CHECK(!readings.empty());
  CHECK(!options.covariance || options.bias_jacobians) << "the covariance needs the bias Jacobians";
  ImuDelta delta;
  delta.start = readings.front().timestamp;
  delta.end = readings.back().timestamp;
  delta.dt_s = SecondsBetween(delta.start, delta.end);
  delta.biases = biases;
  delta.calibration = calibration;

  const ImuCorrection correction(calibration, biases);
  const Matrix3d W_g = -correction.T_g_inverse();
  const Matrix3d& W_a = correction.J_omega_ba();
  const Matrix3d A_a = -correction.T_a_inverse();
  const Matrix3d zero = Matrix3d::Zero();

  MotionIncrement motion;
  ImuRates begin = correction(readings[0].omega_m, readings[0].a_m);
  StepGeometry step;
  step.R[2] = Matrix3d::Identity();
  step.minus_Ra_hat[2] = -Hat(begin.a_B);
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const ImuRates end = correction(readings[i].omega_m, readings[i].a_m);
    step.h_s = SecondsBetween(readings[i - 1].timestamp, readings[i].timestamp);
    const MotionIncrement before = motion;
    Eigen::Quaterniond R_middle;
    RungeKuttaStep(begin, end, step.h_s, &motion, &R_middle);

    if (options.bias_jacobians || options.calibration_jacobians) {
      step.R = {step.R[2], R_middle.toRotationMatrix(), motion.R.toRotationMatrix()};
      step.minus_Ra_hat = {step.minus_Ra_hat[2], -Hat(step.R[1] * (0.5 * (begin.a_B + end.a_B))),
                           -Hat(step.R[2] * end.a_B)};
      step.ds = motion.s - before.s;
      step.dy = motion.y - before.y - step.h_s * before.s;
    }
    if (options.bias_jacobians) {
      StepEffect<3> b_g;
      StepEffect<3> b_a;
      SimpsonEffect<3>(step, {W_g, W_g, W_g}, {zero, zero, zero}, &b_g);
      SimpsonEffect<3>(step, {W_a, W_a, W_a}, {A_a, A_a, A_a}, &b_a);
      CarryOn(step, b_g, &delta.J_b_g);
      CarryOn(step, b_a, &delta.J_b_a);
      if (options.covariance) {
        PropagateStepCovariance(step, b_g, b_a, &delta.covariance);
        AddStepNoise(step, correction, noise, &delta.covariance);
      }
    }
    if (options.calibration_jacobians) {
      std::array<Eigen::Matrix<double, 3, 27>, 3> W;
      std::array<Eigen::Matrix<double, 3, 27>, 3> A;
      const ImuRates middle = {0.5 * (begin.omega_B + end.omega_B), 0.5 * (begin.a_B + end.a_B)};
      correction.CalibrationJacobians(begin, &W[0], &A[0]);
      correction.CalibrationJacobians(middle, &W[1], &A[1]);
      correction.CalibrationJacobians(end, &W[2], &A[2]);
      StepEffect<27> effect;
      SimpsonEffect<27>(step, W, A, &effect);
      CarryOn(step, effect, &delta.J_T);
    }
    begin = end;
  }
  delta.R = motion.R;
  delta.s = motion.s;
  delta.y = motion.y;
  delta.covariance = 0.5 * (delta.covariance + delta.covariance.transpose()).eval();
  return delta;
}

ImuDelta Compose(const ImuDelta& first, const ImuDelta& second) {
  CHECK_EQ(first.end, second.start);
  const Matrix3d R1 = first.R.toRotationMatrix();
  const double dt2 = second.dt_s;

  ImuDelta result;
  result.start = first.start;
  result.end = second.end;
  result.dt_s = SecondsBetween(first.start, second.end);
  result.R = (first.R * second.R).normalized();
  result.s = first.s + R1 * second.s;
  result.y = first.y + first.s * dt2 + R1 * second.y;
  result.biases = first.biases;
  result.calibration = first.calibration;

  // e = F1 e1 + F2 e2; the second delta's own error depends on the bias that walked in the first.
  Eigen::Matrix<double, 9, 9> F1 = Eigen::Matrix<double, 9, 9>::Identity();
  F1.block<3, 3>(3, 0) = -Hat(R1 * second.s);
  F1.block<3, 3>(6, 0) = -Hat(R1 * second.y);
  F1.block<3, 3>(6, 3) = dt2 * Matrix3d::Identity();
  const auto rotate = [&R1](const auto& J2) {
    auto rotated = J2.eval();
    for (int block = 0; block < 3; ++block) {
      rotated.template middleRows<3>(3 * block) = R1 * J2.template middleRows<3>(3 * block);
    }
    return rotated;
  };
  const Eigen::Matrix<double, 9, 3> J2_g = rotate(second.J_b_g);
  const Eigen::Matrix<double, 9, 3> J2_a = rotate(second.J_b_a);
  result.J_b_g = F1 * first.J_b_g + J2_g;
  result.J_b_a = F1 * first.J_b_a + J2_a;
  result.J_T = F1 * first.J_T + rotate(second.J_T);

  Matrix15d F = Matrix15d::Identity();
  F.topLeftCorner<9, 9>() = F1;
  F.block<9, 3>(0, 9) = J2_g;
  F.block<9, 3>(0, 12) = J2_a;
  Matrix15d F2 = Matrix15d::Identity();
  for (int block = 0; block < 3; ++block) F2.block<3, 3>(3 * block, 3 * block) = R1;
  result.covariance.noalias() = F * first.covariance * F.transpose();
  result.covariance.noalias() += F2 * second.covariance * F2.transpose();
  return result;
}

CorrectedDelta CorrectToFirstOrder(const ImuDelta& delta, const ImuBiases& biases,
                                   const ImuCalibration& calibration) {
  const Eigen::Matrix<double, 9, 1> change = FirstOrderChange(delta, biases, calibration);
  return {BoxPlus(delta.R, change.head<3>()), delta.s + change.segment<3>(3),
          delta.y + change.tail<3>()};
}

double DistanceFromLinearization(const ImuDelta& delta, const ImuBiases& biases,
                                 const ImuCalibration& calibration) {
  const Eigen::Matrix<double, 9, 1> change = FirstOrderChange(delta, biases, calibration);
  return std::max({change.head<3>().norm(), change.segment<3>(3).norm(), change.tail<3>().norm()});
}

NavState Predict(const NavState& start, const ImuDelta& delta, const Eigen::Vector3d& g_G) {
  const double dt = delta.dt_s;
  NavState end;
  end.R_GB = (start.R_GB * delta.R).normalized();
  end.v_GB = start.v_GB + g_G * dt + start.R_GB * delta.s;
  end.p_GB = start.p_GB + start.v_GB * dt + 0.5 * dt * dt * g_G + start.R_GB * delta.y;
  return end;
}

Eigen::Matrix<double, 27, 1> ToVector(const ImuCalibration& calibration) {
  Eigen::Matrix<double, 27, 1> vector;
  const Matrix3d* const matrices[] = {&calibration.T_g, &calibration.T_s, &calibration.T_a};
  for (int m = 0; m < 3; ++m) {
    for (int i = 0; i < 3; ++i) {
      vector.segment<3>(9 * m + 3 * i) = matrices[m]->row(i).transpose();
    }
  }
  return vector;
}

ImuCalibration ImuCalibrationFromVector(const Eigen::Matrix<double, 27, 1>& vector) {
  ImuCalibration calibration;
  Matrix3d* const matrices[] = {&calibration.T_g, &calibration.T_s, &calibration.T_a};
  for (int m = 0; m < 3; ++m) {
    for (int i = 0; i < 3; ++i) {
      matrices[m]->row(i) = vector.segment<3>(9 * m + 3 * i).transpose();
    }
  }
  return calibration;
}

}  // namespace duet
