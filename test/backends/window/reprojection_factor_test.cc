#include "backends/window/reprojection_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "common/geometry/so3.h"
#include "test/backends/window/random_window.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using window_test::RandomVector;
using window_test::RandomWindow;

// A window of two frames with one camera of each model, T matrices up to 5 % off the identity (T_s:
// 5e-3 rad/s per m/s^2) and t_r up to 40 ms either way.
RandomWindow MakeWindow(int seed, Random* random) {
  const auto uniform = [random](double bound) {
    return Eigen::Matrix3d::NullaryExpr([&]() { return random->Uniform(-bound, bound); }).eval();
  };
  RandomWindow window(2, 0, seed);
  CameraModel::Parameters equidistant(8);
  equidistant << 450.1, 449.2, 370.0, 240.0, -0.01, 0.02, -0.01, 0.003;
  window.rig.cameras[1].model = CameraModel(DistortionModel::kEquidistant, 752, 480, equidistant);
  window.rig.imu.T_g = Eigen::Matrix3d::Identity() + uniform(0.05);
  window.rig.imu.T_s = uniform(0.005);
  window.rig.imu.T_a = Eigen::Matrix3d::Identity() + uniform(0.05);
  window.rig.t_r_s = random->Uniform(-0.04, 0.04);
  window.rig.readout_by_columns = random->UniformInt(2) == 1;
  window.layout = CalibrationLayout(window_test::EverythingEstimated(), window.rig);
  for (WindowFrame& frame : window.frames) {
    frame.t_d_at_instant_s = window.rig.t_d_s + random->Uniform(-0.003, 0.003);
    frame.rates.Assign(window.imu, frame.state.instant, 0.04, frame.state.biases, window.rig.imu);
  }
  return window;
}

TEST(ReprojectionFactor, JacobiansAgreeWithNumericDifferentiation) {
  Random random(1);
  double worst = 0.0;
  std::array<int, 2> seen_by = {};
  for (int trial = 0; trial < 200; ++trial) {
    const RandomWindow window = MakeWindow(300 + trial, &random);
    const WindowPoint point = window.Point();
    const InverseDepth landmark(random.Uniform(-0.4, 0.4), random.Uniform(-0.3, 0.3),
                                1.0 / random.Uniform(2.0, 8.0));
    const LandmarkObservation observation{
        1,
        {random.UniformInt(2),
         Eigen::Vector2d(random.Uniform(0.0, 752.0), random.Uniform(0.0, 480.0))}};
    constexpr int kAnchor = 0;
    Eigen::Vector2d r;
    ReprojectionJacobians J;
    ASSERT_TRUE(EvaluateReprojection(window.reprojection, point, window.frames, window.layout,
                                     kAnchor, observation, landmark, &r, &J));
    ++seen_by[observation.pixel.camera];
    Eigen::Vector2d without_jacobians;
    ASSERT_TRUE(EvaluateReprojection(window.reprojection, point, window.frames, kAnchor,
                                     observation, landmark, &without_jacobians));
    EXPECT_LT((r - without_jacobians).norm(), 1e-14 * r.norm());  // rounding

    // Landmark (3), anchor (6), state (9), calibration.
    constexpr int kCalibration = 18;
    const Eigen::Index size = kCalibration + window.layout.size();
    // In steps of 1e-4 of every unit; 1e-6 s of the times, whose rates have a kink at IMU samples.
    Eigen::VectorXd unit = Eigen::VectorXd::Constant(size, 0.1);
    struct Block {
      int offset;
      int size;
    };
    std::vector<Block> blocks = {{0, 3}, {3, 3}, {6, 3}, {9, 3}, {12, 3}, {15, 3}};
    for (const CalibrationLayout::Entry& entry : window.layout.entries()) {
      blocks.push_back({kCalibration + entry.offset, entry.size});
      if (entry.block == CalibrationBlock::kTimeOffset ||
          entry.block == CalibrationBlock::kReadoutTime) {
        unit.segment(kCalibration + entry.offset, entry.size).setConstant(1e-3);
      }
    }
    const auto residual = [&](const Eigen::VectorXd& scaled) -> Eigen::VectorXd {
      const Eigen::VectorXd error = unit.cwiseProduct(scaled);
      WindowPoint moved = point;
      Vector9d anchor_error = Vector9d::Zero();
      anchor_error.head<6>() = error.segment<6>(3);
      moved.nav[kAnchor] = BoxPlus(moved.nav[kAnchor], anchor_error);
      moved.nav[1] = BoxPlus(moved.nav[1], Vector9d(error.segment<9>(9)));
      moved.rig = BoxPlus(moved.rig, window.layout, error.tail(window.layout.size()));
      Eigen::Vector2d value;
      EXPECT_TRUE(EvaluateReprojection(window.reprojection, moved, window.frames, kAnchor,
                                       observation, InverseDepth(landmark + error.head<3>()),
                                       &value));
      return value;
    };
    const Eigen::MatrixXd numeric = test::NumericJacobian(residual, Eigen::VectorXd::Zero(size)) *
                                    unit.cwiseInverse().asDiagonal();
    Eigen::MatrixXd analytic(2, size);
    analytic << J.landmark, J.anchor, J.state, J.calibration;
    // Relative to the block's largest number. Zero by definition or nearly are those of T matrices
    // (rates are frozen within tau), of the camera that does not see the point, of v (tau J_p) and
    // of t_r in the middle row: against 1 px per unit, 1e-2 and less of the others.
    for (const Block& block : blocks) {
      const double off =
          test::RelativeDifference(analytic.middleCols(block.offset, block.size),
                                   numeric.middleCols(block.offset, block.size), 1.0);
      worst = std::max(worst, off);
      EXPECT_LT(off, 1e-6) << "columns from " << block.offset << " of trial " << trial;
    }
  }
  EXPECT_GT(*std::min_element(seen_by.begin(), seen_by.end()), 50);  // both models
  std::printf("largest relative difference of a block: %.1e\n", worst);
}

}  // namespace
}  // namespace duet
