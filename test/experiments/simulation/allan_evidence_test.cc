// The densities that a simulation is told are those that its recording at rest shows.

#include <gtest/gtest.h>

#include <cstdio>

#include "evaluation/allan_report.h"
#include "experiments/simulation/imu_simulator.h"
#include "experiments/simulation/trajectory_library.h"

namespace duet {
namespace {

const ImuNoise kTold{.gyroscope_density = 1.6968e-4,
                     .accelerometer_density = 2.0e-3,
                     .gyroscope_random_walk = 1.9393e-5,
                     .accelerometer_random_walk = 3.0e-3};

ImuAllan AtRest(double hours, double rate_hz) {
  const auto rest = MakeTrajectory("standstill", hours * 3600.0, 0.0);
  const ImuAllan allan =
      AnalyzeImu(SimulateImu(*rest, 1'400'000'000'000'000'000,
                             {.noise = kTold, .g_G = {0, 0, -9.81}}, {.rate_hz = rate_hz}, 1)
                     .samples,
                 "simulated");
  std::printf("%s", AllanText(allan, kTold).c_str());
  EXPECT_FALSE(allan.moves);
  return allan;
}

// White densities within 5 % on every axis, from an hour at 200 Hz.
TEST(AllanEvidence, AnHourTellsTheWhiteDensities) {
  const ImuAllan allan = AtRest(1.0, 200.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(allan.gyroscope[axis].fit.white.value / kTold.gyroscope_density, 1.0, 0.05);
    EXPECT_NEAR(allan.accelerometer[axis].fit.white.value / kTold.accelerometer_density, 1.0, 0.05);
  }
}

// Walks within 10 % on every axis, from ten hours; at 20 Hz, since they show from seconds on.
TEST(AllanEvidence, TenHoursTellTheWalks) {
  const ImuAllan allan = AtRest(10.0, 20.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(allan.gyroscope[axis].fit.walk.value / kTold.gyroscope_random_walk, 1.0, 0.10);
    EXPECT_NEAR(allan.accelerometer[axis].fit.walk.value / kTold.accelerometer_random_walk, 1.0,
                0.10);
    EXPECT_LT(allan.gyroscope[axis].fit.misfit, 2.0);
    EXPECT_LT(allan.accelerometer[axis].fit.misfit, 2.0);
  }
}

}  // namespace
}  // namespace duet
