#include "experiments/simulation/spline_trajectory.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/dataset/ground_truth.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/simulation/trajectory_library.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr Timestamp kSplineStart = 1'400'000'000'000'000'000;

std::vector<StampedPose> Poses(const Trajectory& trajectory, double rate_hz) {
  std::vector<StampedPose> poses;
  for (int i = 0; i / rate_hz <= trajectory.duration_s(); ++i) {
    poses.push_back({kSplineStart + ToNanoseconds(i / rate_hz), trajectory.At(i / rate_hz).T_GB});
  }
  return poses;
}

std::string ErrorOf(const std::vector<StampedPose>& poses) {
  try {
    static_cast<void>(SplineThrough(poses, "truth.csv"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// The file's poses come back, and the motion between them: EuRoC's form and TUM's, 200 and 20 Hz.
TEST(SplineThroughFile, FollowsTheFlightThatTheFileWasWrittenOf) {
  const auto flight = MakeTrajectory("V1_02_medium", 20.0, 2.0);
  for (const double rate_hz : {200.0, 20.0}) {
    for (const bool tum : {true, false}) {
      const fs::path file = fs::path(testing::TempDir()) / "duet_spline_truth.txt";
      GroundTruth truth;
      truth.poses = Poses(*flight, rate_hz);
      WriteTextFile(file, tum ? WriteTumTrajectory(truth.poses) : WriteGroundTruthTable(truth));
      const auto spline = SplineThroughFile(file);
      fs::remove(file);
      ASSERT_NEAR(spline->duration_s(), 20.0, 1e-9);
      for (double t = 0.2; t < 19.8; t += 0.0737) {
        const Kinematics a = spline->At(t);
        const Kinematics b = flight->At(t);
        // PoseSpline's bounds for knots up to 50 ms apart and wobbles of 6 rad/s: positions to h^6,
        // accelerations to h^4 ((6 rad/s 0.05 s)^4 = 0.8 % of a wobble's 0.7 m/s^2), rates to h^2
        // (1e-4 |omega x omega'|).
        EXPECT_LT((a.T_GB.p - b.T_GB.p).norm(), 2e-6);
        EXPECT_LT((a.a_G - b.a_G).norm(), 6e-3);
        EXPECT_LT((a.omega_B - b.omega_B).norm(), 1e-4);
      }
    }
  }
}

TEST(SplineThrough, RefusesWhatIsNoMotionInOneLine) {
  const auto flight = MakeTrajectory("room_walk", 5.0, 0.0);
  const std::vector<StampedPose> good = Poses(*flight, 200.0);
  EXPECT_EQ(ErrorOf(good), "no error");

  EXPECT_EQ(ErrorOf({good.begin(), good.begin() + 5}),
            "truth.csv: 5 poses; a trajectory needs at least 6");

  std::vector<StampedPose> repeated = good;
  repeated[100].timestamp = repeated[99].timestamp;
  EXPECT_EQ(ErrorOf(repeated),
            "truth.csv: at 0.495 s (stamp 1400000000495000000) a stamp does not come after the one "
            "before; expected strictly increasing stamps");

  std::vector<StampedPose> gap = good;
  gap.erase(gap.begin() + 200, gap.begin() + 250);
  EXPECT_EQ(
      ErrorOf(gap),
      "truth.csv: at 0.995 s (stamp 1400000000995000000) poses are missing for 0.255 s; knots "
      "0.030 s apart bridge four of them at most");

  std::vector<StampedPose> jump = good;
  for (std::size_t i = 400; i < jump.size(); ++i) jump[i].T_GB.p.x() += 0.05;
  const std::string moved = ErrorOf(jump);
  EXPECT_NE(moved.find("the position jumps"), std::string::npos) << moved;

  std::vector<StampedPose> turn = good;
  for (std::size_t i = 400; i < turn.size(); ++i) {
    turn[i].T_GB.R = BoxPlus(turn[i].T_GB.R, Vector3d(0, 0, 0.3));
  }
  const std::string turned = ErrorOf(turn);
  EXPECT_NE(turned.find("at 2.000 s"), std::string::npos) << turned;
  EXPECT_NE(turned.find("the orientation jumps"), std::string::npos) << turned;
}

TEST(SplineThrough, BridgesJumpsWhereAsked) {
  const auto flight = MakeTrajectory("room_walk", 5.0, 0.0);
  std::vector<StampedPose> jump = Poses(*flight, 200.0);
  for (std::size_t i = 400; i < jump.size(); ++i) jump[i].T_GB.p.x() += 0.05;
  const auto spline = SplineThrough(jump, "truth.csv", {.bridge_jumps = true});
  // 2 to 3 s, across the jump: the speed stays the flight's (found to half a millimetre in 5 ms,
  // without an IMU).
  for (double t = 1.5; t < 2.5; t += 0.01) {
    EXPECT_LT((spline->At(t).v_GB - flight->At(t).v_GB).norm(), 0.02);
  }
}

}  // namespace
}  // namespace duet
