#include "common/camera/camera_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "common/support/random.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

CameraModel Camera(DistortionModel model, std::initializer_list<double> parameters) {
  CameraModel::Parameters p(static_cast<int>(parameters.size()));
  int i = 0;
  for (const double value : parameters) p[i++] = value;
  return CameraModel(model, 752, 480, p);
}

// EuRoC's cam0.
CameraModel Euroc() {
  return Camera(DistortionModel::kRadialTangential,
                {458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019359,
                 1.76187114e-05, 0.0});
}

// All coefficients at work.
CameraModel RadialTangentialCamera() {
  return Camera(DistortionModel::kRadialTangential,
                {458.654, 457.296, 367.215, 248.375, -0.28, 0.07, 1e-3, -2e-3, 0.02});
}

CameraModel EquidistantCamera() {
  return Camera(DistortionModel::kEquidistant,
                {190.98, 190.97, 254.93, 256.90, 0.0034, 0.0007, -0.0020, 0.0002});
}

std::vector<CameraModel> Cameras() {
  return {Euroc(), RadialTangentialCamera(), EquidistantCamera()};
}

// Points in front of the camera, on and ever closer to the axis too.
std::vector<Eigen::Vector3d> Points(double max_radius) {
  Random random(1);
  std::vector<Eigen::Vector3d> result = {{0.0, 0.0, 1.0}, {0.0, 0.0, 1e-3}, {0.0, 0.0, 1e6}};
  std::vector<double> radii = {1e-300, 1e-12, 1e-8, 1e-6, 1e-4, 0.01, 0.0999, 0.1001};
  for (int i = 0; i < 200; ++i) radii.push_back(max_radius * random.Uniform());
  for (const double radius : radii) {
    const double angle = 2.0 * std::numbers::pi * random.Uniform();
    const double z = 0.5 + 5.0 * random.Uniform();
    result.emplace_back(z * radius * std::cos(angle), z * radius * std::sin(angle), z);
  }
  return result;
}

TEST(CameraModel, ProjectsAHandComputedPoint) {
  Eigen::Vector2d uv;
  // x = 0.5, y = -1, r^2 = 1.25, r^4 = 1.5625, r^6 = 1.953125; radial 1 + 0.125 + 0.0625 +
  // 0.01953125 = 1.20703125 (k1 = 0.1, k2 = 0.04, k3 = 0.01); t1 = 0.01, t2 = 0.02.
  // x_d = 0.603515625 - 0.01 + 0.02 * 1.75 = 0.628515625
  // y_d = -1.20703125 + 0.01 * 3.25 - 0.02 = -1.19453125
  const CameraModel radial_tangential =
      Camera(DistortionModel::kRadialTangential, {100, 200, 10, 20, 0.1, 0.04, 0.01, 0.02, 0.01});
  ASSERT_TRUE(radial_tangential.Project({1.0, -2.0, 2.0}, &uv));
  EXPECT_NEAR(uv.x(), 72.8515625, 1e-12);
  EXPECT_NEAR(uv.y(), -218.90625, 1e-12);

  // 45 degrees to the right and down (3, 4, 5): theta = pi / 4.
  const CameraModel equidistant =
      Camera(DistortionModel::kEquidistant, {100, 200, 10, 20, 0.1, 0.0, 0.0, -0.1});
  ASSERT_TRUE(equidistant.Project({3.0, 4.0, 5.0}, &uv));
  const double theta = std::numbers::pi / 4.0;
  const double theta_d = theta + 0.1 * std::pow(theta, 3) - 0.1 * std::pow(theta, 9);
  EXPECT_NEAR(uv.x(), 100 * 0.6 * theta_d + 10, 1e-12);
  EXPECT_NEAR(uv.y(), 200 * 0.8 * theta_d + 20, 1e-12);
}

TEST(CameraModel, DependsOnTheDirectionOnly) {
  for (const CameraModel& camera : Cameras()) {
    for (const Eigen::Vector3d& p : Points(1.0)) {
      Eigen::Vector2d uv, uv_far;
      ASSERT_TRUE(camera.Project(p, &uv));
      ASSERT_TRUE(camera.Project(1024.0 * p, &uv_far));
      EXPECT_LT((uv - uv_far).norm(), 1e-11);  // roundings of numbers up to 1000 px
    }
  }
}

