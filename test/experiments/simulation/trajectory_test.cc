#include "experiments/simulation/trajectory.h"

#include <gtest/gtest.h>

#include "common/support/input_error.h"

namespace duet {
namespace {

using Eigen::Vector3d;

// Central differences with h = 1e-4 s: the truncation is h^2 / 6 times a third derivative (below 50
// here), 1e-7; the rounding eps / h^2 of the second difference 1e-7 as well.
constexpr double kStep_s = 1e-4;
constexpr double kTolerance = 2e-6;

class TrajectoryByName : public testing::TestWithParam<std::string> {};

TEST_P(TrajectoryByName, DerivativesAreThoseOfThePose) {
  const auto trajectory = MakeTrajectory(GetParam(), 40.0, 1.5);
  for (double t = 0.05; t < 39.0; t += 0.173) {
    const Kinematics before = trajectory->At(t - kStep_s);
    const Kinematics now = trajectory->At(t);
    const Kinematics after = trajectory->At(t + kStep_s);
    const Vector3d v = (after.T_GB.p - before.T_GB.p) / (2 * kStep_s);
    const Vector3d a = (after.v_GB - before.v_GB) / (2 * kStep_s);
    const Vector3d omega = Log(before.T_GB.R.conjugate() * after.T_GB.R) / (2 * kStep_s);
    EXPECT_LT((v - now.v_GB).norm(), kTolerance) << "at " << t;
    EXPECT_LT((a - now.a_G).norm(), kTolerance) << "at " << t;
    EXPECT_LT((omega - now.omega_B).norm(), kTolerance) << "at " << t;
  }
}

TEST_P(TrajectoryByName, StaysInTheRoomAndUpright) {
  const auto trajectory = MakeTrajectory(GetParam(), 300.0, 0.0);
  for (double t = 0.0; t <= 300.0; t += 0.1) {
    const Kinematics k = trajectory->At(t);
    EXPECT_LT(k.T_GB.p.head<2>().cwiseAbs().maxCoeff(), 3.0);
    EXPECT_GT(k.T_GB.p.z(), 0.8);
    EXPECT_LT(k.T_GB.p.z(), 2.2);
    // The body's x axis points up, as EuRoC's does.
    EXPECT_GT((k.T_GB.R * Vector3d::UnitX()).z(), 0.5);
  }
}

TEST_P(TrajectoryByName, IsAtRestWhereItSaysSo) {
  const auto trajectory = MakeTrajectory(GetParam(), 30.0, 2.0);
  const Kinematics start = trajectory->At(0.0);
  for (double t = 0.0; t < 2.0; t += 0.1) {
    const Kinematics k = trajectory->At(t);
    EXPECT_EQ(k.T_GB.p, start.T_GB.p);
    EXPECT_EQ(k.v_GB, Vector3d::Zero());
    EXPECT_EQ(k.a_G, Vector3d::Zero());
    EXPECT_EQ(k.omega_B, Vector3d::Zero());
  }
  EXPECT_GT(trajectory->At(3.5).v_GB.norm() + trajectory->At(3.5).omega_B.norm(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(All, TrajectoryByName, testing::ValuesIn(TrajectoryNames()));

TEST(Trajectory, HoverStandsStillOnTheWay) {
  const auto trajectory = MakeTrajectory("hover", 40.0, 0.0);
  for (double t : {8.0, 11.0, 13.9, 28.1, 33.9}) {
    EXPECT_EQ(trajectory->At(t).v_GB, Vector3d::Zero());
    EXPECT_EQ(trajectory->At(t).omega_B, Vector3d::Zero());
  }
  EXPECT_GT(trajectory->At(6.0).v_GB.norm(), 0.1);
  EXPECT_GT(trajectory->At(16.0).v_GB.norm(), 0.1);
}

TEST(Trajectory, RoomWalkMovesAsEurocsEasyFlights) {
  const auto trajectory = MakeTrajectory("room_walk", 100.0, 0.0);
  double speed = 0.0;
  double rate = 0.0;
  double acceleration_squared = 0.0;
  int count = 0;
  for (double t = 0.0; t < 100.0; t += 0.05, ++count) {
    speed += trajectory->At(t).v_GB.norm();
    rate += trajectory->At(t).omega_B.norm();
    acceleration_squared += trajectory->At(t).a_G.squaredNorm();
  }
  // Table 7.1: 0.33 to 0.5 m/s and 0.2 to 0.3 rad/s for the easy ones; the truth of V2_01_easy has
  // a root mean square acceleration of 0.74 m/s^2.
  EXPECT_NEAR(speed / count, 0.45, 0.15);
  EXPECT_NEAR(rate / count, 0.35, 0.15);
  EXPECT_NEAR(std::sqrt(acceleration_squared / count), 0.65, 0.1);
}

TEST(Trajectory, UnknownNameIsBadInput) {
  EXPECT_THROW(static_cast<void>(MakeTrajectory("moon", 1.0, 0.0)), InputError);
}

}  // namespace
}  // namespace duet
