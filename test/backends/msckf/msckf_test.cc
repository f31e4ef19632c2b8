// The filter as a whole, on simulated recordings.

#include "backends/msckf/msckf.h"

#include <gtest/gtest.h>

#include <cstring>

#include "common/measurement/told_errors.h"
#include "experiments/simulation/simulator.h"
#include "test/backends/msckf/random_state.h"
#include "test/seeds.h"

namespace duet {
namespace {

Matrix15d StartCovariance() {
  Vector15d sigma;
  sigma << 0.01, 0.01, 1e-4, Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(0.05),
      Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.1);
  return sigma.array().square().matrix().asDiagonal();
}

SimulationOptions Room(int seed, double duration_s) {
  SimulationOptions options = SimulationPreset("room_easy");
  options.seed = seed;
  options.duration_s = duration_s;
  return options;
}

// Feeds a recording to a filter as the loop does.
class Feeder {
 public:
  Feeder(const SimulatedRecording& recording, const SharedOptions& shared,
         const MsckfOptions& options = {})
      : recording_(recording), shared_(shared), filter_(MakeSetup(recording, shared), options) {}

  void StartAtTruth() { Start(recording_.TruthAt(FirstInstant())); }
  void StartDrawn(std::uint64_t seed) {
    Random random(seed);
    filter_.Initialize(
        DrawInitialCondition(recording_.TruthAt(FirstInstant()), StartCovariance(), &random));
  }
  void Start(const InertialState& state) { filter_.Initialize({state, StartCovariance()}); }

  const EstimatorOutput& Feed(const TrackFrameSet& frames) {
    const Timestamp until =
        frames.timestamp + ToNanoseconds(ImuHorizon(shared_)) + ToNanoseconds(0.006);
    while (next_imu_ < recording_.imu.size() && recording_.imu[next_imu_].timestamp <= until) {
      filter_.AddImu(recording_.imu[next_imu_++]);
    }
    return filter_.ProcessFrame(frames);
  }
  Msckf& filter() { return filter_; }
  [[nodiscard]] Timestamp FirstInstant() const {
    return recording_.frames.front().timestamp + ToNanoseconds(recording_.told_rig.t_d_s);
  }