TEST(CameraModel, RefusesPointsNotInFront) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const CameraModel& camera : Cameras()) {
    for (const Eigen::Vector3d& p : std::vector<Eigen::Vector3d>{{0, 0, 0},
                                                                 {0, 0, -1},
                                                                 {1, 1, -1e-12},
                                                                 {nan, 0, 1},
                                                                 {0, nan, 1},
                                                                 {0, 0, nan},
                                                                 {infinity, 0, 1},
                                                                 {0, 0, infinity * 0}}) {
      Eigen::Vector2d uv(7.0, 8.0);
      CameraModel::Jacobian2x3 J = CameraModel::Jacobian2x3::Constant(9.0);
      EXPECT_FALSE(camera.Project(p, &uv, &J)) << p.transpose();
      EXPECT_EQ(uv, Eigen::Vector2d(7.0, 8.0)) << "nothing is written";
      EXPECT_EQ(J, CameraModel::Jacobian2x3::Constant(9.0));
    }
  }
}

TEST(CameraModel, JacobianToThePointIsTheDerivative) {
  for (const CameraModel& camera : Cameras()) {
    for (const Eigen::Vector3d& p : Points(1.2)) {
      Eigen::Vector2d uv;
      CameraModel::Jacobian2x3 J;
      ASSERT_TRUE(camera.Project(p, &uv, &J));
      const Eigen::Matrix<double, 2, 3> numeric = test::NumericJacobian(
          [&](const Eigen::Vector3d& x) {
            Eigen::Vector2d pixel;
            EXPECT_TRUE(camera.Project(x, &pixel));
            return pixel;
          },
          p, 1e-3 * p.z());
      // Pixels up to 1000: roundings of 1e-13 over a step of 1e-3 z.
      EXPECT_LT((J - numeric).norm() * p.z(), 2e-9) << p.transpose();
      // Moving along the ray moves nothing.
      EXPECT_LT((J * p).norm(), 1e-12);
    }
  }
}

TEST(CameraModel, JacobianToTheParametersIsTheDerivative) {
  for (const CameraModel& camera : Cameras()) {
    for (const Eigen::Vector3d& p : Points(1.2)) {
      Eigen::Vector2d uv;
      CameraModel::ParameterJacobian J;
      ASSERT_TRUE(camera.Project(p, &uv, nullptr, &J));
      // Pixels are linear in each single parameter: a wide step rounds least.
      const Eigen::Matrix<double, 2, 9> numeric = test::NumericJacobian(
          [&](const Vector9d& x) {
            CameraModel other = camera;
            other.set_parameters(x.head(camera.parameter_count()));
            Eigen::Vector2d pixel;
            EXPECT_TRUE(other.Project(p, &pixel));
            return pixel;
          },
          [&] {
            Vector9d x = Vector9d::Zero();
            x.head(camera.parameter_count()) = camera.parameters();
            return x;
          }(),
          0.1);
      EXPECT_LT((J - numeric).norm(), 1e-10) << p.transpose();
      for (int i = camera.parameter_count(); i < CameraModel::kMaxParameters; ++i) {
        EXPECT_TRUE(J.col(i).isZero(0.0));
      }
    }
  }
}

TEST(CameraModel, EquidistantIsExactNearTheAxis) {
  // theta_d / r = 1 - r^2 / 3 + k1 r^2 + O(r^4): no 0 / 0, no cancellation.
  const CameraModel camera = Camera(DistortionModel::kEquidistant, {1, 1, 0, 0, 0.3, 0, 0, 0});
  for (const double r : {0.0, 1e-300, 1e-200, 1e-12, 1e-8, 1e-6}) {
    Eigen::Vector2d uv;
    CameraModel::Jacobian2x3 J;
    ASSERT_TRUE(camera.Project({r, 0.0, 1.0}, &uv, &J));
    EXPECT_DOUBLE_EQ(uv.x(), r * (1.0 - (1.0 / 3.0 - 0.3) * r * r));
    EXPECT_NEAR(J(0, 0), 1.0, r * r + 1e-15);
    EXPECT_NEAR(J(1, 1), 1.0, r * r + 1e-15);
    EXPECT_NEAR(J(0, 1), 0.0, 1e-15);
  }
}

