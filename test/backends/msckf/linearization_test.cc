// The stacked measurement Jacobians of one landmark (6.19 to 6.22, figure 6.3).

#include "backends/msckf/linearization.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

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

// T matrices up to 5 % off the identity (T_s: 5e-3 rad/s per m/s^2), t_r up to 40 ms either way.
RigCalibration RandomRig(Random* random) {
  const auto uniform = [random](double bound) {
    return Eigen::Matrix3d::NullaryExpr([&]() { return random->Uniform(-bound, bound); }).eval();
  };
  RigCalibration rig = test::StereoRig();
  rig.imu.T_g = Eigen::Matrix3d::Identity() + uniform(0.05);
  rig.imu.T_s = uniform(0.005);
  rig.imu.T_a = Eigen::Matrix3d::Identity() + uniform(0.05);
  rig.t_d_s = random->Uniform(-0.01, 0.01);
  rig.t_r_s = random->Uniform(-0.04, 0.04);
  rig.readout_by_columns = random->UniformInt(2) == 1;
  return rig;
}

struct Block {
  int offset;
  int size;
};

// Parts of the error state that are judged by themselves.
std::vector<Block> Blocks(const FilterState& state) {
  std::vector<Block> blocks;
  for (int offset = 0; offset < FilterState::kNavSize; offset += 3) blocks.push_back({offset, 3});
  for (const CalibrationLayout::Entry& entry : state.layout().entries()) {
    blocks.push_back({FilterState::kNavSize + entry.offset, entry.size});
  }
  for (int clone = 0; clone < static_cast<int>(state.clones().size()); ++clone) {
    for (int part = 0; part < (state.time_matters() ? 9 : 6); part += 3) {
      blocks.push_back({state.CloneOffset(clone) + part, 3});
    }
  }
  return blocks;
}

TEST(Linearization, EqualsNumericDifferentiationOverStateAndCalibration) {
  // 200 states: every third with nothing estimated, with p_CB and t_d, with everything. Both camera
  // models see each landmark.
  Random random(1);
  double worst = 0.0;
  int draws = 0;
  for (int trial = 0; trial < 200;) {
    ASSERT_LT(++draws, 400);
    const CalibrationPriors priors = trial % 3 == 0   ? CalibrationPriors()
                                     : trial % 3 == 1 ? PositionAndTime()
                                                      : Everything();
    const RigCalibration rig = trial % 3 == 0 ? test::StereoRig() : RandomRig(&random);
    Scene scene = MakeScene(&random, rig, priors);
    if (trial % 3 == 2) {
      for (Clone& clone : scene.state.clones()) {
        clone.t_d_at_instant_s += random.Uniform(-0.003, 0.003);  // t_d has moved since
      }
    }
    const Scene::Result result = scene.Linearize();
    if (!result.ok) continue;  // behind a camera: another one
    ++trial;
    // In steps of 1e-5 of every unit; 1e-6 s of the times, whose rates have a kink at IMU samples.
    Eigen::VectorXd unit = Eigen::VectorXd::Constant(scene.state.size(), 1e-2);
    for (const CalibrationLayout::Entry& entry : scene.state.layout().entries()) {
      if (entry.block == CalibrationBlock::kTimeOffset ||
          entry.block == CalibrationBlock::kReadoutTime) {
        unit.segment(FilterState::kNavSize + entry.offset, entry.size).setConstant(1e-3);
      }
    }
    const Eigen::MatrixXd numeric = -test::NumericJacobian(
                                        [&](const Eigen::VectorXd& error) {
                                          Scene moved = scene;
                                          moved.state.Correct(unit.cwiseProduct(error), {});
                                          return moved.Residual();
                                        },
                                        Eigen::VectorXd::Zero(scene.state.size())) *
                                    unit.cwiseInverse().asDiagonal();
    // T matrices act on pixels within tau only: left out by definition, frozen here too. Blocks
    // that are zero (the state at the end, whose clone is another block; T matrices; v where tau is
    // zero) are judged against 1 px per unit, 1e-2 and less of the others.
    for (const Block& block : Blocks(scene.state)) {
      const double off =
          test::RelativeDifference(result.H_r.middleCols(block.offset, block.size),
                                   numeric.middleCols(block.offset, block.size), 1.0);
      worst = std::max(worst, off);
      EXPECT_LT(off, 1e-6) << "columns from " << block.offset << " of trial " << trial;
    }
    const Eigen::MatrixXd numeric_f = -1e2 * test::NumericJacobian(
                                                 [&](const Eigen::VectorXd& error) {
                                                   Scene moved = scene;
                                                   moved.landmark += 1e-2 * error;
                                                   return moved.Residual();
                                                 },
                                                 Eigen::VectorXd::Zero(3));
    EXPECT_LT(test::RelativeDifference(result.H_f, numeric_f), 1e-6);
  }
  std::printf("largest relative difference of a block: %.1e\n", worst);
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
