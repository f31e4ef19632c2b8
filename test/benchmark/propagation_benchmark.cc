// One filter frame's IMU interval (50 ms, at the rate of the argument) to Phi, Gamma and Q: by the
// IMU delta and by the thesis's trapezoids, without and with the T matrices' Jacobians.

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "backends/msckf/transition.h"
#include "backends/msckf/trapezoid_delta.h"

namespace duet {
namespace {

std::vector<ImuSample> Readings(int rate_hz) {
  std::vector<ImuSample> readings;
  for (int i = 0; i <= rate_hz / 20; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    readings.push_back({ToNanoseconds(t), Eigen::Vector3d(std::sin(3 * t), std::cos(2 * t), 0.4),
                        Eigen::Vector3d(2 * std::cos(t), 1.0, 9.8 + std::sin(4 * t))});
  }
  return readings;
}

template <class Integrate>
void ToTransition(benchmark::State& state, const Integrate& integrate) {
  const std::vector<ImuSample> readings = Readings(static_cast<int>(state.range(0)));
  const ImuDeltaOptions options = {.calibration_jacobians = state.range(1) != 0};
  const Eigen::Vector3d g_G(0, 0, -9.81);
  for (auto _ : state) {
    const ImuDelta delta = integrate(readings, {}, {}, {2e-3, 2e-2, 1e-4, 3e-3}, options);
    benchmark::DoNotOptimize(MakeTransition(delta, {}, Predict({}, delta, g_G), g_G));
  }
}

void Cases(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"rate_hz", "T_matrices"})->Unit(benchmark::kMicrosecond);
  for (const int rate_hz : {200, 1000}) {
    for (const int T_matrices : {0, 1}) benchmark->Args({rate_hz, T_matrices});
  }
}

BENCHMARK_CAPTURE(ToTransition, delta, IntegrateImu)->Apply(Cases);
BENCHMARK_CAPTURE(ToTransition, thesis_trapezoid, IntegrateImuByTrapezoids)->Apply(Cases);

}  // namespace
}  // namespace duet

BENCHMARK_MAIN();
