#include <gtest/gtest.h>
#include <cstdio>
#include "experiments/observability/observability_report.h"
#include "test/experiments/observability/observed_simulation.h"
namespace duet {
namespace {
TEST(Degenerate, Print) {
  for (const char* name : {"lissajous", "standstill", "pure_rotation", "one_axis_rotation", "constant_rate", "straight_line", "constant_acceleration", "planar_driving"}) {
    SimulationOptions options = ObservedSimulation::Options(16.0);
    options.trajectory = name;
    const ObservedSimulation simulation(options, MakeTrajectory(name, 16.4, 0), AllEstimated());
    const FisherInformation information(simulation.motion);
    std::printf("=== %s\n%s\n", name, ObservabilityText(AnalyzeObservability(information, {})).c_str());
  }
}
}  // namespace
}  // namespace duet
