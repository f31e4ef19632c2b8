// The calibration as an error vector: which numbers are estimated, what the gauge holds, and what
// an estimator is told where the calibration is made wrong on purpose.

#include "common/measurement/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/geometry/so3.h"
#include "common/measurement/gauge.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/random.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

CalibrationPriors AllEstimated(ImuFrame imu_frame) {
  CalibrationPriors priors;
  priors.imu_frame = imu_frame;
  for (BlockPrior* block :
       {&priors.T_g, &priors.T_s, &priors.T_a, &priors.p_CB, &priors.R_CB, &priors.intrinsics,
        static_cast<BlockPrior*>(&priors.distortion), &priors.t_d, &priors.t_r}) {
    block->estimated = true;
  }
  return priors;
}

RigCalibration TwoCameras() {
  CameraModel::Parameters radtan(9);
  radtan << 458.6, 457.3, 367.2, 248.4, -0.283, 0.0739, 1.9e-4, 1.8e-5, 0.002;
  CameraModel::Parameters equidistant(8);
  equidistant << 450.1, 449.2, 370.0, 240.0, -0.01, 0.02, -0.01, 0.003;
  RigCalibration rig;
  rig.cameras.push_back({CameraModel(DistortionModel::kRadialTangential, 752, 480, radtan),
                         ExpQuaternion(Eigen::Vector3d(0.02, -0.03, 0.01)),
                         Eigen::Vector3d(0.06, -0.02, 0.01)});
  rig.cameras.push_back({CameraModel(DistortionModel::kEquidistant, 752, 480, equidistant),
                         ExpQuaternion(Eigen::Vector3d(0.01, 0.02, -0.02)),
                         Eigen::Vector3d(-0.05, -0.02, 0.015)});
  return rig;
}

// A rig in which every number of the T matrices counts.
RigCalibration AnyRig(std::uint64_t seed) {
  Random random(seed);
  RigCalibration rig = TwoCameras();
  for (Eigen::Matrix3d* T : {&rig.imu.T_g, &rig.imu.T_a}) {
    for (int k = 0; k < 9; ++k) (*T)(k / 3, k % 3) += 0.03 * random.Normal();
  }
  for (int k = 0; k < 9; ++k) rig.imu.T_s(k / 3, k % 3) = 1e-3 * random.Normal();
  rig.t_d_s = 0.004;
  rig.t_r_s = 0.02;
  return rig;
}

TEST(CalibrationLayout, HoldsTheThesissStatesAndTheFurtherCameras) {
  const RigCalibration rig = TwoCameras();
  const int distortion =
      rig.cameras[0].model.distortion_count() + rig.cameras[1].model.distortion_count();
  const CalibrationLayout free(AllEstimated(ImuFrame::kFree), rig);
  EXPECT_EQ(free.size(), 27 + 2 * (3 + 3 + 4) + distortion + 2);
  EXPECT_EQ(CalibrationLayout(AllEstimated(ImuFrame::kGyroscope), rig).size(), free.size() - 3);
  EXPECT_EQ(CalibrationLayout(AllEstimated(ImuFrame::kAccelerometer), rig).size(), free.size() - 3);
  EXPECT_EQ(static_cast<int>(free.ComponentNames().size()), free.size());
}

TEST(CalibrationLayout, TheGaugeHoldsTheNumbersAboveTheDiagonal) {
  const RigCalibration rig = AnyRig(1);
  const CalibrationLayout layout(AllEstimated(ImuFrame::kGyroscope), rig);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(layout.size());
  const RigCalibration moved = BoxPlus(rig, layout, 1e-3 * ones);
  for (int k = 0; k < 9; ++k) {
    const double change = moved.imu.T_g(k / 3, k % 3) - rig.imu.T_g(k / 3, k % 3);
    EXPECT_NEAR(change, IsAboveDiagonal(k) ? 0.0 : 1e-3, 1e-15) << k;
  }
  EXPECT_NEAR((BoxMinus(moved, rig, layout) - 1e-3 * ones).norm(), 0.0, 1e-12);
  const std::vector<std::string> names = layout.ComponentNames();
  EXPECT_THAT(
      std::vector<std::string>(names.begin(), names.begin() + 7),
      testing::ElementsAre("T_g.11", "T_g.21", "T_g.22", "T_g.31", "T_g.32", "T_g.33", "T_s.11"));
  EXPECT_THAT(std::vector<int>(layout.imu_columns().begin(), layout.imu_columns().begin() + 7),
              testing::ElementsAre(0, 3, 4, 6, 7, 8, 9));
}

