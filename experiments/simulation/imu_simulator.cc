#include "experiments/simulation/imu_simulator.h"

#include <algorithm>
#include <cmath>

#include "common/support/logging.h"
#include "common/support/random.h"

namespace duet {
namespace {

// Sequences of random numbers; 2 and 3 are the simulator's tracks and told calibration.
enum ImuRandomStream : std::uint64_t { kNoiseStream = 1, kJitterStream = 11, kDropStream = 12 };

constexpr double kLargestJitter = 0.45;  // of an interval

// Clips the axes to +-range; true where one was.
bool Clip(double range, Eigen::Vector3d* reading) {
  if (range <= 0.0 || reading->cwiseAbs().maxCoeff() <= range) return false;
  *reading = reading->cwiseMax(-range).cwiseMin(range);
  return true;
}

// The places of a trajectory at which samples are taken.
struct Instants {
  std::vector<Timestamp> taken;
  std::vector<Timestamp> stamps;
};

Instants SamplingInstants(const Trajectory& trajectory, Timestamp start,
                          const ImuSampling& sampling, std::uint64_t seed) {
  const int count = static_cast<int>(std::floor(trajectory.duration_s() * sampling.rate_hz)) + 1;
  Instants instants;
  instants.taken.reserve(static_cast<std::size_t>(count));
  Random random(seed, kJitterStream);
  const double largest_s = kLargestJitter / sampling.rate_hz;
  const Timestamp end = start + ToNanoseconds(trajectory.duration_s());
  for (int i = 0; i < count; ++i) instants.taken.push_back(EvenStamp(start, i, sampling.rate_hz));
  if (sampling.jitter_s <= 0.0) {
    instants.stamps = instants.taken;
    return instants;
  }
  if (!sampling.jitter_is_stamped) instants.stamps = instants.taken;
  for (Timestamp& taken : instants.taken) {
    const double jitter_s = std::clamp(sampling.jitter_s * random.Normal(), -largest_s, largest_s);
    taken = std::clamp(taken + ToNanoseconds(jitter_s), start, end);
  }
  if (sampling.jitter_is_stamped) instants.stamps = instants.taken;
  return instants;
}

}  // namespace

Timestamp EvenStamp(Timestamp start, int index, double rate_hz) {
  return start + static_cast<Timestamp>(std::llround(1e9 * static_cast<double>(index) / rate_hz));
}

SimulatedImu SimulateImu(const Trajectory& trajectory, Timestamp start,
                         const ImuUnderSimulation& imu, const ImuSampling& sampling,
                         std::uint64_t seed) {
  CHECK_GT(sampling.rate_hz, 0.0);
  const Instants instants = SamplingInstants(trajectory, start, sampling, seed);
  Random random(seed, kNoiseStream);
  Random drops(seed, kDropStream);
  const double even_dt_s = 1.0 / sampling.rate_hz;
  const double root_rate = std::sqrt(sampling.rate_hz);
  const std::size_t count = instants.taken.size();
  const auto state_at = [&](Timestamp t) {
    return trajectory.At(std::min(SecondsBetween(start, t), trajectory.duration_s()));
  };
  SimulatedImu simulated;
  simulated.samples.reserve(count);
  simulated.truth.reserve(count);
  ImuBiases biases = imu.biases;
  for (std::size_t i = 0; i < count; ++i) {
    const Kinematics k = state_at(instants.taken[i]);
    const ImuRates true_rates{.omega_B = k.omega_B,
                              .a_B = k.T_GB.R.conjugate() * (k.a_G - imu.g_G)};
    const ImuRates read = DistortRates(true_rates, imu.calibration, biases);
    ImuSample sample;
    sample.timestamp = instants.stamps[i];
    sample.omega_m =
        read.omega_B + imu.noise.gyroscope_density * root_rate * random.NormalVector<3>();
    sample.a_m = read.a_B + imu.noise.accelerometer_density * root_rate * random.NormalVector<3>();
    if (Clip(sampling.gyroscope_range, &sample.omega_m)) ++simulated.clipped_gyroscope;
    if (Clip(sampling.accelerometer_range, &sample.a_m)) ++simulated.clipped_accelerometer;
    const bool at_an_end = i == 0 || i + 1 == count;
    if (sampling.drop_share > 0.0 && drops.Uniform() < sampling.drop_share && !at_an_end) {
      ++simulated.dropped;
    } else {
      simulated.samples.push_back(sample);
    }
    const Kinematics at_stamp =
        instants.stamps[i] == instants.taken[i] ? k : state_at(instants.stamps[i]);
    simulated.truth.push_back(
        {.instant = instants.stamps[i],
         .nav = {.R_GB = at_stamp.T_GB.R, .p_GB = at_stamp.T_GB.p, .v_GB = at_stamp.v_GB},
         .biases = biases});
    if (i + 1 == count) break;
    const double dt_s = sampling.jitter_s > 0.0
                            ? SecondsBetween(instants.taken[i], instants.taken[i + 1])
                            : even_dt_s;
    const double root_dt = std::sqrt(dt_s);
    biases.b_g += imu.noise.gyroscope_random_walk * root_dt * random.NormalVector<3>();
    biases.b_a += imu.noise.accelerometer_random_walk * root_dt * random.NormalVector<3>();
  }
  return simulated;
}

}  // namespace duet
