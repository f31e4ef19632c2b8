#include "backends/msckf/trapezoid_delta.h"

#include "common/geometry/so3.h"
#include "common/imu/delta_step.h"
#include "common/imu/motion_increment.h"
#include "common/support/logging.h"

namespace duet {
namespace {

using Matrix3d = Eigen::Matrix3d;

// Only the step's ends are used, of the arrays of StepGeometry.
constexpr int kBegin = 0;
constexpr int kEnd = 2;

// Effect of d_omega = W x, d_a = A x over one step, W and A at its end.
template <int kColumns>
StepEffect<kColumns> TrapezoidEffect(const StepGeometry& step,
                                     const Eigen::Matrix<double, 3, kColumns>& W,
                                     const Eigen::Matrix<double, 3, kColumns>& A) {
  using Block = Eigen::Matrix<double, 3, kColumns>;
  const double h = step.h_s;
  const Matrix3d half_sum = 0.5 * h * (step.R[kBegin] + step.R[kEnd]);
  StepEffect<kColumns> effect;
  effect.theta = half_sum * W;
  const Block direct = half_sum * A;
  const Block through_theta = 0.5 * h * step.minus_Ra_hat[kEnd] * effect.theta;
  effect.s = direct + through_theta;
  effect.y = (0.5 * h) * direct + (h / 3.0) * through_theta;
  return effect;
}

// h/2 N: the noises' density over (theta, s, y, b_g, b_a) at an end of the step, R the rotation
// there; with J = d omega / d b_a the accelerometer's noise enters theta by T_s.
Matrix15d HalfNoise(double h_s, const Matrix3d& R, const ImuCorrection& correction,
                    const ImuNoise& noise) {
  const auto half = [h_s](double density) { return 0.5 * h_s * density * density; };
  const double accelerometer = half(noise.accelerometer_density);
  const Matrix3d RWg = R * correction.T_g_inverse();
  const Matrix3d RWa = R * correction.J_omega_ba();
  const Matrix3d RA = -R * correction.T_a_inverse();
  Matrix15d N = Matrix15d::Zero();
  N.block<3, 3>(0, 0) = half(noise.gyroscope_density) * RWg * RWg.transpose();
  N.block<3, 3>(0, 0) += accelerometer * RWa * RWa.transpose();
  N.block<3, 3>(0, 3) = accelerometer * RWa * RA.transpose();
  N.block<3, 3>(3, 0) = N.block<3, 3>(0, 3).transpose();
  N.block<3, 3>(3, 3) = accelerometer * RA * RA.transpose();
  N.diagonal().segment<3>(9).setConstant(half(noise.gyroscope_random_walk));
  N.diagonal().segment<3>(12).setConstant(half(noise.accelerometer_random_walk));
  return N;
}

}  // namespace

ImuDelta IntegrateImuByTrapezoids(std::span<const ImuSample> readings, const ImuBiases& biases,
                                  const ImuCalibration& calibration, const ImuNoise& noise,
                                  const ImuDeltaOptions& options) {
  CHECK(!readings.empty());
  CHECK(!options.covariance || options.bias_jacobians) << "the covariance needs the bias Jacobians";
  ImuDelta delta;
  delta.start = readings.front().timestamp;
  delta.end = readings.back().timestamp;
  CHECK_LE(delta.start, delta.end);
  delta.dt_s = SecondsBetween(delta.start, delta.end);
  delta.biases = biases;
  delta.calibration = calibration;

  const ImuCorrection correction(calibration, biases);
  const Matrix3d W_g = -correction.T_g_inverse();
  const Matrix3d& W_a = correction.J_omega_ba();
  const Matrix3d A_g = Matrix3d::Zero();
  const Matrix3d A_a = -correction.T_a_inverse();

  MotionIncrement motion;
  ImuRates begin = correction(readings[0].omega_m, readings[0].a_m);
  StepGeometry step;
  step.R[kEnd] = Matrix3d::Identity();
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const ImuRates end = correction(readings[i].omega_m, readings[i].a_m);
    step.h_s = SecondsBetween(readings[i - 1].timestamp, readings[i].timestamp);
    const MotionIncrement before = motion;
    RungeKuttaStep(begin, end, step.h_s, &motion);
    step.R[kBegin] = step.R[kEnd];
    step.R[kEnd] = motion.R.toRotationMatrix();
    step.minus_Ra_hat[kEnd] = -Hat(step.R[kEnd] * end.a_B);
    step.ds = motion.s - before.s;
    step.dy = motion.y - before.y - step.h_s * before.s;
    if (options.bias_jacobians) {
      const StepEffect<3> b_g = TrapezoidEffect<3>(step, W_g, A_g);
      const StepEffect<3> b_a = TrapezoidEffect<3>(step, W_a, A_a);
      CarryOn(step, b_g, &delta.J_b_g);
      CarryOn(step, b_a, &delta.J_b_a);
      if (options.covariance) {
        delta.covariance += HalfNoise(step.h_s, step.R[kBegin], correction, noise);
        PropagateStepCovariance(step, b_g, b_a, &delta.covariance);
        delta.covariance += HalfNoise(step.h_s, step.R[kEnd], correction, noise);
      }
    }
    if (options.calibration_jacobians) {
      Eigen::Matrix<double, 3, 27> W;
      Eigen::Matrix<double, 3, 27> A;
      correction.CalibrationJacobians(end, &W, &A);
      CarryOn(step, TrapezoidEffect<27>(step, W, A), &delta.J_T);
    }
    begin = end;
  }
  delta.R = motion.R;
  delta.s = motion.s;
  delta.y = motion.y;
  delta.covariance = 0.5 * (delta.covariance + delta.covariance.transpose()).eval();
  return delta;
}

}  // namespace duet
