// The stacked measurement Jacobians of one landmark (6.19 to 6.22, figure 6.3).

#include "backends/msckf/linearization.h"

#include <gtest/gtest.h>

#include "test/backends/msckf/random_state.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using test::kGravity;

CalibrationPriors Everything() {
  CalibrationPriors priors;
  priors.T_g.estimated = priors.T_s.estimated = priors.T_a.estimated = true;
  priors.p_CB.estimated = priors.R_CB.estimated = true;
  priors.intrinsics.estimated = priors.distortion.estimated = true;
  priors.t_d.estimated = priors.t_r.estimated = true;
  return priors;
}

CalibrationPriors PositionAndTime() {
  CalibrationPriors priors;
  priors.p_CB.estimated = priors.t_d.estimated = true;
  return priors;
}

struct Scene {
  FilterState state;
  InverseDepth landmark;
  int anchor = 1;
  std::vector<CloneObservation> observations;
  LinearizationSettings settings;

  struct Result {
    Eigen::MatrixXd H_f;
    Eigen::MatrixXd H_r;  // over the whole error state
    bool ok;
  };

  [[nodiscard]] Result Linearize() const {
    VisualColumns columns;
    columns.Assign(state);
    const auto rows = static_cast<Eigen::Index>(2 * observations.size());
    LandmarkRows H_f(rows, 3);
    MeasurementRows H_r(rows, columns.width() + 1);
    const bool ok =
        LinearizeLandmark(state, columns, settings, anchor, landmark, observations, H_f, H_r);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(rows, state.size() + 1);
    for (int j = 0; j < columns.width(); ++j) dense.col(columns.components()[j]) = H_r.col(j);
    dense.rightCols<1>() = H_r.rightCols<1>();
    return {H_f, dense, ok};
  }

  [[nodiscard]] Eigen::VectorXd Residual() const { return Linearize().H_r.rightCols<1>(); }
};

// Both cameras see the landmark in clones 1 .. 4, clone 3 with the first only; pixels are off from
// what is predicted by about a pixel.
Scene MakeScene(Random* random, const RigCalibration& rig, const CalibrationPriors& priors) {
  Scene scene{test::RandomState(random, rig, priors, 5), test::RandomLandmark(random), 1, {}, {}};
  scene.settings.pixel_noise_px = 0.7;
  for (int clone = 1; clone < 5; ++clone) {
    for (int camera = 0; camera < 2; ++camera) {
      if (clone == 3 && camera == 1) continue;
      scene.observations.push_back({clone, {camera, Eigen::Vector2d(300, 200)}});
    }
  }
  const Eigen::VectorXd r = scene.Residual();
  for (std::size_t k = 0; k < scene.observations.size(); ++k) {
    // z := prediction + noise; a rolling shutter's row changes a little with it, no matter.
    scene.observations[k].pixel.uv -=
        scene.settings.pixel_noise_px * r.segment<2>(static_cast<Eigen::Index>(2 * k)) +
        Eigen::Vector2d(random->Normal(), random->Normal());
  }
  return scene;
}

RigCalibration Rolling() {
  RigCalibration rig = test::StereoRig();
  rig.t_d_s = 0.003;
  rig.t_r_s = 0.02;
  return rig;
}

TEST(Linearization, EqualsNumericDifferentiationOverStateAndCalibration) {
  Random random(1);
  for (const auto& [rig, priors] :
       {std::pair(test::StereoRig(), CalibrationPriors()),
        std::pair(test::StereoRig(), PositionAndTime()), std::pair(Rolling(), Everything())}) {
    const Scene scene = MakeScene(&random, rig, priors);
    const Scene::Result result = scene.Linearize();
    ASSERT_TRUE(result.ok);
    const Eigen::MatrixXd numeric = -test::NumericJacobian(
        [&](const Eigen::VectorXd& error) {
          Scene moved = scene;
          moved.state.Correct(1e-2 * error, 1.0, 1.0);
          return moved.Residual();
        },
        Eigen::VectorXd::Zero(scene.state.size()));
    // T matrices act on pixels within tau only: left out by definition, frozen in the test too.
    // 1e-7: the integration error of the motion within tau, of which only the end is
    // differentiated.
    EXPECT_LT(test::RelativeDifference(1e-2 * result.H_r.leftCols(scene.state.size()), numeric),
              1e-7);
    const Eigen::MatrixXd numeric_f = -test::NumericJacobian(
        [&](const Eigen::VectorXd& error) {
          Scene moved = scene;
          moved.landmark += 1e-2 * error;
          return moved.Residual();
        },
        Eigen::VectorXd::Zero(3));
    EXPECT_LT(test::RelativeDifference(1e-2 * result.H_f, numeric_f), 1e-8);
  }
}

// Turning about gravity and shifting, at the given values of the clones.
Eigen::MatrixXd Unobservable(const FilterState& state, bool first) {
  const Eigen::Vector3d up = -kGravity.normalized();
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(state.size(), 4);
  for (int i = 0; i < static_cast<int>(state.clones().size()); ++i) {
    const NavState& nav = first ? state.clones()[i].nav_fej : state.clones()[i].nav;
    const int offset = state.CloneOffset(i);
    N.block<3, 1>(offset, 0) = up;
    N.block<3, 1>(offset + 3, 0) = up.cross(nav.p_GB);
    if (state.time_matters()) N.block<3, 1>(offset + 6, 0) = up.cross(nav.v_GB);
    N.block<3, 3>(offset + 3, 1).setIdentity();
  }
  return N;
}

TEST(Linearization, IsBlindToUnobservableDirectionsAtTheFirstEstimates) {
  Random random(2);
  for (const auto& [rig, priors] :
       {std::pair(test::StereoRig(), CalibrationPriors()), std::pair(Rolling(), Everything())}) {
    Scene scene = MakeScene(&random, rig, priors);
    const auto along = [&](bool first) -> double {
      const Scene::Result result = scene.Linearize();
      EXPECT_TRUE(result.ok);
      const Eigen::MatrixXd H = result.H_r.leftCols(scene.state.size());
      return (H * Unobservable(scene.state, first)).norm() / H.norm();
    };
    scene.settings.separate_first_estimates = true;
    EXPECT_LT(along(true), 1e-13);
    EXPECT_GT(along(false), 1e-5);
    scene.settings.separate_first_estimates = false;
    EXPECT_LT(along(false), 1e-13);
    EXPECT_GT(along(true), 1e-5);
  }
}

TEST(Linearization, ResidualIsTakenAtTheCurrentEstimates) {
  Random random(3);
  Scene scene = MakeScene(&random, test::StereoRig(), CalibrationPriors());
  const Eigen::VectorXd r = scene.Residual();
  scene.settings.separate_first_estimates = true;
  EXPECT_EQ(scene.Residual(), r);
}

TEST(Linearization, RefusesAPointBehindACamera) {
  Random random(4);
  Scene scene = MakeScene(&random, test::StereoRig(), CalibrationPriors());
  scene.state.clones()[2].nav.R_GB =
      ExpQuaternion(Eigen::Vector3d(0, M_PI, 0)) * scene.state.clones()[2].nav.R_GB;
  EXPECT_FALSE(scene.Linearize().ok);
}

}  // namespace
}  // namespace duet
