#include "experiments/simulation/world/world_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "common/support/input_error.h"
#include "common/support/random.h"

namespace duet {
namespace {

using Eigen::Vector3d;

WorldOptions Geometry(bool moving) {
  WorldOptions options;
  options.textures = false;
  options.moving_bodies = moving;
  return options;
}

Vector3d Within(Random& random, const FlightSpace& space) {
  return {random.Uniform(space.low.x(), space.high.x()),
          random.Uniform(space.low.y(), space.high.y()),
          random.Uniform(space.low.z(), space.high.z())};
}

class WorldLibrary : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, WorldLibrary, ::testing::ValuesIn(WorldNames()),
                         [](const auto& parameter) { return parameter.param; });

TEST_P(WorldLibrary, IsMadeByItsName) {
  const auto world = MakeWorld(GetParam(), Geometry(false));
  EXPECT_EQ(world->name(), GetParam());
  EXPECT_EQ(world->body_count(), 1);
  EXPECT_GT(world->surfaces().size(), 30u);
  EXPECT_GT(MakeWorld(GetParam(), Geometry(true))->body_count(), 1);
  for (const Surface& s : world->surfaces()) {
    ASSERT_GE(s.texture, 0);
    ASSERT_LT(s.texture, static_cast<int>(world->textures().size()));
    ASSERT_GE(s.corner_density, 0.0);
    ASSERT_LE(s.corner_density, 1.0);
    ASSERT_NEAR(s.u_axis.norm(), 1.0, 1e-9);
    ASSERT_NEAR(s.v_axis.norm(), 1.0, 1e-9);
    ASSERT_NEAR(s.u_axis.dot(s.v_axis), 0.0, 1e-9);
  }
}

TEST_P(WorldLibrary, FlightSpaceIsFreeAtAnyTime) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    WorldOptions options = Geometry(true);
    options.seed = seed;
    const auto world = MakeWorld(GetParam(), options);
    const FlightSpace space = FlightSpaceOf(GetParam());
    Random random(seed);
    for (int k = 0; k < 250; ++k) {
      Vector3d p = Within(random, space);
      // Two of three points on the border, where things are nearest.
      const int axis = random.Index(3);
      if (k % 3 == 1) p[axis] = space.low[axis];
      if (k % 3 == 2) p[axis] = space.high[axis];
      const double t = random.Uniform(-10.0, 200.0);
      ASSERT_TRUE(world->IsFree(p, kFlightMargin_m, t)) << p.transpose() << " at " << t;
    }
  }
}

// Random points might miss a thin post: its solid must not reach into the space at all. Every
// surface is that of a solid or of the inside, so that it is enough to look at points of surfaces.
TEST_P(WorldLibrary, NoSurfaceReachesIntoTheFlightSpace) {
  const auto world = MakeWorld(GetParam(), Geometry(true));
  const FlightSpace space = FlightSpaceOf(GetParam());
  for (int s = 0; s < static_cast<int>(world->surfaces().size()); ++s) {
    const Surface& surface = world->surfaces()[s];
    const bool moves = surface.body != 0;
    const int across = static_cast<int>(std::min(40.0, std::ceil(surface.width_m / 0.2)));
    const int up = static_cast<int>(std::min(40.0, std::ceil(surface.height_m / 0.2)));
    for (double t = 0.0; t < (moves ? 60.0 : 0.5); t += moves ? 1.7 : 1.0) {
      for (int i = 0; i <= up; i += moves ? up : 1) {
        for (int j = 0; j <= across; j += moves ? across : 1) {
          const Vector3d p =
              world->PointInGlobal(s, {surface.width_m * j / across, surface.height_m * i / up}, t);
          const Vector3d beyond = (space.low - p).cwiseMax(p - space.high);
          ASSERT_GT(beyond.maxCoeff(), kFlightMargin_m / std::sqrt(3.0))
              << s << " at " << p.transpose();
        }
      }
    }
  }
}

TEST_P(WorldLibrary, EveryRayEndsSomewhere) {
  const auto world = MakeWorld(GetParam(), Geometry(true));
  const FlightSpace space = FlightSpaceOf(GetParam());
  Random random(5);
  for (int k = 0; k < 3000; ++k) {
    const Vector3d p = Within(random, space);
    const Vector3d direction = random.NormalVector<3>().normalized();
    const auto hit = world->Cast(p, direction, random.Uniform(0.0, 60.0));
    ASSERT_TRUE(hit.has_value()) << p.transpose() << " towards " << direction.transpose();
    ASSERT_GT(hit->distance_m, kFlightMargin_m);
  }
}

