// Rendering, one image an iteration at 752 x 480, and what it is made of. CPU time is that of all
// threads together.
//
//   render_benchmark --benchmark_filter=Render/fast

#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <string>

#include "common/support/random.h"
#include "experiments/simulation/render/image_writer.h"
#include "experiments/simulation/render/renderer.h"
#include "experiments/simulation/simulator.h"
#include "experiments/simulation/trajectory_library.h"
#include "experiments/simulation/world/world_library.h"

namespace duet {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const World> BenchmarkWorld(const std::string& name) {
  static std::map<std::string, std::shared_ptr<const World>> worlds;
  std::shared_ptr<const World>& world = worlds[name];
  if (!world) world = MakeWorld(name, {.threads = 2});
  return world;
}

struct Mode {
  std::string world;
  RenderQuality quality;
  double t_r_s;
  double exposure_s;
};

void Render(benchmark::State& state, const Mode& mode) {
  RigCalibration rig = EurocLikeRig(1);
  rig.t_r_s = mode.t_r_s;
  RenderOptions options;
  options.quality = mode.quality;
  options.exposure_s = mode.exposure_s;
  options.threads = 2;
  const auto trajectory = MakeTrajectory("room_walk", 60.0, 0.0);
  const Renderer renderer(options, TrueCamera(rig, BenchmarkWorld(mode.world), trajectory, 0));
  Timestamp stamp = 1'000'000'000;
  double instants = 0.0;
  for (auto _ : state) {
    const RenderedImage rendered = renderer.Render(0, stamp);
    benchmark::DoNotOptimize(rendered.image.data);
    instants += rendered.blur_instants;
    stamp += 150'000'000;
    if (stamp > 50'000'000'000) stamp = 1'000'000'000;
  }
  state.counters["instants"] = benchmark::Counter(instants, benchmark::Counter::kAvgIterations);
}

void Register(const std::string& name, const Mode& mode) {
  benchmark::RegisterBenchmark(("Render/" + name).c_str(),
                               [mode](benchmark::State& state) { Render(state, mode); })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

void RegisterModes() {
  using enum RenderQuality;
  for (const std::string& world : WorldNames()) {
    Register(world + "/fast/global", {world, kFast, 0.0, 0.0});
  }
  Register("room/fast/rolling", {"room", kFast, 0.02, 0.0});
  Register("room/fast/rolling/exposure_4ms", {"room", kFast, 0.02, 0.004});
  Register("room/fast/global/exposure_4ms", {"room", kFast, 0.0, 0.004});
  Register("room/fast/global/exposure_15ms", {"room", kFast, 0.0, 0.015});
  Register("room/accurate/global", {"room", kAccurate, 0.0, 0.0});
  Register("room/accurate/rolling", {"room", kAccurate, 0.02, 0.0});
  Register("room/accurate/rolling/exposure_4ms", {"room", kAccurate, 0.02, 0.004});
}

void Cast(benchmark::State& state, const std::string& name) {
  const auto world = BenchmarkWorld(name);
  const std::vector<Pose> bodies = world->BodyPoses(0.5);
  Random random(1);
  std::vector<Vector3d> directions;
  for (int i = 0; i < 1024; ++i) directions.push_back(random.NormalVector<3>().normalized());
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(world->Cast({-1.0, 0.2, 1.5}, directions[i++ % 1024], bodies));
  }
}
BENCHMARK_CAPTURE(Cast, room, "room");
BENCHMARK_CAPTURE(Cast, hall, "hall");
BENCHMARK_CAPTURE(Cast, street, "street");

void EncodePngImage(benchmark::State& state) {
  const Renderer renderer(RenderOptions{}, TrueCamera(EurocLikeRig(1), BenchmarkWorld("room"),
                                                      MakeTrajectory("room_walk", 60.0, 0.0), 0));
  const cv::Mat image = renderer.Render(0, 1'000'000'000).image;
  std::size_t bytes = 0;
  for (auto _ : state) bytes = EncodePng(image).size();
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(EncodePngImage)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace duet

int main(int argc, char** argv) {
  duet::RegisterModes();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
