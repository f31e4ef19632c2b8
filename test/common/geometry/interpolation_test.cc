#include "common/geometry/interpolation.h"

#include <gtest/gtest.h>

#include "test/common/geometry/rotation_vectors.h"

namespace duet {
namespace {

std::vector<StampedPose> TwoPoses() {
  // EuRoC's stamps: 1.4e18 ns, beyond a double's integers.
  const Timestamp t = 1403636583763555584;
  return {{t, {ExpQuaternion({0.0, 0.0, 0.2}), {1.0, 2.0, 3.0}}},
          {t + 20000000, {ExpQuaternion({0.0, 0.0, 0.6}), {2.0, 0.0, 3.0}}}};
}

TEST(InterpolatePose, IsLinearAndSlerp) {
  std::vector<StampedPose> poses = TwoPoses();
  for (const double sign : {1.0, -1.0}) {
    poses[1].T_GB.R.coeffs() *= sign;
    const auto pose = InterpolatePose(poses, poses[0].timestamp + 5000000, 0.06);
    ASSERT_TRUE(pose);
    EXPECT_LT((pose->p - Eigen::Vector3d(1.25, 1.5, 3.0)).norm(), 1e-15);
    EXPECT_LT(BoxMinus(pose->R, ExpQuaternion({0.0, 0.0, 0.3})).norm(), 1e-15) << sign;
  }
}

TEST(InterpolatePose, AgreesWithEigensSlerp) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond a = ExpQuaternion(RandomVector(&random));
    const Eigen::Quaterniond b = ExpQuaternion(RandomVector(&random));
    const auto pose = InterpolatePose({{0, {a, {0, 0, 0}}}, {1000, {b, {0, 0, 0}}}}, 300, 1.0);
    ASSERT_TRUE(pose);
    EXPECT_LT(BoxMinus(pose->R, a.slerp(0.3, b)).norm(), 1e-14);
  }
}

TEST(InterpolatePose, HitsNeedNoNeighbour) {
  const std::vector<StampedPose> poses = TwoPoses();
  for (const StampedPose& pose : poses) {
    const auto hit = InterpolatePose(poses, pose.timestamp, 0.0);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->p, pose.T_GB.p);
    EXPECT_EQ(hit->R.coeffs(), pose.T_GB.R.coeffs());
  }
}

TEST(InterpolatePose, RefusesOutsideAndLongGaps) {
  const std::vector<StampedPose> poses = TwoPoses();
  const Timestamp middle = poses[0].timestamp + 10000000;
  EXPECT_FALSE(InterpolatePose(poses, poses[0].timestamp - 1, 1.0));
  EXPECT_FALSE(InterpolatePose(poses, poses[1].timestamp + 1, 1.0));
  EXPECT_TRUE(InterpolatePose(poses, middle, 0.02)) << "a gap of just the bound";
  EXPECT_FALSE(InterpolatePose(poses, middle, 0.0199));
  EXPECT_FALSE(InterpolatePose({}, 0, 1.0));
}

TEST(MakeQuaternionSignsContinuous, ChangesSignsOnly) {
  Random random(2);
  std::vector<StampedPose> poses(1000);
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  for (StampedPose& pose : poses) {
    R = BoxPlus(R, 0.3 * RandomVector(&random));
    pose.T_GB.R = R;
    if (random.UniformInt(2) == 0) pose.T_GB.R.coeffs() *= -1.0;
  }
  const std::vector<StampedPose> before = poses;
  MakeQuaternionSignsContinuous(&poses);
  EXPECT_EQ(poses[0].T_GB.R.coeffs(), before[0].T_GB.R.coeffs());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    EXPECT_GE(poses[i].T_GB.R.dot(poses[i - 1].T_GB.R), 0.0);
    EXPECT_EQ(poses[i].T_GB.R.coeffs().cwiseAbs(), before[i].T_GB.R.coeffs().cwiseAbs());
    EXPECT_NEAR(std::abs(poses[i].T_GB.R.dot(before[i].T_GB.R)), 1.0, 1e-14);
  }
  std::vector<StampedPose> none;
  MakeQuaternionSignsContinuous(&none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace duet
