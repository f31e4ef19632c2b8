#include "experiments/figures/car_example.h"

#include <cmath>

#include "common/support/random.h"

namespace duet {
namespace {

Eigen::Matrix2d CarTransition(double step_s) {
  Eigen::Matrix2d A;
  A << 1.0, step_s, 0.0, 1.0;
  return A;
}

const Eigen::RowVector2d& VelocityMeasurement() {
  static const Eigen::RowVector2d C(0.0, 1.0);
  return C;
}

}  // namespace

std::vector<CarState> DriveCar(const CarOptions& options) {
  constexpr double kTurn = 2.0 * 3.14159265358979323846;
  const double rate = kTurn / options.period_s;
  const Eigen::Matrix2d A = CarTransition(options.step_s);
  const Eigen::Vector2d B(0.0, options.step_s);
  const Eigen::Matrix2d Q =
      B * options.acceleration_sigma * options.acceleration_sigma * B.transpose();
  const double R = options.velocity_sigma * options.velocity_sigma;
  const Eigen::RowVector2d& C = VelocityMeasurement();
  Random random(options.seed);

  CarState state;
  state.truth = state.estimate = Eigen::Vector2d(0.0, options.amplitude_m * rate);
  std::vector<CarState> states = {state};
  const int steps = static_cast<int>(std::lround(options.duration_s / options.step_s));
  for (int i = 0; i < steps; ++i) {
    const double a = -options.amplitude_m * rate * rate * std::sin(rate * state.t_s);
    const double a_meas = a + options.acceleration_sigma * random.Normal();
    state.t_s = (i + 1) * options.step_s;
    state.truth = A * state.truth + B * a;
    // Prediction (3.21).
    state.estimate = A * state.estimate + B * a_meas;
    state.covariance = A * state.covariance * A.transpose() + Q;
    // Update by the speed-meter (3.22, 3.23).
    const double z = state.truth[1] + options.velocity_sigma * random.Normal();
    const Eigen::Vector2d K =
        state.covariance * C.transpose() / (C * state.covariance * C.transpose() + R);
    state.estimate += K * (z - C * state.estimate);
    state.covariance -= K * C * state.covariance;
    states.push_back(state);
  }
  return states;
}

Eigen::MatrixXd CarObservabilityMatrix(const CarOptions& options, int steps) {
  const Eigen::Matrix2d A = CarTransition(options.step_s);
  Eigen::MatrixXd O(steps + 1, 2);
  Eigen::RowVector2d row = VelocityMeasurement();
  for (int k = 0; k <= steps; ++k) {
    O.row(k) = row;
    row = row * A;
  }
  return O;
}

}  // namespace duet