TEST(CameraModel, EquidistantSeriesMeetsTheClosedForm) {
  // The switch is at r = 0.1: nothing of the pixel or the Jacobian jumps there.
  const CameraModel camera = EquidistantCamera();
  Eigen::Vector2d below, above;
  CameraModel::Jacobian2x3 J_below, J_above;
  const double step = 1e-12;
  ASSERT_TRUE(camera.Project({0.1 - step, 0.0, 1.0}, &below, &J_below));
  ASSERT_TRUE(camera.Project({0.1 + step, 0.0, 1.0}, &above, &J_above));
  EXPECT_NEAR(above.x() - below.x(), 2.0 * step * J_below(0, 0), 2e-13);
  EXPECT_LT((J_above - J_below).norm(), 1e-9);  // second derivatives times the step
}

TEST(CameraModel, UnprojectUndoesProject) {
  for (const CameraModel& camera : Cameras()) {
    const double max_radius = std::min(0.95 * camera.max_radius(), 5.0);
    for (const Eigen::Vector3d& p : Points(max_radius)) {
      Eigen::Vector2d uv;
      ASSERT_TRUE(camera.Project(p, &uv));
      const auto direction = camera.Unproject(uv);
      ASSERT_TRUE(direction) << p.transpose();
      EXPECT_EQ(direction->z(), 1.0);
      // Rounding of the pixel (1e-13 of some hundred) through the inverse's slope, at most some
      // hundred at these radii.
      EXPECT_LT((*direction - p / p.z()).norm(), 1e-11) << p.transpose();
    }
  }
}

TEST(CameraModel, ProjectUndoesUnprojectAllOverTheImage) {
  for (const CameraModel& camera : Cameras()) {
    for (int v = -20; v <= 500; v += 20) {
      for (int u = -20; u <= 772; u += 22) {
        const Eigen::Vector2d pixel(u, v);
        const auto direction = camera.Unproject(pixel);
        // The corners of this fisheye look more than 90 degrees to the side.
        const Eigen::Vector2d from_axis = pixel - camera.parameters().segment<2>(2);
        if (camera.model() == DistortionModel::kEquidistant && from_axis.norm() > 290.0) continue;
        ASSERT_TRUE(direction) << pixel.transpose();
        Eigen::Vector2d uv;
        ASSERT_TRUE(camera.Project(*direction, &uv));
        // Promised: 1e-10 of the distorted direction; reached: rounding.
        EXPECT_LT((uv - pixel).norm(), 2e-12);
        EXPECT_LE(direction->head<2>().norm(), camera.max_radius());
      }
    }
  }
}

TEST(CameraModel, MaxRadiusIsTheFirstTurningPoint) {
  // r (1 - r^2 / 3): slope 1 - r^2.
  EXPECT_NEAR(
      Camera(DistortionModel::kRadialTangential, {1, 1, 0, 0, -1.0 / 3.0, 0, 0, 0, 0}).max_radius(),
      1.0, 1e-15);
  // Slope 1 - 5 u + 7 (6/7) u^2 = (1 - 2 u)(1 - 3 u): the smaller of two.
  EXPECT_NEAR(
      Camera(DistortionModel::kRadialTangential, {1, 1, 0, 0, -5.0 / 3.0, 6.0 / 5.0, 0, 0, 0})
          .max_radius(),
      std::sqrt(1.0 / 3.0), 1e-15);
  // Coefficients that are all positive, or none.
  EXPECT_TRUE(std::isinf(
      Camera(DistortionModel::kRadialTangential, {1, 1, 0, 0, 0.1, 0.1, 0, 0, 0.1}).max_radius()));
  EXPECT_TRUE(std::isinf(
      Camera(DistortionModel::kRadialTangential, {1, 1, 0, 0, 0, 0, 0, 0, 0}).max_radius()));
  // theta - theta^3 / 3 turns at 1 rad.
  EXPECT_NEAR(Camera(DistortionModel::kEquidistant, {1, 1, 0, 0, -1.0 / 3.0, 0, 0, 0}).max_radius(),
              std::tan(1.0), 1e-14);
  // Turns at 2 rad: beyond 90 degrees.
  EXPECT_TRUE(std::isinf(
      Camera(DistortionModel::kEquidistant, {1, 1, 0, 0, -1.0 / 12.0, 0, 0, 0}).max_radius()));
  // EuRoC's cameras: 1 + 3 k1 u + 5 k2 u^2 has no zero (9 k1^2 < 20 k2).
  EXPECT_TRUE(std::isinf(Euroc().max_radius()));
}

