// The filter, one frame an iteration, tracks in memory: on simulated tracks (150 points a camera,
// 1 px) and, where the recording is there, on OpenVINS's. One thread. Arguments: cameras, clones.

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>

#include "backends/msckf/msckf.h"
#include "common/dataset/recording.h"
#include "experiments/simulation/simulator.h"

namespace duet {
namespace {

struct Sequence {
  EstimatorSetup setup;
  std::vector<TrackFrameSet> frames;
  std::vector<ImuSample> imu;
  InertialState start;
};

Matrix15d StartCovariance() {
  Vector15d sigma;
  sigma << 0.01, 0.01, 1e-4, Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(0.05),
      Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.1);
  return sigma.array().square().matrix().asDiagonal();
}

Sequence Simulated(int cameras) {
  SimulationOptions options = SimulationPreset(cameras == 1 ? "room_easy" : "room_easy_stereo");
  options.max_tracks = 150;
  options.duration_s = 20.0;
  const SimulatedRecording recording = Simulate(options);
  return {MakeSetup(recording, SharedOptions()), recording.frames, recording.imu,
          recording.TruthAt(recording.frames.front().timestamp)};
}

// Nothing where the recording is not there.
std::optional<Sequence> Recorded(int cameras) {
  std::filesystem::path data;
  if (const char* told = std::getenv("DUET_DATA")) {
    data = told;
  } else {
    data = __FILE__;
    for (int up = 0; up < 4; ++up) data = data.parent_path();
    data /= "shared/data";
  }
  const std::filesystem::path folder = data / "openvins_sim" / (cameras == 1 ? "V1_03" : "V1_01");
  if (!std::filesystem::exists(folder)) return std::nullopt;
  RecordingOptions options;
  options.source = RecordingOptions::Source::kTracks;
  if (cameras == 2) options.cameras = {0, 1};
  const Recording recording = LoadRecording(folder, options);
  Sequence sequence;
  sequence.setup.rig = recording.rig;
  sequence.setup.imu_noise = recording.imu_sensor.noise;
  sequence.setup.g_G = recording.g_G();
  sequence.imu = recording.imu;
  // The truth at the frame's stamp, to a sample: 2.5 ms, no matter for a benchmark.
  const GroundTruth& truth = *recording.truth;
  std::size_t i = 0;
  while (truth.poses[i].timestamp < recording.tracks.frames.front().timestamp) ++i;
  sequence.start = {truth.poses[i].timestamp,
                    {truth.poses[i].T_GB.R, truth.poses[i].T_GB.p, truth.velocities[i]},
                    truth.biases[i]};
  for (const TrackFrameSet& frames : recording.tracks.frames) {
    if (frames.timestamp >= sequence.start.instant) sequence.frames.push_back(frames);
  }
  return sequence;
}

void FilterFrame(benchmark::State& state, const Sequence& sequence) {
  MsckfOptions options;
  options.max_clones = static_cast<int>(state.range(1));
  std::unique_ptr<Msckf> filter;
  std::size_t next = sequence.frames.size();
  double used = 0.0;
  for (auto _ : state) {
    if (next == sequence.frames.size()) {
      state.PauseTiming();
      filter = std::make_unique<Msckf>(sequence.setup, options);
      for (const ImuSample& sample : sequence.imu) filter->AddImu(sample);
      filter->Initialize({sequence.start, StartCovariance()});
      next = 0;
      state.ResumeTiming();
    }
    used += filter->ProcessFrame(sequence.frames[next++]).features.used;
  }
  state.counters["landmarks"] = benchmark::Counter(used, benchmark::Counter::kAvgIterations);
}

void SimulatedTracks(benchmark::State& state) {
  FilterFrame(state, Simulated(static_cast<int>(state.range(0))));
}

void RecordedTracks(benchmark::State& state) {
  const std::optional<Sequence> sequence = Recorded(static_cast<int>(state.range(0)));
  if (!sequence) {
    state.SkipWithError("no recordings: set DUET_DATA to their folder");
    return;
  }
  FilterFrame(state, *sequence);
}

// Whole recordings: frames differ.
BENCHMARK(SimulatedTracks)
    ->ArgNames({"cameras", "clones"})
    ->Args({1, 11})
    ->Args({1, 20})
    ->Args({2, 11})
    ->Args({2, 20})
    ->Iterations(800)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(RecordedTracks)
    ->ArgNames({"cameras", "clones"})
    ->Args({1, 11})
    ->Args({1, 20})
    ->Args({2, 11})
    ->Args({2, 20})
    ->Iterations(800)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace duet

BENCHMARK_MAIN();
