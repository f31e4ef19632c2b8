#include "experiments/simulation/trajectory.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/support/input_error.h"
#include "experiments/simulation/euroc_sequences.h"
#include "experiments/simulation/trajectory_library.h"
#include "experiments/simulation/world/world_library.h"

namespace duet {
namespace {

using Eigen::Vector3d;

// Central differences with h = 1e-4 s: the truncation is h^2 / 6 times a third derivative (below 50
// here), 1e-7; the rounding eps / h^2 of the second difference 1e-7 as well.
constexpr double kStep_s = 1e-4;
constexpr double kTolerance = 2e-6;

// As long as asked for, but within the motion's own space.
std::shared_ptr<const Trajectory> Make(const std::string& name, double duration_s, double rest_s) {
  const double longest_s = FindMotion(name).longest_s;
  if (longest_s > 0.0) duration_s = std::min(duration_s, longest_s + rest_s);
  return MakeTrajectory(name, duration_s, rest_s);
}

class TrajectoryByName : public testing::TestWithParam<std::string> {};

TEST_P(TrajectoryByName, DerivativesAreThoseOfThePose) {
  const auto trajectory = Make(GetParam(), 40.0, 1.5);
  for (double t = 0.05; t < trajectory->duration_s() - 0.1; t += 0.173) {
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

TEST_P(TrajectoryByName, StaysInItsFlightSpaceAndUpright) {
  const FlightSpace space = FlightSpaceOf(FindMotion(GetParam()).world);
  const auto trajectory = Make(GetParam(), 300.0, 0.0);
  for (double t = 0.0; t <= trajectory->duration_s(); t += 0.1) {
    const Kinematics k = trajectory->At(t);
    ASSERT_TRUE((k.T_GB.p.array() >= space.low.array()).all()) << k.T_GB.p.transpose();
    ASSERT_TRUE((k.T_GB.p.array() <= space.high.array()).all()) << k.T_GB.p.transpose();
    // The body's x axis points up, as EuRoC's does.
    ASSERT_GT((k.T_GB.R * Vector3d::UnitX()).z(), 0.5);
  }
}

TEST_P(TrajectoryByName, IsAtRestWhereItSaysSo) {
  const auto trajectory = Make(GetParam(), 30.0, 2.0);
  const Kinematics start = trajectory->At(0.0);
  for (double t = 0.0; t < 2.0; t += 0.1) {
    const Kinematics k = trajectory->At(t);
    EXPECT_EQ(k.T_GB.p, start.T_GB.p);
    EXPECT_EQ(k.v_GB, Vector3d::Zero());
    EXPECT_EQ(k.a_G, Vector3d::Zero());
    EXPECT_EQ(k.omega_B, Vector3d::Zero());
  }
  if (GetParam() == "standstill") return;
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

// What the degenerate motions are made for, exactly.
TEST(Trajectory, PrimitivesKeepConstantWhatTheyAreNamedFor) {
  const Vector3d g_G(0, 0, -9.81);
  const auto specific_force = [&](const Kinematics& k) -> Vector3d {
    return k.T_GB.R.conjugate() * (k.a_G - g_G);
  };
  for (double t = 0.0; t < 30.0; t += 0.37) {
    EXPECT_EQ(MakeTrajectory("straight_line", 30.0, 0.0)->At(t).v_GB, Vector3d(1, 0, 0));
    EXPECT_EQ(MakeTrajectory("straight_line", 30.0, 0.0)->At(t).omega_B, Vector3d::Zero());
    EXPECT_EQ(MakeTrajectory("pure_rotation", 30.0, 0.0)->At(t).v_GB, Vector3d::Zero());
    EXPECT_EQ(MakeTrajectory("standstill", 30.0, 0.0)->At(t).omega_B, Vector3d::Zero());
    // About the body's x axis.
    const Kinematics constant = MakeTrajectory("constant_rate", 30.0, 0.0)->At(t);
    EXPECT_LT((constant.omega_B - Vector3d(0.4, 0, 0)).norm(), 1e-15);
    const Kinematics one_axis = MakeTrajectory("one_axis_rotation", 30.0, 0.0)->At(t);
    EXPECT_EQ(one_axis.omega_B.tail<2>(), Eigen::Vector2d::Zero());
    const Kinematics pushed = MakeTrajectory("constant_acceleration", 30.0, 0.0)->At(t);
    EXPECT_NEAR(specific_force(pushed).z(), 0.2, 1e-14);
    EXPECT_LT(pushed.omega_B.head<2>().norm(), 1e-15);
  }
  EXPECT_THROW(static_cast<void>(MakeTrajectory("straight_line", 140.0, 0.0)), InputError);
}

TEST(Trajectory, DrivingIsLevelAndAlongThePath) {
  const auto trajectory = MakeTrajectory("planar_driving", 60.0, 0.0);
  double fastest = 0.0;
  for (double t = 0.0; t <= 60.0; t += 0.1) {
    const Kinematics k = trajectory->At(t);
    fastest = std::max(fastest, k.v_GB.norm());
    EXPECT_EQ(k.v_GB.z(), 0.0);
    // The camera looks along the body's z axis: no slip to the side, nor up.
    const Vector3d v_B = k.T_GB.R.conjugate() * k.v_GB;
    EXPECT_LT(v_B.head<2>().norm(), 1e-12);
    EXPECT_LT(k.omega_B.tail<2>().norm(), 1e-15);
  }
  EXPECT_GT(fastest, 4.5);
  EXPECT_EQ(trajectory->At(19.0).v_GB, Vector3d::Zero()) << "the light";
  EXPECT_EQ(trajectory->At(50.0).v_GB, Vector3d::Zero()) << "the end of the street";
}

TEST(Trajectory, AggressiveFlightIsFast) {
  const auto trajectory = MakeTrajectory("aggressive", 60.0, 0.0);
  double speed = 0.0;
  double rate = 0.0;
  for (double t = 0.0; t <= 60.0; t += 0.02) {
    speed = std::max(speed, trajectory->At(t).v_GB.norm());
    rate = std::max(rate, trajectory->At(t).omega_B.norm());
  }
  EXPECT_NEAR(speed, 3.2, 0.4);
  EXPECT_NEAR(rate, 3.2, 0.4);
}

TEST(Trajectory, FlightsLikeEurocHaveTheThesissRows) {
  std::printf("%s", EurocSequencesText().c_str());
  for (const EurocSequence& sequence : EurocSequences()) {
    const double duration_s = sequence.thesis.duration_s;
    const auto trajectory = MakeTrajectory(sequence.name, duration_s, kEurocRest_s);
    const SequenceRow row = MeasureMotion(*trajectory, duration_s);
    // The table's two digits of the speed leave 1.2 % between its own length and speed.
    EXPECT_NEAR(row.length_m / sequence.thesis.length_m, 1.0, 0.005) << sequence.name;
    EXPECT_NEAR(row.average_speed_m_per_s / sequence.thesis.average_speed_m_per_s, 1.0, 0.02);
    EXPECT_NEAR(row.average_rate_rad_per_s / sequence.thesis.average_rate_rad_per_s, 1.0, 0.02);
  }
}

// A shorter simulation is the beginning of the longer one.
TEST(Trajectory, DurationCutsTheMotionOff) {
  for (const std::string& name : TrajectoryNames()) {
    const Kinematics a = MakeTrajectory(name, 10.0, 1.0)->At(7.3);
    const Kinematics b = MakeTrajectory(name, 30.0, 1.0)->At(7.3);
    EXPECT_EQ(a.T_GB.p, b.T_GB.p) << name;
    EXPECT_EQ(a.omega_B, b.omega_B) << name;
  }
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

TEST(Trajectory, ListNamesEveryMotionWithItsWorld) {
  const std::string text = NamedMotionsText();
  EXPECT_NE(text.find("\nplanar_driving         street  a car"), std::string::npos) << text;
  EXPECT_NE(text.find("1 m/s straight ahead; at most 130 s\n"), std::string::npos) << text;
  EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')),
            NamedMotions().size());
}

TEST(Trajectory, UnknownNameIsBadInput) {
  EXPECT_THROW(static_cast<void>(MakeTrajectory("moon", 1.0, 0.0)), InputError);
}

}  // namespace
}  // namespace duet