TEST(CameraModel, MaxRadiusAgreesWithAScan) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    for (const DistortionModel model :
         {DistortionModel::kRadialTangential, DistortionModel::kEquidistant}) {
      const bool fisheye = model == DistortionModel::kEquidistant;
      const auto k = [&] { return 0.3 * random.Normal(); };
      const CameraModel camera = fisheye ? Camera(model, {1, 1, 0, 0, k(), k(), k(), k()})
                                         : Camera(model, {1, 1, 0, 0, k(), k(), 0, 0, k()});
      // Up to a radius of 3, the radial slope is positive before max_radius and not behind it.
      const double end = std::min(camera.max_radius(), 3.0);
      for (int i = 1; i < 100; ++i) {
        Eigen::Vector2d uv;
        CameraModel::Jacobian2x3 J;
        ASSERT_TRUE(camera.Project({end * i / 100.0, 0.0, 1.0}, &uv, &J));
        EXPECT_GT(J(0, 0), 0.0) << camera.parameters().transpose() << " at " << i;
      }
      if (end < 3.0) {
        Eigen::Vector2d uv;
        CameraModel::Jacobian2x3 J;
        ASSERT_TRUE(camera.Project({end * (1.0 + 1e-6), 0.0, 1.0}, &uv, &J));
        EXPECT_LE(J(0, 0), 0.0);
      }
    }
  }
}

TEST(CameraModel, UnprojectStaysOnTheAxissBranch) {
  for (const DistortionModel model :
       {DistortionModel::kRadialTangential, DistortionModel::kEquidistant}) {
    const bool fisheye = model == DistortionModel::kEquidistant;
    const CameraModel camera = fisheye ? Camera(model, {100, 100, 0, 0, -1.0 / 3.0, 0, 0, 0})
                                       : Camera(model, {100, 100, 0, 0, -1.0 / 3.0, 0, 0, 0, 0});
    // |d| grows to 2/3 at the turning point: 66.67 px.
    for (const double angle : {0.0, 0.7, 2.0, 4.0}) {
      const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
      const auto inside = camera.Unproject(66.6 * direction);
      ASSERT_TRUE(inside);
      EXPECT_LT(inside->head<2>().norm(), camera.max_radius());
      EXPECT_FALSE(camera.Unproject(66.7 * direction)) << "no direction has this pixel";
      EXPECT_FALSE(camera.Unproject(1e6 * direction));
    }
    // A point beyond the turning point has a pixel, but unprojects to its twin inside.
    const double beyond = fisheye ? std::tan(1.3) : 1.3;
    Eigen::Vector2d uv;
    ASSERT_TRUE(camera.Project({beyond, 0.0, 1.0}, &uv));
    const auto twin = camera.Unproject(uv);
    ASSERT_TRUE(twin);
    EXPECT_LT(twin->x(), camera.max_radius());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(camera.Unproject({nan, 0.0}));
    EXPECT_FALSE(camera.Unproject({std::numeric_limits<double>::infinity(), 0.0}));
  }
}

TEST(CameraModel, UnprojectRefusesDirectionsAtRightAngles) {
  // Without distortion the fisheye's 90 degrees are at 100 pi / 2 px; (x, y, 1) ends before.
  const CameraModel camera = Camera(DistortionModel::kEquidistant, {100, 100, 0, 0, 0, 0, 0, 0});
  EXPECT_TRUE(camera.Unproject({157.0, 0.0}));
  EXPECT_FALSE(camera.Unproject({157.1, 0.0}));
}

TEST(CameraModel, ContainsTheAreaOfThePixels) {
  const CameraModel camera = Euroc();
  EXPECT_TRUE(camera.Contains({-0.5, -0.5}));
  EXPECT_FALSE(camera.Contains({-0.51, 0.0}));
  EXPECT_TRUE(camera.Contains({751.49, 479.49}));
  EXPECT_FALSE(camera.Contains({751.5, 0.0}));
  EXPECT_FALSE(camera.Contains({0.0, 479.5}));
  EXPECT_TRUE(camera.Contains({-5.5, 0.0}, 5.0));
  EXPECT_FALSE(camera.Contains({4.0, 4.0}, -5.0));
}

TEST(CameraModelDeathTest, ChecksTheNumberOfParameters) {
  EXPECT_DEATH(Camera(DistortionModel::kEquidistant, {1, 1, 0, 0, 0, 0, 0, 0, 0}), "equidistant");
}

}  // namespace
}  // namespace duet