TEST(CalibrationLayout, ADistortionsPriorGrowsWithItsNumber) {
  CalibrationPriors priors;
  priors.distortion.estimated = true;
  priors.distortion.sigma = 1e-4;
  priors.distortion.share = 0.05;
  const RigCalibration rig = TwoCameras();
  const Eigen::VectorXd sigmas = CalibrationLayout(priors, rig).PriorSigmas();
  const double k1 = rig.cameras[0].model.parameters()[CameraModel::kPinholeParameters];
  EXPECT_NEAR(sigmas[0], std::hypot(1e-4, 0.05 * k1), 1e-15);
}

TEST(CalibrationLayout, OnlyTheChosenCamerasAreEstimated) {
  CalibrationPriors priors;
  priors.p_CB.estimated = priors.t_d.estimated = true;
  priors.cameras = {1};
  const CalibrationLayout layout(priors, TwoCameras());
  EXPECT_EQ(layout.size(), 4);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kExtrinsicTranslation, 0), -1);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kExtrinsicTranslation, 1), 0);
}

// The reason for a gauge: the same motion, seen with other body axes, gives the same readings.
TEST(Gauge, TurnedAxesPredictTheSameReadingsAndPixels) {
  const RigCalibration rig = AnyRig(2);
  const Eigen::Quaterniond Q = ExpQuaternion(Eigen::Vector3d(0.3, -0.2, 0.5));
  const RigCalibration turned = Reoriented(rig, Q);
  const ImuRates rates{{0.3, -0.5, 0.7}, {1.0, 2.0, 9.0}};
  const ImuRates rates_turned{Q * rates.omega_B, Q * rates.a_B};
  const ImuRates read = DistortRates(rates, rig.imu, {});
  const ImuRates read_turned = DistortRates(rates_turned, turned.imu, {});
  EXPECT_NEAR((read.omega_B - read_turned.omega_B).norm(), 0.0, 1e-14);
  EXPECT_NEAR((read.a_B - read_turned.a_B).norm(), 0.0, 1e-14);
  const Eigen::Vector3d x_B(1.0, 2.0, 5.0);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const Eigen::Vector3d x_C = rig.cameras[c].R_CB * x_B + rig.cameras[c].p_CB;
    const Eigen::Vector3d x_C_turned = turned.cameras[c].R_CB * (Q * x_B) + turned.cameras[c].p_CB;
    EXPECT_NEAR((x_C - x_C_turned).norm(), 0.0, 1e-14);
  }
}

TEST(Gauge, TheTruthIsTurnedIntoTheEstimatorsAxes) {
  for (const ImuFrame frame : {ImuFrame::kGyroscope, ImuFrame::kAccelerometer}) {
    const CalibrationPriors priors = AllEstimated(frame);
    const RigCalibration truth = AnyRig(3);
    const RigCalibration told = AnyRig(4);
    const RigCalibration turned = Reoriented(truth, GaugeRotation(truth, told, priors));
    const Eigen::Matrix3d& T = frame == ImuFrame::kGyroscope ? turned.imu.T_g : turned.imu.T_a;
    const Eigen::Matrix3d& held = frame == ImuFrame::kGyroscope ? told.imu.T_g : told.imu.T_a;
    for (int k = 0; k < 9; ++k) {
      if (IsAboveDiagonal(k)) {
        EXPECT_NEAR(T(k / 3, k % 3), held(k / 3, k % 3), 1e-14);
      }
    }
  }
  CalibrationPriors camera = AllEstimated(ImuFrame::kCamera);
  camera.R_CB.estimated = false;
  RigCalibration told = AnyRig(4);
  told.cameras[0].R_CB = ExpQuaternion(Eigen::Vector3d(0.01, 0.02, 0.03)) * told.cameras[0].R_CB;
  const RigCalibration truth = AnyRig(3);
  const RigCalibration turned = Reoriented(truth, GaugeRotation(truth, told, camera));
  EXPECT_NEAR(turned.cameras[0].R_CB.angularDistance(told.cameras[0].R_CB), 0.0, 1e-14);
}

