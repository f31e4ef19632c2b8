// Rendering, one image an iteration at 752 x 480, and what it is made of. CPU time is that of all
// threads together.
//
//   render_benchmark --benchmark_filter=Render/fast

#include <benchmark/benchmark.h>

#include <memory>

#include "common/support/random.h"
#include "experiments/simulation/render/image_writer.h"
#include "experiments/simulation/render/renderer.h"
#include "experiments/simulation/simulator.h"
#include "test/experiments/simulation/render/small_world.h"

namespace duet {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const World> BenchmarkWorld() {
  static const std::shared_ptr<const World> world = NoisyRoom(true, 0.004);
  return world;
}

struct Mode {
  RenderQuality quality;
  double t_r_s;
  double exposure_s;
};

void Render(benchmark::State& state, const Mode& mode) {
  RigCalibration rig = ForwardRig(EurocLikeRig(1).cameras[0].model);
  rig.t_r_s = mode.t_r_s;
  RenderOptions options;
  options.quality = mode.quality;
  options.exposure_s = mode.exposure_s;
  options.threads = 2;
  const auto motion = std::make_shared<SteadyMotion>(
      Vector3d(-1.5, 0.2, 1.5), Vector3d(0.3, 0.4, 0.1), Vector3d(0.05, 0.1, 0.4));
  const Renderer renderer(options, TrueCamera(rig, BenchmarkWorld(), motion, 0));
  Timestamp stamp = 0;
  double instants = 0.0;
  for (auto _ : state) {
    const RenderedImage rendered = renderer.Render(0, stamp);
    benchmark::DoNotOptimize(rendered.image.data);
    instants += rendered.blur_instants;
    stamp = (stamp + 50'000'000) % 1'000'000'000;
  }
  state.counters["instants"] = benchmark::Counter(instants, benchmark::Counter::kAvgIterations);
}

void RegisterModes() {
  for (const bool accurate : {false, true}) {
    const RenderQuality quality = accurate ? RenderQuality::kAccurate : RenderQuality::kFast;
    for (const bool rolling : {false, true}) {
      for (const double exposure_s : {0.0, 0.004, 0.015}) {
        const Mode mode{quality, rolling ? 0.02 : 0.0, exposure_s};
        const std::string name = std::string("Render/") + (accurate ? "accurate" : "fast") +
                                 (rolling ? "/rolling" : "/global") + "/exposure_" +
                                 std::to_string(static_cast<int>(1e3 * exposure_s)) + "ms";
        benchmark::RegisterBenchmark(name.c_str(),
                                     [mode](benchmark::State& state) { Render(state, mode); })
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
      }
    }
  }
}

void Cast(benchmark::State& state) {
  const auto world = BenchmarkWorld();
  const std::vector<Pose> bodies = world->BodyPoses(0.5);
  Random random(1);
  std::vector<Vector3d> directions;
  for (int i = 0; i < 1024; ++i) directions.push_back(random.NormalVector<3>().normalized());
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(world->Cast({-1.5, 0.2, 1.5}, directions[i++ % 1024], bodies));
  }
}
BENCHMARK(Cast);

void EncodePngImage(benchmark::State& state) {
  const RigCalibration rig = ForwardRig(EurocLikeRig(1).cameras[0].model);
  const auto at_rest =
      std::make_shared<SteadyMotion>(Vector3d(-1.5, 0.2, 1.5), Vector3d::Zero(), Vector3d::Zero());
  const Renderer renderer(RenderOptions{}, TrueCamera(rig, BenchmarkWorld(), at_rest, 0));
  const cv::Mat image = renderer.Render(0, 0).image;
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
