#include "experiments/estimation_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/support/text_file.h"
#include "experiments/late_start.h"

namespace duet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr Timestamp kStart = 1'000'000'000;
constexpr Timestamp kImuStep = 5'000'000;
constexpr Timestamp kFrameStep = 50'000'000;
constexpr double kHorizon_s = 0.012;

/// Notes what it is given; says that it tracks, until it is told to fail.
class NotingEstimator : public Estimator {
 public:
  void Initialize(const InitialCondition& initial) override {
    calls.push_back("initialize");
    initialized_at = initial.state.instant;
  }
  void AddImu(const ImuSample& sample) override { last_imu = sample.timestamp; }
  const EstimatorOutput& ProcessFrame(const TrackFrameSet& frames) override {
    calls.push_back("frame");
    imu_before_frame.push_back(last_imu - frames.timestamp);
    output.frame_timestamp = frames.timestamp;
    if (static_cast<int>(imu_before_frame.size()) <= skips) {
      output.status = EstimatorStatus::kDeadReckoning;
      return output;
    }
    output.state.instant = frames.timestamp;
    output.status = static_cast<int>(imu_before_frame.size()) == fails_at
                        ? EstimatorStatus::kFailed
                        : EstimatorStatus::kTracking;
    output.reason = "told to";
    output.covariance = Eigen::MatrixXd::Identity(15, 15);
    return output;
  }
  std::optional<NavState> PredictAt(Timestamp /*t*/) const override { return std::nullopt; }
  const CalibrationLayout& layout() const override { return layout_; }

  int skips = 0;  ///< so many frames, before the first that it takes
  int fails_at = -1;
  std::vector<std::string> calls;
  std::vector<Timestamp> imu_before_frame;  ///< newest sample, against the frame's stamp
  Timestamp last_imu = 0;
  Timestamp initialized_at = 0;
  EstimatorOutput output;

 private:
  CalibrationLayout layout_;
};

class EstimationLoopTest : public testing::Test {
 protected:
  EstimationLoopTest() {
    folder_ = std::filesystem::path(testing::TempDir()) / "estimation_loop_test";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    for (Timestamp t = 0; t <= 3 * kStart; t += kImuStep) {
      imu_.push_back({t, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 9.81)});
      truth_.push_back({t, Pose()});
    }
    setup_.imu_noise = {1e-3, 1e-2, 1e-4, 1e-3};
  }
  ~EstimationLoopTest() override { std::filesystem::remove_all(folder_); }

  /// `first` is the stamp of the first frame.
  LoopOutcome Run(NotingEstimator* estimator, Timestamp first, RunSummary* summary, int count = 4) {
    std::vector<TrackFrameSet> sets;
    for (int i = 0; i < count; ++i) {
      const Timestamp t = first + i * kFrameStep;
      sets.push_back({t, {{t, 0, {{7, 1.0F, 2.0F}}}}});
    }
    TrackReplay frames(std::move(sets));
    EstimatorStart start(StartMode::kGroundTruth, setup_, InitializationOptions(), truth_, imu_);
    RunRecorder recorder(folder_, estimator->layout(), RigCalibration(), TimeBounds(), true);
    TimingLog timing;
    Progress progress("test", 4, "frames", true);
    const LoopOutcome outcome = RunEstimationLoop(
        {frames, imu_, kHorizon_s, start, *estimator, recorder, timing, progress});
    recorder.Close();
    *summary = recorder.summary();
    return outcome;
  }

  std::filesystem::path folder_;
  std::vector<ImuSample> imu_;
  std::vector<StampedPose> truth_;
  EstimatorSetup setup_;
  RunSummary summary_;
};

TEST_F(EstimationLoopTest, FeedsTheImuUpToTheHorizonAndOneSampleBeforeEachFrame) {
  NotingEstimator estimator;
  EXPECT_EQ(Run(&estimator, kStart, &summary_), LoopOutcome::kDone);
  EXPECT_THAT(estimator.calls, ElementsAre("initialize", "frame", "frame", "frame", "frame"));
  EXPECT_EQ(estimator.initialized_at, kStart);
  // The horizon of 12 ms lies between samples at 10 and 15 ms.
  EXPECT_THAT(estimator.imu_before_frame, testing::Each(Timestamp{15'000'000}));
  EXPECT_EQ(summary_.tracking, 4);
  EXPECT_EQ(summary_.first_instant, kStart);
  EXPECT_EQ(summary_.last_instant, kStart + 3 * kFrameStep);
}

