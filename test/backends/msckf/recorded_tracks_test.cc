// The filter on a stream that nobody here made: OpenVINS's simulator along EuRoC trajectories, with
// exact truth. Skipped, loudly, on a machine without the recordings.

#include <gtest/gtest.h>

#include <cstdlib>

#include "backends/msckf/msckf.h"
#include "common/dataset/recording.h"

namespace duet {
namespace {

std::filesystem::path DataFolder() {
  if (const char* told = std::getenv("DUET_DATA")) return told;
  std::filesystem::path folder = __FILE__;
  for (int up = 0; up < 5; ++up) folder = folder.parent_path();
  return folder / "shared/data";
}

struct Score {
  double position_m = 0.0;
  double orientation_deg = 0.0;
  int frames = 0;
};

// Linear between the truth's stamps, which are 5 ms apart.
InertialState TruthAt(const GroundTruth& truth, Timestamp t) {
  const auto state = [&](std::size_t i) {
    InertialState s;
    s.instant = truth.poses[i].timestamp;
    s.nav = {truth.poses[i].T_GB.R, truth.poses[i].T_GB.p, truth.velocities[i]};
    s.biases = truth.biases[i];
    return s;
  };
  std::size_t after = 1;
  std::size_t high = truth.poses.size() - 1;
  while (after < high) {
    const std::size_t middle = (after + high) / 2;
    if (truth.poses[middle].timestamp < t) {
      after = middle + 1;
    } else {
      high = middle;
    }
  }
  const InertialState a = state(after - 1);
  const InertialState b = state(after);
  const double w = SecondsBetween(a.instant, t) / SecondsBetween(a.instant, b.instant);
  return BoxPlus(a, Vector15d(w * BoxMinus(b, a)));
}

// From the truth, without alignment.
Score RunOn(const Recording& recording) {
  EstimatorSetup setup;
  setup.rig = recording.rig;
  setup.imu_noise = recording.imu_sensor.noise;
  setup.g_G = recording.g_G();
  Msckf filter(setup, MsckfOptions());
  const auto truth_at = [&](Timestamp t) { return TruthAt(*recording.truth, t); };
  Vector15d sigma;
  sigma << 0.01, 0.01, 1e-4, Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(0.05),
      Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.1);
  const Timestamp start = recording.tracks.frames.front().timestamp;
  InitialCondition initial{truth_at(start), sigma.array().square().matrix().asDiagonal()};
  initial.state.instant = start;
  filter.Initialize(initial);
  for (const ImuSample& sample : recording.imu) filter.AddImu(sample);
  Score score;
  for (const TrackFrameSet& frames : recording.tracks.frames) {
    const EstimatorOutput& output = filter.ProcessFrame(frames);
    if (output.status != EstimatorStatus::kTracking) continue;
    const Vector15d error = BoxMinus(truth_at(output.state.instant), output.state);
    score.orientation_deg += error.head<3>().squaredNorm();
    score.position_m += error.segment<3>(3).squaredNorm();
    ++score.frames;
  }
  score.position_m = std::sqrt(score.position_m / score.frames);
  score.orientation_deg = std::sqrt(score.orientation_deg / score.frames) * 180.0 / M_PI;
  return score;
}

// Bounds of the project's first delivery; OpenVINS: 0.020 m and 0.15 deg, 0.022 m and 0.14 deg.
TEST(RecordedTracks, OpenVinsSimulationIsFollowed) {
  struct Case {
    const char* name;
    std::vector<int> cameras;
  };
  for (const Case& c : {Case{"V1_01", {0, 1}}, Case{"V1_03", {0}}}) {
    const std::filesystem::path folder = DataFolder() / "openvins_sim" / c.name;
    if (!std::filesystem::exists(folder)) {
      GTEST_SKIP() << "no " << folder << ": set DUET_DATA to the folder of recordings";
    }
    RecordingOptions options;
    options.cameras = c.cameras;
    options.source = RecordingOptions::Source::kTracks;
    const Score score = RunOn(LoadRecording(folder, options));
    RecordProperty(std::string(c.name) + "_position_mm", static_cast<int>(1e3 * score.position_m));
    EXPECT_LT(score.position_m, 0.05) << c.name;
    EXPECT_LT(score.orientation_deg, 0.4) << c.name;
    EXPECT_GE(score.frames, 780) << c.name;
  }
}

}  // namespace
}  // namespace duet
