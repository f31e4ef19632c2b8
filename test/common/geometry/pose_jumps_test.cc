#include "common/geometry/pose_jumps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/common/geometry/rotation_vectors.h"

namespace duet {
namespace {

const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

// A flight as an IMU with biases sees it, and its truth with noise and steps.
class PoseJumpsTest : public testing::Test {
 protected:
  void Fly(double rate_hz, double duration_s) {
    Random random(1);
    const Eigen::Vector3d b_g(0.02, -0.07, 0.08), b_a(0.1, -0.4, 0.2);
    const auto count = static_cast<int>(std::lround(rate_hz * duration_s));
    std::vector<Eigen::Vector3d> v;
    for (int i = 0; i <= count; ++i) {
      const double t = i / rate_hz;
      const Eigen::Vector3d p(std::sin(2.0 * t), 2.0 * std::cos(1.5 * t), std::sin(3.0 * t) / 3.0);
      v.emplace_back(2.0 * std::cos(2.0 * t), -3.0 * std::sin(1.5 * t), std::cos(3.0 * t));
      clean_.push_back({ToNanoseconds(t),
                        {ExpQuaternion({std::sin(1.3 * t), 0.4 * std::cos(2.0 * t), 0.8 * t}), p}});
    }
    for (int i = 0; i < count; ++i) {
      const double dt = 1.0 / rate_hz;
      const Pose& a = clean_[i].T_GB;
      const Pose& b = clean_[i + 1].T_GB;
      RelativeMotion m;
      m.R = a.R.conjugate() * b.R * ExpQuaternion(b_g * dt);
      m.s = a.R.conjugate() * (v[i + 1] - v[i] - kGravity * dt) + b_a * dt;
      m.y = a.R.conjugate() * (b.p - a.p - v[i] * dt - 0.5 * kGravity * dt * dt) +
            0.5 * b_a * dt * dt;
      motion_.push_back(m);
    }
    poses_ = clean_;
    for (StampedPose& pose : poses_) {
      pose.T_GB.p += 2e-5 * RandomVector(&random);
      pose.T_GB.R = BoxPlus(pose.T_GB.R, 2e-5 * RandomVector(&random));
    }
  }

  void Step(std::size_t index, const Eigen::Vector3d& displacement,
            const Eigen::Vector3d& rotation = Eigen::Vector3d::Zero()) {
    for (std::size_t i = index + 1; i < poses_.size(); ++i) {
      poses_[i].T_GB.p += displacement;
      poses_[i].T_GB.R = BoxPlus(poses_[i].T_GB.R, rotation);
    }
  }

