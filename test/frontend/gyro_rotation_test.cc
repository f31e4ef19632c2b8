#include "frontend/gyro_rotation.h"

#include <gtest/gtest.h>

#include "common/geometry/so3.h"

namespace duet {
namespace {

constexpr Timestamp kMs = 1'000'000;

GyroRotation Filled(const Eigen::Vector3d& omega, Timestamp from, Timestamp to) {
  GyroRotation gyro{ImuCalibration{}};
  for (Timestamp t = from; t <= to; t += 5 * kMs) {
    gyro.Add({t, omega, Eigen::Vector3d(0, 0, 9.81)});
  }
  return gyro;
}

TEST(GyroRotationTest, TurnsAgainstTheBody) {
  const Eigen::Vector3d omega(0.3, -1.0, 2.0);
  GyroRotation gyro = Filled(omega, 0, 200 * kMs);
  // A vector at rest in G turns the other way in B.
  const auto R_B1B0 = gyro.Between(12 * kMs, 62 * kMs);
  ASSERT_TRUE(R_B1B0);
  EXPECT_LT(BoxMinus(*R_B1B0, ExpQuaternion(-0.05 * omega)).norm(), 1e-12);
}

TEST(GyroRotationTest, GoesOnWithTheLastRateWhereSamplesEnd) {
  const Eigen::Vector3d omega(0.0, 0.5, 0.1);
  GyroRotation gyro = Filled(omega, 10 * kMs, 50 * kMs);
  EXPECT_LT(BoxMinus(*gyro.Between(0, 60 * kMs), ExpQuaternion(-0.06 * omega)).norm(), 1e-12);
  GyroRotation before = Filled(omega, 100 * kMs, 150 * kMs);
  EXPECT_LT(BoxMinus(*before.Between(0, 50 * kMs), ExpQuaternion(-0.05 * omega)).norm(), 1e-12);
}

TEST(GyroRotationTest, KnowsNothingWithoutASample) {
  GyroRotation gyro{ImuCalibration{}};
  EXPECT_FALSE(gyro.Between(0, 50 * kMs));
}

TEST(GyroRotationTest, LearnsItsBiasInSpiteOfWildIntervals) {
  const Eigen::Vector3d bias(0.02, -0.05, 0.08);
  const Eigen::Vector3d omega(0.2, 0.4, -0.3);
  GyroRotation gyro = Filled(omega + bias, 0, 6000 * kMs);
  for (int frame = 0; frame < 100; ++frame) {
    const Timestamp t0 = frame * 50 * kMs;
    const Eigen::Quaterniond R_B1B0 = *gyro.Between(t0, t0 + 50 * kMs);
    Eigen::Vector3d delta = BoxMinus(ExpQuaternion(-0.05 * omega), R_B1B0);
    if (frame % 10 == 9) delta += Eigen::Vector3d(0.05, 0.05, -0.05);  // 23 px
    gyro.LearnBias(delta, 0.05);
  }
  // A tenth of the intervals pull by at most 0.05 rad/s each.
  EXPECT_LT((gyro.b_g() - bias).norm(), 0.006);
}

}  // namespace
}  // namespace duet
