// Filter and window on the real, nonlinear models: with every pixel used once by both, gate and
// loss off and the same frames, all that is left between them is where they linearize, and that
// fades in proportion to the noise.

#include <gtest/gtest.h>

#include <cstdio>

#include "backends/factory.h"
#include "experiments/simulation/simulator.h"
#include "test/seeds.h"

namespace duet {
namespace {

constexpr int kBlock = 8;             // frames a track lives; shorter than both windows
constexpr int kMinLength = 6;         // shorter pieces are dropped, so that both use what is left
constexpr int kSimulatedFrames = 34;  // 4 blocks, then frames without tracks: all have ended

// Cuts all tracks at the same frames and empties the last ones: every track has then ended, is
// shorter than the window, and has been used whole by both estimators.
std::vector<TrackFrameSet> CutTracks(const std::vector<TrackFrameSet>& frames) {
  std::vector<TrackFrameSet> cut(frames.begin(), frames.begin() + kSimulatedFrames);
  std::map<std::pair<std::uint64_t, int>, int> lengths;
  for (int f = 0; f < kSimulatedFrames; ++f) {
    for (const TrackObservation& o : cut[f].frames[0].observations)
      ++lengths[{o.track_id, f / kBlock}];
  }
  for (int f = 0; f < kSimulatedFrames; ++f) {
    std::vector<TrackObservation> kept;
    for (TrackObservation o : cut[f].frames[0].observations) {
      if (f / kBlock >= kSimulatedFrames / kBlock || lengths[{o.track_id, f / kBlock}] < kMinLength)
        continue;
      o.track_id = o.track_id * 100 + static_cast<std::uint64_t>(f / kBlock);
      kept.push_back(o);
    }
    cut[f].frames[0].observations = kept;
  }
  return cut;
}

struct Outcome {
  InertialState state;
  Matrix15d covariance;
  int used = 0;
  int refused = 0;
};

Outcome RunEstimator(const std::string& name, const SimulatedRecording& recording,
                     const std::vector<TrackFrameSet>& frames, const InitialCondition& initial) {
  SharedOptions shared;
  shared.standstill.enabled = false;
  BackendOptions options;
  options.msckf.gate = false;
  options.msckf.max_landmarks_per_update = 1000;
  options.msckf.min_depth_sigmas = 0.0;
  options.msckf.second_order_landmarks = 0;
  options.window.keyframes = WindowOptions::Keyframes::kEveryFrame;
  options.window.robust_loss = WindowOptions::RobustLoss::kNone;
  options.window.max_reprojection_sigmas = 0.0;
  options.window.max_landmarks = 1000;
  options.window.min_parallax_rad = 1e-6;  // no landmark leaves the problem for want of parallax
  options.window.max_iterations = 50;
  options.window.function_tolerance = 1e-16;
  const auto estimator = MakeEstimator(name, MakeSetup(recording, shared), options);
  for (const ImuSample& sample : recording.imu) estimator->AddImu(sample);
  estimator->Initialize(initial);
  Outcome outcome;
  for (const TrackFrameSet& set : frames) {
    const EstimatorOutput& output = estimator->ProcessFrame(set);
    outcome.refused += output.features.gated + output.features.not_triangulated;
    EXPECT_NE(output.status, EstimatorStatus::kFailed) << output.reason;
    outcome.state = output.state;
    outcome.covariance = output.covariance.topLeftCorner<15, 15>();
  }
  return outcome;
}

TEST(RealModels, FilterAndWindowMeetAsTheNoiseFades) {
  std::vector<double> distances;
  const std::vector<double> scales = {1.0, 0.1, 0.01, 0.001};
  for (const double scale : scales) {
    double sum2 = 0.0;
    constexpr int kSeeds = test::Seeds(3, 1);
    for (int seed = 1; seed <= kSeeds; ++seed) {
      SimulationOptions options = SimulationPreset("excited");
      options.seed = seed;
      options.duration_s = 3.0;
      options.imu_rate_hz = 1000.0;
      options.noise_scale = scale;
      options.mean_track_frames = 1000.0;
      const SimulatedRecording recording = Simulate(options);
      const auto frames = CutTracks(recording.frames);
      Matrix15d covariance = Matrix15d::Zero();
      covariance.diagonal() << Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(1e-4),
          Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(1e-6),
          Eigen::Vector3d::Constant(1e-4);
      covariance *= scale * scale;
      Random random(seed);
      const InitialCondition initial =
          DrawInitialCondition(recording.TruthAt(frames.front().timestamp), covariance, &random);
      const Outcome filter = RunEstimator("msckf", recording, frames, initial);
      const Outcome window = RunEstimator("window", recording, frames, initial);
      const Vector15d d = BoxMinus(filter.state, window.state);
      // Distance in units of the claimed uncertainty.
      sum2 += d.dot(filter.covariance.ldlt().solve(d)) / 15.0;
    }
    distances.push_back(std::sqrt(sum2 / kSeeds));
    std::printf("noise x %g: filter - window = %.2e sigma\n", scale, distances.back());
  }
  // Proportional to the noise: a slope of one over three decades, each within 0.35 (few seeds).
  for (std::size_t i = 1; i < scales.size(); ++i) {
    EXPECT_NEAR(std::log10(distances[i - 1] / distances[i]), 1.0, 0.35) << scales[i];
  }
  EXPECT_LT(distances.back(), 1e-2);
}

}  // namespace
}  // namespace duet