// Two faces in one place that look the same way would flicker against each other.
TEST_P(WorldLibrary, NoTwoVisibleFacesShareAPlace) {
  const auto world = MakeWorld(GetParam(), Geometry(false));
  const FlightSpace space = FlightSpaceOf(GetParam());
  struct Plane {
    Vector3d normal;
    double offset;
    int surface;
  };
  std::vector<Plane> planes;
  for (int s = 0; s < static_cast<int>(world->surfaces().size()); ++s) {
    const Surface& surface = world->surfaces()[s];
    const Vector3d normal = surface.u_axis.cross(surface.v_axis);
    planes.push_back({normal, normal.dot(surface.corner), s});
  }
  const auto holds = [&](int s, const Vector3d& p) {
    const Surface& surface = world->surfaces()[s];
    const double u = surface.u_axis.dot(p - surface.corner);
    const double v = surface.v_axis.dot(p - surface.corner);
    constexpr double kEdge_m = 2e-3;
    return u > kEdge_m && v > kEdge_m && u < surface.width_m - kEdge_m &&
           v < surface.height_m - kEdge_m;
  };
  Random random(6);
  for (const Plane& a : planes) {
    for (const Plane& b : planes) {
      if (b.surface == a.surface || std::abs(a.offset - b.offset) > 1e-3 ||
          a.normal.dot(b.normal) < 1.0 - 1e-6) {
        continue;
      }
      const Surface& surface = world->surfaces()[a.surface];
      for (int k = 0; k < 30; ++k) {
        const Vector3d p = world->PointInGlobal(
            a.surface,
            {random.Uniform(0.0, surface.width_m), random.Uniform(0.0, surface.height_m)}, 0.0);
        if (!holds(b.surface, p)) continue;
        const Vector3d eye = Within(random, space);
        const auto hit = world->Cast(eye, (p - eye).normalized(), 0.0);
        ASSERT_TRUE(hit->distance_m < (p - eye).norm() - 2e-3)
            << a.surface << " and " << b.surface << " at " << p.transpose();
      }
    }
  }
}

TEST_P(WorldLibrary, BodiesMoveSmoothly) {
  const auto world = MakeWorld(GetParam(), Geometry(true));
  constexpr double kStep_s = 0.001;
  for (double t = 0.0; t < 120.0; t += 0.37) {
    for (int body = 1; body < world->body_count(); ++body) {
      const Pose before = world->BodyPose(body, t);
      const Pose after = world->BodyPose(body, t + kStep_s);
      // Nothing is faster than 9 m/s, nor turns faster than a walker's 4 rad/s.
      ASSERT_LT((after.p - before.p).norm(), 9.0 * kStep_s) << body << ' ' << t;
      ASSERT_LT(before.R.angularDistance(after.R), 4.0 * kStep_s) << body << ' ' << t;
    }
  }
}

TEST_P(WorldLibrary, TexturesDoNotDependOnThreads) {
  WorldOptions options;
  options.texel_m = GetParam() == "street" ? 0.3 : 0.12;
  options.moving_bodies = true;
  const auto one = MakeWorld(GetParam(), options);
  options.threads = 2;
  const auto two = MakeWorld(GetParam(), options);
  options.textures = false;
  const auto none = MakeWorld(GetParam(), options);
  ASSERT_EQ(one->textures().size(), two->textures().size());
  for (std::size_t k = 0; k < one->textures().size(); ++k) {
    ASSERT_EQ(one->textures()[k].levels().front().texels,
              two->textures()[k].levels().front().texels);
  }
  // Geometry is the same with and without textures.
  ASSERT_EQ(one->surfaces().size(), none->surfaces().size());
  for (std::size_t k = 0; k < one->surfaces().size(); ++k) {
    ASSERT_EQ(one->surfaces()[k].corner, none->surfaces()[k].corner);
    ASSERT_EQ(one->surfaces()[k].texture, none->surfaces()[k].texture);
    const Texture& texture = one->textures()[one->surfaces()[k].texture];
    ASSERT_GE(texture.levels().front().width * texture.texel_m(),
              one->surfaces()[k].width_m - 1e-6);
    ASSERT_GE(texture.levels().front().height * texture.texel_m(),
              one->surfaces()[k].height_m - 1e-6);
  }
}

// What a small pinhole camera sees, without filtering.
struct Picture {
  static constexpr int kWidth = 188;
  static constexpr int kHeight = 120;
  std::vector<double> grey;
  std::vector<double> density;
};

