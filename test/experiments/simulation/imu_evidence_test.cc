// The noise-free IMU of a trajectory, integrated by the shared IMU delta from the exact start, is
// the trajectory again: simulator and estimators mean the same by an IMU.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/imu/imu_delta.h"
#include "experiments/simulation/euroc_sequences.h"
#include "experiments/simulation/imu_simulator.h"
#include "experiments/simulation/trajectory_library.h"

namespace duet {
namespace {

using Eigen::Vector3d;

constexpr Timestamp kStart = 1'400'000'000'000'000'000;
constexpr double kSpan_s = 10.0;
const Vector3d kGravity(0.0, 0.0, -9.81);

NavState StateAt(const Trajectory& trajectory, double t_s) {
  const Kinematics k = trajectory.At(t_s);
  return {.R_GB = k.T_GB.R, .p_GB = k.T_GB.p, .v_GB = k.v_GB};
}

// The largest position error [m] after kSpan_s over starts every 10 s.
double WorstDrift(const Trajectory& trajectory, double rate_hz) {
  const SimulatedImu imu =
      SimulateImu(trajectory, kStart, {.g_G = kGravity}, {.rate_hz = rate_hz}, 1);
  const auto span = static_cast<std::size_t>(kSpan_s * rate_hz);
  double worst = 0.0;
  for (std::size_t begin = 0; begin + span < imu.samples.size(); begin += span) {
    const ImuDelta delta = IntegrateImu(
        std::span(imu.samples).subspan(begin, span + 1), {}, {}, {},
        {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false});
    const double t0_s = static_cast<double>(begin) / rate_hz;
    const NavState end = Predict(StateAt(trajectory, t0_s), delta, kGravity);
    worst = std::max(worst, (end.p_GB - StateAt(trajectory, t0_s + kSpan_s).p_GB).norm());
  }
  return worst;
}

// 1 sigma of the position [m], over its three axes, that the default noise makes of kSpan_s.
double NoiseOfTheImu(const Trajectory& trajectory) {
  const ImuNoise noise{1.6968e-4, 2.0e-3, 1.9393e-5, 3.0e-3};
  const SimulatedImu imu = SimulateImu(trajectory, kStart, {.g_G = kGravity}, {}, 1);
  const ImuDelta delta = IntegrateImu(std::span(imu.samples).first(2001), {}, {}, noise,
                                      {.calibration_jacobians = false});
  return std::sqrt(delta.covariance.block<3, 3>(6, 6).trace());
}

TEST(ImuEvidence, FlightsLikeEurocAreFollowedWithinFiveMillimetres) {
  for (const EurocSequence& sequence : EurocSequences()) {
    const auto trajectory = MakeTrajectory(sequence.name, sequence.thesis.duration_s, kEurocRest_s);
    const double drift = WorstDrift(*trajectory, 200.0);
    std::printf("%-16s 200 Hz, 10 s: at most %.3f mm\n", sequence.name.c_str(), 1e3 * drift);
    EXPECT_LT(drift, 5e-3) << sequence.name;
  }
}

TEST(ImuEvidence, WildFlightsAreFollowedWithinATenthOfTheNoise) {
  for (const char* name : {"aggressive", "lissajous"}) {
    const auto trajectory = MakeTrajectory(name, 60.0, 0.0);
    const double drift = WorstDrift(*trajectory, 200.0);
    const double noise = NoiseOfTheImu(*trajectory);
    std::printf("%-16s 200 Hz, 10 s: at most %.3f mm; the noise makes %.0f mm\n", name, 1e3 * drift,
                1e3 * noise);
    EXPECT_LT(drift, 0.1 * noise) << name;
  }
}

// Readings are taken as linear between samples, which errs by h^2 / 12 times their second
// derivative: second order.
TEST(ImuEvidence, ErrorFallsAtSecondOrderWithTheRate) {
  for (const char* name : {"aggressive", "lissajous", "V1_03_difficult"}) {
    const auto trajectory = MakeTrajectory(name, 20.0, 0.0);
    std::printf("%-16s", name);
    double previous = 0.0;
    for (const double rate_hz : {100.0, 200.0, 400.0, 800.0, 1600.0, 3200.0}) {
      const double drift = WorstDrift(*trajectory, rate_hz);
      std::printf("  %4.0f Hz %.2e m", rate_hz, drift);
      // A factor of 4 an octave; the worst start may change from one rate to the next.
      if (previous > 0.0) {
        EXPECT_GT(previous / drift, 3.6) << name << " at " << rate_hz;
      }
      previous = drift;
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace duet
