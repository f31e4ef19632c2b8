#include "experiments/simulation/world/illumination.h"

#include <gtest/gtest.h>

namespace duet {
namespace {

using Eigen::Vector3d;

double At(const Illumination& light, const Vector3d& p, const Vector3d& normal) {
  return light.Map({p, Vector3d::UnitX(), Vector3d::UnitY(), 1, 1}, normal).front();
}

TEST(Illumination, IsTheAmbientLightInTheOpen) {
  Illumination light;
  light.SetAmbient(0.8, 0.4);
  EXPECT_NEAR(At(light, {0, 0, 0}, Vector3d::UnitZ()), 0.8, 1e-6);
  EXPECT_NEAR(At(light, {0, 0, 0}, -Vector3d::UnitZ()), 0.4, 1e-6);
  EXPECT_NEAR(At(light, {0, 0, 0}, Vector3d::UnitX()), 0.6, 1e-6);
}

TEST(Illumination, CornersAndTheFootOfBoxesAreDarker) {
  Illumination light;
  light.SetInside({-2, -2, 0}, {2, 2, 3});
  light.SetOcclusionReach(0.5);
  light.AddBlocker({}, {0.5, -0.5, 0.0}, {1.5, 0.5, 1.0});
  const double open = At(light, {-0.5, 0, 0}, Vector3d::UnitZ());
  EXPECT_NEAR(open, At(light, {-0.8, 0.4, 0}, Vector3d::UnitZ()), 1e-6);
  EXPECT_LT(At(light, {-1.95, 0, 0}, Vector3d::UnitZ()), 0.75 * open);
  EXPECT_LT(At(light, {-1.95, -1.95, 0}, Vector3d::UnitZ()),
            At(light, {-1.95, 0, 0}, Vector3d::UnitZ()) + 1e-9);
  double last = open;
  for (const double x : {0.1, 0.2, 0.3, 0.4, 0.48}) {  // towards the box
    const double here = At(light, {x, 0, 0}, Vector3d::UnitZ());
    EXPECT_LT(here, last);
    last = here;
  }
}

TEST(Illumination, LampsThrowSoftShadows) {
  Illumination light;
  light.SetAmbient(0.0, 0.0);
  light.AddLamp({0, 0, 3}, 0.3, 1.0, 3.0);
  const double below = At(light, {0, 0, 0}, Vector3d::UnitZ());
  EXPECT_NEAR(below, 0.5, 0.01);  // half the power at the lamp's range
  EXPECT_NEAR(At(light, {0, 0, 0}, -Vector3d::UnitZ()), 0.0, 1e-9);  // turned away
  light.AddBlocker({}, {-0.2, -0.2, 1.0}, {0.2, 0.2, 1.2});
  EXPECT_NEAR(At(light, {0, 0, 0}, Vector3d::UnitZ()), 0.0, 1e-9);
  const double edge = At(light, {0.3, 0, 0}, Vector3d::UnitZ());
  EXPECT_GT(edge, 0.02);
  EXPECT_LT(edge, 0.48);
  EXPECT_GT(At(light, {1.0, 0, 0}, Vector3d::UnitZ()), 0.4);
}

TEST(Illumination, TheSunIsParallel) {
  Illumination light;
  light.SetAmbient(0.0, 0.0);
  light.SetSun({1, 0, 1}, 1.0);
  light.AddBlocker({}, {10.0, -5.0, 0.0}, {11.0, 5.0, 10.0});
  // Its shadow begins at its foot and is 10 m long.
  EXPECT_NEAR(At(light, {9.0, 0, 0}, Vector3d::UnitZ()), 0.0, 1e-9);
  EXPECT_NEAR(At(light, {1.0, 0, 0}, Vector3d::UnitZ()), 0.0, 1e-9);
  EXPECT_NEAR(At(light, {-1.0, 0, 0}, Vector3d::UnitZ()), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(At(light, {12.0, 0, 0}, Vector3d::UnitZ()), std::sqrt(0.5), 1e-6);
}

TEST(Illumination, AMapIsTheSameAsItsPlacesOneByOne) {
  // Places share lists of neighbours: none may be missing.
  Illumination light;
  light.SetInside({-4, -4, 0}, {4, 4, 3});
  for (int k = 0; k < 12; ++k) {
    const double x = -3.0 + 0.5 * k;
    const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * k, Vector3d::UnitZ())),
                    Vector3d(x, 0.3 * (k % 5) - 0.6, 0.2 * (k % 3))};
    light.AddBlocker(pose, Vector3d::Constant(-0.3), Vector3d::Constant(0.3));
  }
  light.AddLamp({-2, 1, 2.8}, 0.3, 0.6, 2.0);
  light.AddLamp({2, -1, 2.8}, 0.3, 0.6, 2.0);
  light.SetSun({0.3, 0.2, 0.8}, 0.4);
  const Illumination::Grid grid{{-3.9, -3.9, 0.0}, {0.2, 0, 0}, {0, 0.2, 0}, 39, 39};
  const std::vector<float> map = light.Map(grid, Vector3d::UnitZ());
  for (int i = 0; i < 39; ++i) {
    for (int j = 0; j < 39; ++j) {
      const Vector3d p = grid.origin + j * grid.x_step + i * grid.y_step;
      EXPECT_FLOAT_EQ(map[static_cast<std::size_t>(i) * 39 + j],
                      static_cast<float>(At(light, p, Vector3d::UnitZ())));
    }
  }
}

}  // namespace
}  // namespace duet