  std::vector<StampedPose> clean_, poses_;
  std::vector<std::optional<RelativeMotion>> motion_;
};

TEST_F(PoseJumpsTest, FindsNoneWhereThereIsNone) {
  Fly(200.0, 10.0);
  EXPECT_TRUE(FindPoseJumps(poses_, motion_, kGravity).empty());
  EXPECT_TRUE(FindPoseJumps(poses_).empty());
  EXPECT_TRUE(FindPoseJumps({}).empty());
  EXPECT_TRUE(FindPoseJumps({poses_[0]}, {}, kGravity).empty());
}

TEST_F(PoseJumpsTest, FindsEachWithItsInstantAndSize) {
  Fly(200.0, 10.0);
  const Eigen::Vector3d step1(0.002, 0.0, -0.001), step2(0.05, -0.1, 0.0), step3(0, 0.003, 0);
  const Eigen::Vector3d turn(0.0, 0.01, 0.02);
  Step(0, step1);
  Step(700, step2);
  Step(701, step3, turn);
  Step(1998, step1);
  const std::vector<PoseJump> jumps = FindPoseJumps(poses_, motion_, kGravity);
  ASSERT_EQ(jumps.size(), 4);
  // A departure is a difference of four poses with noise of 2e-5 in each axis.
  const double tolerance = 3e-4;
  EXPECT_EQ(jumps[0].index, 0);
  EXPECT_EQ(jumps[1].index, 700);
  EXPECT_EQ(jumps[1].before, poses_[700].timestamp);
  EXPECT_EQ(jumps[1].after, poses_[701].timestamp);
  EXPECT_LT((jumps[1].displacement - step2).norm(), tolerance);
  EXPECT_EQ(jumps[1].rotation.norm(), 0.0);
  EXPECT_EQ(jumps[2].index, 701);
  EXPECT_LT((jumps[2].displacement - step3).norm(), tolerance);
  EXPECT_LT((jumps[2].rotation - turn).norm(), tolerance);
  EXPECT_EQ(jumps[3].index, 1998);
  EXPECT_LT((jumps[3].displacement - step1).norm(), tolerance);

  // Without an IMU the acceleration (0.2 mm an interval) hides the small ones.
  const std::vector<PoseJump> alone = FindPoseJumps(poses_);
  ASSERT_EQ(alone.size(), 2);
  EXPECT_EQ(alone[0].index, 700);
  EXPECT_LT((alone[0].displacement - step2).norm(), 4e-3);
  EXPECT_EQ(alone[1].index, 701);
  EXPECT_LT((alone[1].rotation - turn).norm(), 1e-3);
}

TEST_F(PoseJumpsTest, ASingleBadPoseJumpsThereAndBack) {
  Fly(200.0, 5.0);
  poses_[500].T_GB.p.x() += 0.01;
  const std::vector<PoseJump> jumps = FindPoseJumps(poses_, motion_, kGravity);
  ASSERT_EQ(jumps.size(), 2);
  EXPECT_EQ(jumps[0].index, 499);
  EXPECT_EQ(jumps[1].index, 500);
  EXPECT_NEAR(jumps[0].displacement.x(), 0.01, 2e-4);  // the noise
  EXPECT_NEAR(jumps[1].displacement.x(), -0.01, 2e-4);
}

TEST_F(PoseJumpsTest, FindsJumpsOfCoarseTruthAgainstTheImu) {
  Fly(20.0, 30.0);
  Step(100, {0.0, 0.004, 0.0});
  Step(333, {0.009, 0.0, 0.0});
  const std::vector<PoseJump> jumps = FindPoseJumps(poses_, motion_, kGravity);
  ASSERT_EQ(jumps.size(), 2);
  EXPECT_EQ(jumps[0].index, 100);
  EXPECT_EQ(jumps[1].index, 333);
  // Poses alone don't tell it from 0.05 s of acceleration.
  EXPECT_TRUE(FindPoseJumps(poses_).empty());
}

TEST_F(PoseJumpsTest, JudgesNothingWhereTheImuIsSilent) {
  Fly(200.0, 5.0);
  Step(100, {0.01, 0.0, 0.0});
  Step(500, {0.01, 0.0, 0.0});
  for (int i = 480; i < 520; ++i) motion_[i].reset();
  const std::vector<PoseJump> jumps = FindPoseJumps(poses_, motion_, kGravity);
  ASSERT_EQ(jumps.size(), 1);
  EXPECT_EQ(jumps[0].index, 100);
}

TEST_F(PoseJumpsTest, RemovingJumpsRestoresTheTrajectory) {
  Fly(200.0, 5.0);
  Step(300, {0.05, 0.0, 0.02}, {0.0, 0.0, 0.03});
  Step(600, {0.0, -0.03, 0.0}, {0.02, 0.0, 0.0});
  RemovePoseJumps(FindPoseJumps(poses_, motion_, kGravity), &poses_);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    // Two jumps known to the noise of a few poses.
    EXPECT_LT((poses_[i].T_GB.p - clean_[i].T_GB.p).norm(), 1e-3);
    EXPECT_LT(BoxMinus(poses_[i].T_GB.R, clean_[i].T_GB.R).norm(), 1e-3);
  }
  EXPECT_TRUE(FindPoseJumps(poses_, motion_, kGravity).empty());
}

TEST_F(PoseJumpsTest, RemovingTurnsBackWhatLaterJumpsTurned) {
  Fly(200.0, 5.0);
  Step(300, {0.05, 0.0, 0.02}, {0.3, -0.2, 0.5});
  const Eigen::Vector3d second(-0.4, 0.1, 0.0);
  Step(600, {0.0, -0.03, 0.0}, second);
  std::vector<PoseJump> jumps(2);
  jumps[0].index = 300;
  jumps[0].displacement = {0.05, 0.0, 0.02};
  jumps[0].rotation = {0.3, -0.2, 0.5};
  jumps[1].index = 600;
  jumps[1].displacement = {0.0, -0.03, 0.0};
  jumps[1].rotation = second;
  std::vector<StampedPose> restored = poses_;
  RemovePoseJumps(jumps, &restored);
  for (std::size_t i = 0; i < restored.size(); ++i) {
    EXPECT_LT((restored[i].T_GB.p - clean_[i].T_GB.p).norm(), 2e-4);  // the noise
    EXPECT_LT(BoxMinus(restored[i].T_GB.R, clean_[i].T_GB.R).norm(), 2e-4);
  }
}

}  // namespace
}  // namespace duet
