// Worlds against brute force: every surface asked one by one.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "common/support/random.h"
#include "experiments/simulation/world/world.h"
#include "test/experiments/simulation/render/small_world.h"

namespace duet {
namespace {

using Eigen::Vector3d;

Vector3d RandomDirection(Random* random) { return random->NormalVector<3>().normalized(); }

// 300 rectangles of many sizes, a third on moving bodies, and some boxes.
World RandomWorld(Random* random) {
  World world("random");
  for (int body = 0; body < 3; ++body) {
    const Vector3d axis = RandomDirection(random);
    const Vector3d at = random->NormalVector<3>();
    world.AddBody([axis, at](double t_s) {
      return Pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * t_s, axis)),
                  at + std::sin(t_s) * axis};
    });
  }
  for (int i = 0; i < 300; ++i) {
    Surface surface;
    const Vector3d u = RandomDirection(random);
    surface.u_axis = u;
    surface.v_axis = u.cross(RandomDirection(random)).normalized();
    surface.corner = 4.0 * random->NormalVector<3>();
    surface.width_m = random->Uniform(0.05, 2.0);
    surface.height_m = random->Uniform(0.05, 2.0);
    surface.two_sided = random->Uniform() < 0.3;
    surface.body = i % 3 == 0 ? 1 + random->UniformInt(3) : 0;
    // Axis-parallel ones too: their boxes are flat.
    if (i % 5 == 0) {
      surface.u_axis = Vector3d::UnitX();
      surface.v_axis = i % 2 == 0 ? Vector3d::UnitY() : Vector3d::UnitZ();
    }
    world.AddSurface(surface);
  }
  return world;
}

std::optional<WorldHit> CastBruteForce(const World& world, const Vector3d& origin,
                                       const Vector3d& direction, double t_s) {
  std::optional<WorldHit> nearest;
  for (std::size_t i = 0; i < world.surfaces().size(); ++i) {
    const Surface& s = world.surfaces()[i];
    const Pose T = world.BodyPose(s.body, t_s);
    Eigen::Matrix3d A;  // origin + distance direction = corner + u u_axis + v v_axis
    A << T.R * s.u_axis, T.R * s.v_axis, -direction;
    const bool front = A.col(0).cross(A.col(1)).dot(direction) < 0.0;
    if (!front && !s.two_sided) continue;
    const Vector3d x = A.fullPivLu().solve(origin - T * s.corner);
    if (x[0] < 0 || x[0] > s.width_m || x[1] < 0 || x[1] > s.height_m || !(x[2] > 0)) continue;
    if (nearest && nearest->distance_m <= x[2]) continue;
    nearest = WorldHit{x[2], static_cast<int>(i), {x[0], x[1]}};
  }
  return nearest;
}

TEST(World, CastFindsWhatBruteForceFinds) {
  Random random(1);
  const World world = RandomWorld(&random);
  int hits = 0;
  for (int i = 0; i < 1500; ++i) {
    const Vector3d origin = 3.0 * random.NormalVector<3>();
    Vector3d direction = RandomDirection(&random);
    if (i % 10 == 0) direction = Vector3d::Unit(i / 10 % 3);  // zero components
    const double t_s = random.Uniform(0.0, 10.0);
    const auto expected = CastBruteForce(world, origin, direction, t_s);
    const auto hit = world.Cast(origin, direction, t_s);
    ASSERT_EQ(hit.has_value(), expected.has_value());
    if (!hit) continue;
    ++hits;
    EXPECT_EQ(hit->surface, expected->surface);
    EXPECT_NEAR(hit->distance_m, expected->distance_m, 1e-9);
    EXPECT_LT((hit->uv_m - expected->uv_m).norm(), 1e-8);
    const Vector3d point = origin + hit->distance_m * direction;
    EXPECT_LT((world.PointInGlobal(hit->surface, hit->uv_m, t_s) - point).norm(), 1e-8);
  }
  EXPECT_GT(hits, 250);
}

// From within a closed room no ray gets out, nor through its edges and corners.
TEST(World, ClosedRoomHasNoGaps) {
  const auto room = NoisyRoom(false, 0.1);
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    EXPECT_TRUE(room->Cast({0.1, 0.2, 1.3}, RandomDirection(&random), 0.0).has_value());
  }
  for (const double x : {-3.0, 3.0}) {
    for (const double y : {-3.0, 3.0}) {
      EXPECT_TRUE(room->Cast({0, 0, 1.5}, Vector3d(x, y, 1.5).normalized(), 0.0).has_value());
    }
  }
}

TEST(World, BoxIsSeenFromAllSidesAndFromOutsideAlone) {
  World world("box");
  const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized())),
                  {1, 2, 3}};
  world.AddBox(pose, {-1, -2, -3}, {1, 2, 3}, Surface{});
  ASSERT_EQ(world.surfaces().size(), 6U);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vector3d out = pose.R * (side * Vector3d::Unit(axis));
      const auto hit = world.Cast(pose.p + 10.0 * out, -out, 0.0);
      ASSERT_TRUE(hit.has_value());
      EXPECT_NEAR(hit->distance_m, 10.0 - (axis + 1.0), 1e-9);
      EXPECT_FALSE(world.Cast(pose.p, out, 0.0).has_value()) << "seen from within";
    }
  }
}

TEST(World, FreeSpaceKeepsItsDistanceFromSolidsAndBounds) {
  World world("free");
  world.SetBounds({-5, -5, 0}, {5, 5, 3});
  const int body = world.AddBody([](double t_s) {
    return Pose{Eigen::Quaterniond::Identity(), {0.0, t_s, 0.0}};
  });
  Surface side;
  side.body = body;
  world.AddBox(Pose{}, {-1, -1, 0}, {1, 1, 2}, side);
  EXPECT_FALSE(world.IsFree({0, 0, 1}, 0.0, 0.0)) << "within the box";
  EXPECT_FALSE(world.IsFree({0, 0, 1}, 0.0, 1.5) && world.IsFree({0, 2, 1}, 0.0, 1.5));
  EXPECT_TRUE(world.IsFree({0, 0, 1}, 0.4, 1.5)) << "the box has gone on";
  EXPECT_FALSE(world.IsFree({0, 0, 1}, 0.6, 1.5));
  EXPECT_TRUE(world.IsFree({1.5, 0, 1}, 0.49, 0.0));
  EXPECT_FALSE(world.IsFree({1.5, 0, 1}, 0.51, 0.0));
  // Off an edge the distance is the diagonal.
  EXPECT_TRUE(world.IsFree({1.3, 1.4, 1}, 0.49, 0.0));
  EXPECT_FALSE(world.IsFree({1.3, 1.4, 1}, 0.51, 0.0));
  EXPECT_FALSE(world.IsFree({5.1, 0, 1}, 0.0, 0.0));
}

}  // namespace
}  // namespace duet
