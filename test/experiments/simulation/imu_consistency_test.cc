// The simulated IMU and the covariance that the IMU delta claims for it.

#include <gtest/gtest.h>

#include <cstdio>

#include "common/imu/imu_delta.h"
#include "experiments/simulation/simulator.h"

namespace duet {
namespace {

using Vector15 = Vector15d;

// The delta between two truths.
Vector15 DeltaError(const InertialState& start, const InertialState& end, const ImuDelta& delta,
                    const Eigen::Vector3d& g_G) {
  const double dt = delta.dt_s;
  const Eigen::Quaterniond R_start = start.nav.R_GB;
  const Eigen::Vector3d s = R_start.conjugate() * (end.nav.v_GB - start.nav.v_GB - g_G * dt);
  const Eigen::Vector3d y = R_start.conjugate() * (end.nav.p_GB - start.nav.p_GB -
                                                   start.nav.v_GB * dt - 0.5 * dt * dt * g_G);
  Vector15 e;
  e << Log(R_start.conjugate() * end.nav.R_GB * delta.R.conjugate()), s - delta.s, y - delta.y,
      end.biases.b_g - start.biases.b_g, end.biases.b_a - start.biases.b_a;
  return e;
}

struct Consistency {
  double mean_nees = 0.0;
  Vector15 variance_ratio = Vector15::Zero();
  int count = 0;
};

Consistency Measure(double rate_hz, int samples_in_interval, int seeds) {
  SimulationOptions options;
  options.duration_s = 20.0;
  options.imu_rate_hz = rate_hz;
  options.camera_rate_hz = 1.0;
  options.max_tracks = 1;
  Consistency result;
  for (int seed = 1; seed <= seeds; ++seed) {
    options.seed = seed;
    const SimulatedRecording recording = Simulate(options);
    const auto step = static_cast<std::size_t>(samples_in_interval);
    for (std::size_t i = 0; i + step < recording.imu.size(); i += step) {
      const ImuDelta delta = IntegrateImu(std::span<const ImuSample>(&recording.imu[i], step + 1),
                                          recording.truth[i].biases, recording.true_rig.imu,
                                          recording.noise, {.calibration_jacobians = false});
      const Vector15 e =
          DeltaError(recording.truth[i], recording.truth[i + step], delta, recording.g_G);
      result.mean_nees += e.dot(delta.covariance.ldlt().solve(e));
      result.variance_ratio += e.cwiseAbs2().cwiseQuotient(delta.covariance.diagonal());
      ++result.count;
    }
  }
  result.mean_nees /= result.count;
  result.variance_ratio /= result.count;
  return result;
}

class ImuConsistency : public testing::TestWithParam<std::pair<double, int>> {};

TEST_P(ImuConsistency, SampledNoiseHasTheCovarianceOfTheDelta) {
  const auto [rate_hz, samples] = GetParam();
  const Consistency c = Measure(rate_hz, samples, rate_hz > 500.0 ? 10 : 40);
  std::printf("%.0f Hz, %d steps: mean NEES %.3f of 15 over %d; variance/claimed", rate_hz, samples,
              c.mean_nees, c.count);
  for (int i = 0; i < 15; i += 3) {
    std::printf(" %.3f", c.variance_ratio.segment<3>(i).mean());
  }
  std::printf("\n");
  // Readings are interpolated linearly, so the noise of the first and of the last one counts half
  // in an interval of n steps: the variance there is (n - 1/2) / n of the claimed one, what is
  // missing being the correlation with the neighbours that share the sample.
  const double expected = (samples - 0.5) / samples;
  const double scatter = 4.0 * std::sqrt(2.0 / (3.0 * c.count));
  for (int block = 0; block < 2; ++block) {
    EXPECT_NEAR(c.variance_ratio.segment<3>(3 * block).mean(), expected, scatter + 0.01) << block;
  }
  for (int block = 3; block < 5; ++block) {
    EXPECT_NEAR(c.variance_ratio.segment<3>(3 * block).mean(), 1.0, scatter) << block;
  }
  EXPECT_GT(c.mean_nees, 13.5);
  EXPECT_LT(c.mean_nees, 15.5);
}

INSTANTIATE_TEST_SUITE_P(RatesAndLengths, ImuConsistency,
                         testing::Values(std::pair(200.0, 10), std::pair(200.0, 100),
                                         std::pair(1000.0, 50)));

}  // namespace
}  // namespace duet