 private:
  const SimulatedRecording& recording_;
  SharedOptions shared_;
  Msckf filter_;
  std::size_t next_imu_ = 0;
};

Vector15d ErrorOf(const EstimatorOutput& output, const SimulatedRecording& recording) {
  return BoxMinus(recording.TruthAt(output.state.instant), output.state);
}

// Mean NEES of the pose over 8 runs of 15 s and the instants after 2 s. Instants of a run go
// together: a run's mean has a standard deviation of about 3, that of eight about 1.
TEST(Msckf, IsConsistentWithItsCovariance) {
  double sum = 0.0;
  int count = 0;
  for (int seed = 1; seed <= test::Seeds(8, 2); ++seed) {
    const SimulatedRecording recording = Simulate(Room(seed, 15.0));
    Feeder feeder(recording, SharedOptions());
    feeder.StartDrawn(seed);
    for (const TrackFrameSet& frames : recording.frames) {
      const EstimatorOutput& output = feeder.Feed(frames);
      ASSERT_EQ(output.status, EstimatorStatus::kTracking) << output.reason;
      if (SecondsBetween(recording.frames.front().timestamp, frames.timestamp) < 2.0) continue;
      const Eigen::Matrix<double, 6, 1> e = ErrorOf(output, recording).head<6>();
      sum += e.dot(output.covariance.topLeftCorner<6, 6>().ldlt().solve(e));
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 6.0, 3.0);
}

TEST(Msckf, CalibratesPositionOfTheCameraAndTimeOffset) {
  SharedOptions shared;
  shared.calibration.p_CB.estimated = true;
  shared.calibration.t_d.estimated = true;
  SimulationOptions options = SimulationPreset("excited");
  options.duration_s = 15.0;
  options.t_d_s = 0.004;
  options.told_errors = ToldErrorsOfPriors(shared.calibration);
  const SimulatedRecording recording = Simulate(options);
  Feeder feeder(recording, shared);
  feeder.StartDrawn(3);
  EstimatorOutput output;
  for (const TrackFrameSet& frames : recording.frames) output = feeder.Feed(frames);
  ASSERT_EQ(output.status, EstimatorStatus::kTracking) << output.reason;

  const CalibrationLayout& layout = feeder.filter().layout();
  const Eigen::VectorXd error = BoxMinus(recording.true_rig, output.rig, layout);
  const Eigen::MatrixXd P = output.covariance.bottomRightCorner(4, 4);
  // chi-squared with 4 degrees of freedom stays below 23.5 with 99.99 %.
  EXPECT_LT(error.dot(P.ldlt().solve(error)), 23.5);
  // ... and says something: a tenth of the prior of t_d (10 ms), a fifth of that of p_CB (2 cm).
  EXPECT_LT(std::sqrt(P(3, 3)), 1e-3);
  EXPECT_LT(std::sqrt(P.diagonal().head<3>().maxCoeff()), 4e-3);
}

TEST(Msckf, HoldsItsPlaceAtRest) {
  SimulationOptions options = SimulationPreset("room_rest");
  options.rest_s = 12.0;
  options.duration_s = 12.0;
  options.pixel_noise_px = 0.2;
  const SimulatedRecording recording = Simulate(options);
  double drift_m[2];
  for (const bool enabled : {true, false}) {
    SharedOptions shared;
    shared.standstill.enabled = enabled;
    Feeder feeder(recording, shared);
    feeder.StartDrawn(5);
    int at_rest = 0;
    for (const TrackFrameSet& frames : recording.frames) {
      const EstimatorOutput& output = feeder.Feed(frames);
      at_rest += output.standstill;
      drift_m[enabled] = ErrorOf(output, recording).segment<3>(3).norm();
    }
    if (enabled) {
      EXPECT_GT(at_rest, 200);
    } else {
      EXPECT_EQ(at_rest, 0);
    }
  }
  // Half a second passes before rest is seen, at 5 cm/s of start error.
  EXPECT_LT(drift_m[true], 0.06);
  EXPECT_GT(drift_m[false], 2.0 * drift_m[true]);
}

TEST(Msckf, FailsByTheSharedRule) {
  const SimulatedRecording recording = Simulate(Room(1, 2.0));
  SharedOptions shared;
  shared.failure.max_velocity_m_per_s = 0.1;  // room_easy moves at 0.5 m/s
  Feeder feeder(recording, shared);
  feeder.StartDrawn(1);
  EstimatorOutput last;
  for (const TrackFrameSet& frames : recording.frames) last = feeder.Feed(frames);
  EXPECT_EQ(last.status, EstimatorStatus::kFailed);
  EXPECT_NE(last.reason.find("shared.failure.max_velocity_m_per_s"), std::string::npos);
}

TEST(Msckf, GivesTheSameBytesTwice) {
  const SimulatedRecording recording = Simulate(Room(1, 4.0));
  std::vector<std::string> bytes;
  for (int run = 0; run < 2; ++run) {
    Feeder feeder(recording, SharedOptions());
    feeder.StartDrawn(1);
    std::string all;
    for (const TrackFrameSet& frames : recording.frames) {
      const EstimatorOutput& output = feeder.Feed(frames);
      const auto append = [&](const double* data, Eigen::Index size) {
        all.append(reinterpret_cast<const char*>(data), sizeof(double) * size);
      };
      append(output.state.nav.p_GB.data(), 3);
      append(output.state.nav.R_GB.coeffs().data(), 4);
      append(output.covariance.data(), output.covariance.size());
    }
    bytes.push_back(all);
  }
  EXPECT_TRUE(bytes[0] == bytes[1]);
}

TEST(Msckf, TheThesissTrapezoidsChangeTheCovarianceAlone) {
  // Before the first update: the state goes the same way, its covariance almost (200 Hz).
  const SimulatedRecording recording = Simulate(Room(1, 2.0));
  EstimatorOutput outputs[2];
  for (const bool trapezoids : {false, true}) {
    SharedOptions shared;
    shared.calibration.T_g.estimated = true;
    MsckfOptions options;
    options.transition = trapezoids ? MsckfOptions::TransitionRule::kThesisTrapezoid
                                    : MsckfOptions::TransitionRule::kDelta;
    Feeder feeder(recording, shared, options);
    feeder.StartDrawn(1);
    for (int frame = 0; frame < 3; ++frame)
      outputs[trapezoids] = feeder.Feed(recording.frames[frame]);
    ASSERT_EQ(outputs[trapezoids].features.used, 0);
  }
  EXPECT_EQ(outputs[0].state.nav.p_GB, outputs[1].state.nav.p_GB);
  EXPECT_EQ(outputs[0].state.nav.R_GB.coeffs(), outputs[1].state.nav.R_GB.coeffs());
  const double off = (outputs[1].covariance - outputs[0].covariance).norm();
  EXPECT_GT(off, 1e-12 * outputs[0].covariance.norm());
  EXPECT_LT(off, 1e-2 * outputs[0].covariance.norm());
}

TEST(Msckf, OutliersAreRefused) {
  SimulationOptions options = Room(2, 10.0);
  options.outlier_share = 0.02;
  const SimulatedRecording recording = Simulate(options);
  Feeder feeder(recording, SharedOptions());
  feeder.StartAtTruth();
  int gated = 0;  // as a whole, or but for some pixels
  int refused = 0;
  double error_m = 0.0;
  for (const TrackFrameSet& frames : recording.frames) {
    const EstimatorOutput& output = feeder.Feed(frames);
    gated += output.features.gated + output.features.cleaned;
    refused += output.features.not_triangulated;
    error_m = ErrorOf(output, recording).segment<3>(3).norm();
  }
  EXPECT_GT(gated + refused, 200);
  EXPECT_LT(error_m, 0.15);
}

TEST(Msckf, OneBadPixelDoesNotCostATrack) {
  SimulationOptions simulation = Room(2, 10.0);
  simulation.outlier_share = 0.02;
  const SimulatedRecording recording = Simulate(simulation);
  int gated[2] = {};
  int used[2] = {};
  int cleaned[2] = {};
  for (const bool remove : {false, true}) {
    MsckfOptions options;
    options.remove_outliers = remove;
    Feeder feeder(recording, SharedOptions(), options);
    feeder.StartAtTruth();
    for (const TrackFrameSet& frames : recording.frames) {
      const FeatureCounts& counts = feeder.Feed(frames).features;
      gated[remove] += counts.gated;
      used[remove] += counts.used;
      cleaned[remove] += counts.cleaned;
    }
  }
  EXPECT_EQ(cleaned[false], 0);
  EXPECT_GT(cleaned[true], 200);
  EXPECT_LT(gated[true], gated[false] / 3);
  EXPECT_GT(used[true], used[false] + 200);
}

TEST(Msckf, WaitsForItsStart) {
  const SimulatedRecording recording = Simulate(Room(1, 2.0));
  Feeder feeder(recording, SharedOptions());
  EXPECT_EQ(feeder.Feed(recording.frames[0]).status, EstimatorStatus::kInitializing);
  // A start between the frames 4 and 5: the frames before are left out.
  const Timestamp start = recording.frames[4].timestamp + ToNanoseconds(0.02);
  feeder.Start(recording.TruthAt(start));
  for (int i = 1; i <= 4; ++i) {
    EXPECT_EQ(feeder.Feed(recording.frames[i]).status, EstimatorStatus::kInitializing);
  }
  const EstimatorOutput& output = feeder.Feed(recording.frames[5]);
  EXPECT_EQ(output.status, EstimatorStatus::kTracking);
  EXPECT_EQ(output.state.instant, recording.frames[5].timestamp);
  EXPECT_LT(ErrorOf(output, recording).segment<3>(3).norm(), 1e-3);
}

TEST(Msckf, LeavesOutFramesThatTheImuDoesNotCover) {
  const SimulatedRecording recording = Simulate(Room(1, 2.0));
  Msckf filter(MakeSetup(recording, SharedOptions()), MsckfOptions());
  const Timestamp first = recording.frames.front().timestamp;
  filter.Initialize({recording.TruthAt(first), StartCovariance()});
  const Timestamp imu_end = first + ToNanoseconds(0.52);
  for (const ImuSample& sample : recording.imu) {
    if (sample.timestamp <= imu_end) filter.AddImu(sample);
  }
  int tracked = 0;
  for (const TrackFrameSet& frames : recording.frames) {
    const EstimatorOutput& output = filter.ProcessFrame(frames);
    if (frames.timestamp <= imu_end) {
      EXPECT_EQ(output.status, EstimatorStatus::kTracking);
      ++tracked;
    } else {
      EXPECT_EQ(output.status, EstimatorStatus::kDeadReckoning);
      EXPECT_NE(output.reason.find("IMU"), std::string::npos);
    }
  }
  EXPECT_EQ(filter.skipped_frames(), static_cast<int>(recording.frames.size()) - tracked);
  EXPECT_FALSE(filter.PredictAt(imu_end + ToNanoseconds(0.1)).has_value());
}

TEST(Msckf, FailsWithAReasonOverAnImuGap) {
  SimulatedRecording recording = Simulate(Room(1, 2.0));
  const Timestamp gap = recording.frames.front().timestamp + ToNanoseconds(0.5);
  std::erase_if(recording.imu, [&](const ImuSample& s) {
    return s.timestamp > gap && s.timestamp < gap + ToNanoseconds(0.2);
  });
  Feeder feeder(recording, SharedOptions());
  feeder.StartAtTruth();
  EstimatorOutput output;
  for (const TrackFrameSet& frames : recording.frames) output = feeder.Feed(frames);
  EXPECT_EQ(output.status, EstimatorStatus::kFailed);
  EXPECT_NE(output.reason.find("gap"), std::string::npos) << output.reason;
}

TEST(Msckf, SaysWhenItIsDeadReckoning) {
  SimulatedRecording recording = Simulate(Room(1, 4.0));
  Feeder feeder(recording, SharedOptions());
  feeder.StartAtTruth();
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    TrackFrameSet frames = recording.frames[i];
    if (i >= 40) frames.frames[0].observations.clear();
    const EstimatorOutput& output = feeder.Feed(frames);
    // The tracks of frame 39 end in frame 40: its update is the last.
    EXPECT_EQ(output.status, i < 60 ? EstimatorStatus::kTracking : EstimatorStatus::kDeadReckoning)
        << i;
  }
}

TEST(Msckf, PredictsBetweenFrames) {
  const SimulatedRecording recording = Simulate(Room(1, 2.0));
  Feeder feeder(recording, SharedOptions());
  EXPECT_FALSE(feeder.filter().PredictAt(recording.frames[0].timestamp).has_value());
  feeder.StartAtTruth();
  for (int i = 0; i < 20; ++i) feeder.Feed(recording.frames[i]);
  const EstimatorOutput& output = feeder.Feed(recording.frames[20]);
  const Timestamp now = output.state.instant;
  ASSERT_TRUE(feeder.filter().PredictAt(now).has_value());
  EXPECT_EQ(feeder.filter().PredictAt(now)->p_GB, output.state.nav.p_GB);
  const auto ahead = feeder.filter().PredictAt(now + ToNanoseconds(0.015));
  ASSERT_TRUE(ahead.has_value());
  // 15 ms at 0.5 m/s; the rest is acceleration.
  EXPECT_LT((ahead->p_GB - output.state.nav.p_GB - 0.015 * output.state.nav.v_GB).norm(), 1e-3);
  EXPECT_FALSE(
      feeder.filter().PredictAt(recording.frames[0].timestamp - ToNanoseconds(0.1)).has_value());
}

}  // namespace
}  // namespace duet
