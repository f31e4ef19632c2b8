// A filter frame and a window frame, one frame an iteration, tracks in memory: on simulated tracks
// (150 points a camera, 1 px) and, where the recording is there, on OpenVINS's. One thread.
// Arguments: cameras, frames in the window (the filter's clones).

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "backends/factory.h"
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

void Frames(benchmark::State& state, const std::string& name, const Sequence& sequence,
            const BackendOptions& options) {
  std::unique_ptr<Estimator> estimator;
  std::size_t next = sequence.frames.size();
  double used = 0.0;
  StageTimer timer;
  std::map<std::string, double> stages;
  double iterations = 0.0;
  for (auto _ : state) {
    if (next == sequence.frames.size()) {
      state.PauseTiming();
      estimator = MakeEstimator(name, sequence.setup, options);
      estimator->set_stage_timer(&timer);
      for (const ImuSample& sample : sequence.imu) estimator->AddImu(sample);
      estimator->Initialize({sequence.start, StartCovariance()});
      next = 0;
      state.ResumeTiming();
    }
    timer.StartFrame();
    const EstimatorOutput& output = estimator->ProcessFrame(sequence.frames[next++]);
    used += output.features.used;
    iterations += output.iterations;
    for (const StageTimer::Stage& s : timer.stages()) stages[s.name] += s.cpu_ms;
  }
  for (const auto& [stage, ms] : stages) {
    state.counters[stage] = benchmark::Counter(ms, benchmark::Counter::kAvgIterations);
  }
  state.counters["iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  state.counters["landmarks"] = benchmark::Counter(used, benchmark::Counter::kAvgIterations);
}

// With so many frames in the window as the second argument says.
void Frame(benchmark::State& state, const std::string& name, const Sequence& sequence) {
  BackendOptions options;
  options.msckf.max_clones = static_cast<int>(state.range(1));
  options.window.max_frames = static_cast<int>(state.range(1));
  Frames(state, name, sequence, options);
}

void SimulatedTracks(benchmark::State& state, const std::string& name) {
  Frame(state, name, Simulated(static_cast<int>(state.range(0))));
}

void RecordedTracks(benchmark::State& state, const std::string& name) {
  const std::optional<Sequence> sequence = Recorded(static_cast<int>(state.range(0)));
  if (!sequence) {
    state.SkipWithError("no recordings: set DUET_DATA to their folder");
    return;
  }
  Frame(state, name, *sequence);
}

// Whole recordings: frames differ.
void Whole(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"cameras", "frames"})->Iterations(400)->Unit(benchmark::kMillisecond);
  for (const int cameras : {1, 2}) {
    for (const int frames : {11, 20}) benchmark->Args({cameras, frames});
  }
}

// What estimating the whole calibration costs: the same stream (excited motion, 100 points, 1 px, a
// global shutter or one of 20 ms), told right, everything fixed or everything estimated.
void Calibration(benchmark::State& state, const std::string& name) {
  SimulationOptions options = SimulationPreset("excited");
  options.max_tracks = 100;
  options.camera_rate_hz = 20.0;
  options.duration_s = 20.0;
  options.t_r_s = state.range(0) != 0 ? 0.02 : 0.0;
  const SimulatedRecording recording = Simulate(options);
  SharedOptions shared;
  CalibrationPriors& priors = shared.calibration;
  for (BlockPrior* block :
       {&priors.T_g, &priors.T_s, &priors.T_a, &priors.p_CB, &priors.R_CB, &priors.intrinsics,
        static_cast<BlockPrior*>(&priors.distortion), &priors.t_d, &priors.t_r}) {
    block->estimated = state.range(1) != 0;
  }
  Frames(state, name,
         {MakeSetup(recording, shared), recording.frames, recording.imu,
          recording.TruthAt(recording.frames.front().timestamp)},
         BackendOptions());
}

void FixedAndEstimated(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"rolling", "estimated"})->Iterations(390)->Unit(benchmark::kMillisecond);
  for (const int rolling : {0, 1}) {
    for (const int estimated : {0, 1}) benchmark->Args({rolling, estimated});
  }
}

BENCHMARK_CAPTURE(Calibration, msckf, "msckf")->Apply(FixedAndEstimated);
BENCHMARK_CAPTURE(Calibration, window, "window")->Apply(FixedAndEstimated);
BENCHMARK_CAPTURE(SimulatedTracks, msckf, "msckf")->Apply(Whole);
BENCHMARK_CAPTURE(SimulatedTracks, window, "window")->Apply(Whole);
BENCHMARK_CAPTURE(RecordedTracks, msckf, "msckf")->Apply(Whole);
BENCHMARK_CAPTURE(RecordedTracks, window, "window")->Apply(Whole);

}  // namespace
}  // namespace duet

BENCHMARK_MAIN();