TEST_F(EstimationLoopTest, FramesBeforeTheStartWaitAndAreCounted) {
  constexpr int kFrames = 30;
  constexpr Timestamp kTruthStart = kStart + 20 * kFrameStep;
  std::erase_if(truth_, [](const StampedPose& pose) { return pose.timestamp < kTruthStart; });
  NotingEstimator estimator;
  EXPECT_EQ(Run(&estimator, kStart, &summary_, kFrames), LoopOutcome::kDone);
  EXPECT_EQ(summary_.frames, kFrames);
  EXPECT_GT(summary_.waiting, 0);
  EXPECT_EQ(summary_.waiting + summary_.tracking, kFrames);
  EXPECT_EQ(estimator.initialized_at, kStart + summary_.waiting * kFrameStep);
  EXPECT_DOUBLE_EQ(summary_.waited_s, 1e-9 * static_cast<double>(summary_.waiting * kFrameStep));
  EXPECT_THAT(ReadTextFile(folder_ / "features.csv"), HasSubstr("1000000000,initializing,1,0"));
}

TEST_F(EstimationLoopTest, FramesThatAreSkippedBeforeTheFirstLeaveNoState) {
  NotingEstimator estimator;
  estimator.skips = 2;
  EXPECT_EQ(Run(&estimator, kStart, &summary_), LoopOutcome::kDone);
  EXPECT_EQ(summary_.skipped, 2);
  EXPECT_EQ(summary_.first_instant, kStart + 2 * kFrameStep);
  EXPECT_THAT(ReadTextFile(folder_ / "states.csv"), Not(HasSubstr("\n0,")));
}

TEST(LateStartTest, IsWarnedOfFromAFifthOfTheFramesOrFiveSeconds) {
  EXPECT_FALSE(LateStartWarning({.frames_waited = 0, .frames = 0}));
  EXPECT_FALSE(LateStartWarning({.frames_waited = 0, .frames = 10}));
  EXPECT_FALSE(LateStartWarning({.frames_waited = 2, .frames = 10, .waited_s = 0.1}));
  EXPECT_FALSE(LateStartWarning({.frames_waited = 100, .frames = 1000, .waited_s = 5.0}));
  EXPECT_TRUE(LateStartWarning({.frames_waited = 101, .frames = 1000, .waited_s = 5.05}));
  EXPECT_EQ(LateStartWarning({.frames_waited = 3, .frames = 10, .waited_s = 0.15, .missing = "x"}),
            "started only after 0.15 s: 3 of 10 frames (30.0 %) have no estimate; until then x");
}

TEST_F(EstimationLoopTest, WithoutAStartTheRunFails) {
  truth_.resize(10);
  NotingEstimator estimator;
  EXPECT_EQ(Run(&estimator, kStart, &summary_), LoopOutcome::kFailed);
  EXPECT_TRUE(estimator.calls.empty());
}

TEST_F(EstimationLoopTest, EndsWithTheEstimatorsFailureAndKeepsItsReason) {
  NotingEstimator estimator;
  estimator.fails_at = 3;
  EXPECT_EQ(Run(&estimator, kStart, &summary_), LoopOutcome::kFailed);
  EXPECT_EQ(summary_.frames, 3);
  EXPECT_EQ(summary_.failure, "told to");
  EXPECT_EQ(summary_.failure_instant, kStart + 2 * kFrameStep);
  EXPECT_EQ(summary_.last_instant, kStart + kFrameStep);  // the last good state
}

TEST_F(EstimationLoopTest, StatesAndTrajectoryHoldEachInstantExactly) {
  NotingEstimator estimator;
  estimator.output.state.nav.p_GB = {0.1, -2.0, 1.0 / 3.0};
  EXPECT_EQ(Run(&estimator, kStart + 1, &summary_), LoopOutcome::kDone);
  EXPECT_THAT(ReadTextFile(folder_ / "trajectory.tum"),
              HasSubstr("\n1.000000001 0.1 -2 0.3333333333333333 0 0 0 1\n"));
  EXPECT_THAT(ReadTextFile(folder_ / "states.csv"),
              HasSubstr("\n1000000001,1000000001,tracking,0,0,0,1,0.1,-2,0.3333333333333333,0,0,0,"
                        "0,0,0,0,0,0,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1\n"));
  EXPECT_THAT(ReadTextFile(folder_ / "covariance.csv"), HasSubstr("\n1000000001,15,1,0,1,0,0,1,"));
}

}  // namespace
}  // namespace duet