TEST(Gauge, ActsOnlyWhereThereIsSomethingToRemove) {
  CalibrationPriors priors = AllEstimated(ImuFrame::kGyroscope);
  EXPECT_TRUE(GaugeActs(priors));
  EXPECT_EQ(GaugeError(priors), "");
  priors.R_CB.estimated = false;
  EXPECT_FALSE(GaugeActs(priors));
  EXPECT_EQ(CalibrationLayout(priors, TwoCameras()).imu_columns().size(), 27u);
  priors.imu_frame = ImuFrame::kCamera;
  EXPECT_TRUE(GaugeActs(priors));  // the first camera ties the axes, and T_g, T_a take up its error
  EXPECT_EQ(GaugeError(priors), "");
  priors.R_CB.estimated = true;
  EXPECT_THAT(GaugeError(priors), HasSubstr("expected R_CB.state fixed"));
  priors.T_a.estimated = false;
  EXPECT_EQ(GaugeError(priors), "");
}

TEST(ToldErrors, ABlocksErrorsDoNotDependOnTheOthers) {
  const RigCalibration rig = AnyRig(5);
  ToldErrors only_t_d;
  only_t_d.t_d_s = 0.01;
  ToldErrors more = only_t_d;
  more.T_g = 0.01;
  more.p_CB_m = 0.02;
  const RigCalibration a = DrawToldRig(rig, only_t_d, ImuFrame::kGyroscope, {}, 7);
  const RigCalibration b = DrawToldRig(rig, more, ImuFrame::kGyroscope, {}, 7);
  EXPECT_NE(a.t_d_s, rig.t_d_s);
  EXPECT_EQ(a.t_d_s, b.t_d_s);
  EXPECT_EQ(a.imu.T_g, rig.imu.T_g);
  EXPECT_NE(a.t_d_s, DrawToldRig(rig, only_t_d, ImuFrame::kGyroscope, {}, 8).t_d_s);
  EXPECT_EQ(b.imu.T_g(0, 2), rig.imu.T_g(0, 2));  // the gauge's
  EXPECT_NE(b.imu.T_g(2, 0), rig.imu.T_g(2, 0));
  EXPECT_NE(DrawToldRig(rig, more, ImuFrame::kFree, {}, 7).imu.T_g(0, 2), rig.imu.T_g(0, 2));
}

TEST(ToldErrors, CamerasThatAreNotListedAreToldRight) {
  const RigCalibration rig = AnyRig(5);
  ToldErrors errors;
  errors.p_CB_m = 0.02;
  const RigCalibration told = DrawToldRig(rig, errors, ImuFrame::kFree, {1}, 7);
  EXPECT_EQ(told.cameras[0].p_CB, rig.cameras[0].p_CB);
  EXPECT_NE(told.cameras[1].p_CB, rig.cameras[1].p_CB);
}

TEST(ToldErrors, OffsetsAreAddedCameraByCameraOrToAll) {
  const RigCalibration rig = AnyRig(6);
  ToldOffset offset;
  offset.t_r_s = {-0.02};
  offset.p_CB_m = {0.01, 0.02, 0.03};
  offset.intrinsics_px = {1, 2, 3, 4, 5, 6, 7, 8};
  const RigCalibration told = AddToldOffset(rig, offset);
  EXPECT_NEAR(told.t_r_s, rig.t_r_s - 0.02, 1e-15);
  for (std::size_t c = 0; c < 2; ++c) {
    const Eigen::Vector3d moved = told.cameras[c].p_CB - rig.cameras[c].p_CB;
    EXPECT_NEAR((moved - Eigen::Vector3d(0.01, 0.02, 0.03)).norm(), 0.0, 1e-14);
    const Eigen::VectorXd change =
        told.cameras[c].model.parameters() - rig.cameras[c].model.parameters();
    EXPECT_NEAR(change[0], c == 0 ? 1.0 : 5.0, 1e-12);
  }
  offset.p_CB_m = {0.01, 0.02};
  EXPECT_THAT([&] { (void)AddToldOffset(rig, offset); },
              ThrowsMessage<InputError>("shared.calibration.told_offset.p_CB_m: has 2 numbers; "
                                        "expected 3, or 6 (one set a camera)"));
}

}  // namespace
}  // namespace duet