Picture See(const World& world, const Vector3d& eye, double yaw) {
  constexpr double kFocal_px = 114.5;
  Picture picture;
  const Vector3d forward(std::cos(yaw), std::sin(yaw), 0.0);
  const Vector3d right(std::sin(yaw), -std::cos(yaw), 0.0);
  for (int y = 0; y < Picture::kHeight; ++y) {
    for (int x = 0; x < Picture::kWidth; ++x) {
      const Vector3d direction =
          (forward + (x - 93.5) / kFocal_px * right - (y - 59.5) / kFocal_px * Vector3d::UnitZ())
              .normalized();
      const auto hit = world.Cast(eye, direction, 0.0);
      const Surface& surface = world.surfaces()[hit->surface];
      const Texture& texture = world.textures()[surface.texture];
      // The level whose texel is about a pixel.
      const double pixel_m = hit->distance_m / kFocal_px;
      const int last = static_cast<int>(texture.levels().size()) - 1;
      const int level = std::clamp(
          static_cast<int>(std::lround(std::log2(pixel_m / texture.texel_m()))), 0, last);
      const Texture::Level& texels = texture.levels()[level];
      const double scale = 1.0 / (texture.texel_m() * std::ldexp(1.0, level));
      const int i = std::clamp(static_cast<int>(hit->uv_m.y() * scale), 0, texels.height - 1);
      const int j = std::clamp(static_cast<int>(hit->uv_m.x() * scale), 0, texels.width - 1);
      picture.grey.push_back(texels.texels[static_cast<std::size_t>(i) * texels.width + j]);
      picture.density.push_back(surface.corner_density);
    }
  }
  return picture;
}

// Of 10 x 6 cells the share that have places where the grey changes both ways: the smaller
// eigenvalue of the gradients' moments over 5 x 5 pixels, as corner detectors ask for.
double CornerShare(const Picture& picture) {
  const auto grey = [&](int x, int y) {
    return picture.grey[static_cast<std::size_t>(y) * Picture::kWidth + x];
  };
  std::array<int, 60> corners{};
  for (int y = 3; y < Picture::kHeight - 3; y += 2) {
    for (int x = 3; x < Picture::kWidth - 3; x += 2) {
      double xx = 0.0;
      double xy = 0.0;
      double yy = 0.0;
      for (int i = -2; i <= 2; ++i) {
        for (int j = -2; j <= 2; ++j) {
          const double gx = 0.5 * (grey(x + j + 1, y + i) - grey(x + j - 1, y + i));
          const double gy = 0.5 * (grey(x + j, y + i + 1) - grey(x + j, y + i - 1));
          xx += gx * gx;
          xy += gx * gy;
          yy += gy * gy;
        }
      }
      const double smaller = 0.5 * (xx + yy - std::hypot(xx - yy, 2.0 * xy));
      // 10 grey levels a pixel in root mean square.
      if (smaller > 25 * 100.0)
        ++corners[(y * 6 / Picture::kHeight) * 10 + x * 10 / Picture::kWidth];
    }
  }
  return static_cast<double>(
             std::count_if(corners.begin(), corners.end(), [](int n) { return n >= 3; })) /
         60.0;
}

TEST(WorldTextures, GiveCornersAndContrast) {
  for (const std::string& name : WorldNames()) {
    WorldOptions options;
    options.texel_m = name == "street" ? 0.05 : 0.02;
    const auto world = MakeWorld(name, options);
    double share = 0.0;
    std::vector<double> greys;
    for (int k = 0; k < 4; ++k) {
      const Picture picture = See(*world, {0.0, 0.0, 1.5}, 0.5 * std::numbers::pi * k + 0.2);
      share += 0.25 * CornerShare(picture);
      greys.insert(greys.end(), picture.grey.begin(), picture.grey.end());
    }
    std::sort(greys.begin(), greys.end());
    const double low = greys[greys.size() / 20];
    const double high = greys[greys.size() - 1 - greys.size() / 20];
    RecordProperty(name + "_corner_percent", static_cast<int>(100.0 * share));
    if (name == "bare_room") {
      EXPECT_LT(share, 0.2) << name;
    } else {
      EXPECT_GT(share, 0.75) << name;
      EXPECT_LT(low, 60.0) << name;
      EXPECT_GT(high, 170.0) << name;
    }
    // Not much is burnt out or without any light.
    const auto at_end = [&](double from, double to) {
      return static_cast<double>(std::count_if(greys.begin(), greys.end(),
                                               [&](double g) { return g >= from && g <= to; })) /
             static_cast<double>(greys.size());
    };
    EXPECT_LT(at_end(254.5, 256.0), 0.04) << name;
    EXPECT_LT(at_end(0.0, 5.0), 0.04) << name;
  }
}

TEST(WorldTextures, DependOnTheSeed) {
  WorldOptions options;
  options.texel_m = 0.05;
  const auto first = MakeWorld("room", options);
  options.seed = 2;
  const auto second = MakeWorld("room", options);
  EXPECT_NE(first->textures()[0].levels().front().texels,
            second->textures()[0].levels().front().texels);
}

TEST(WorldLibraryNames, AnUnknownOneIsAnErrorThatNamesTheNearest) {
  EXPECT_THAT([] { (void)MakeWorld("hal", {}); },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("did you mean 'hall'?")));
  EXPECT_THAT([] { (void)FlightSpaceOf("streat"); },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("did you mean 'street'?")));
  EXPECT_THAT([] { (void)MakeWorld("moon", {}); },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("bare_room")));
}

}  // namespace
}  // namespace duet
