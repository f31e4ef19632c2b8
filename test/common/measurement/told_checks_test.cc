// A told calibration that no estimator can start from is refused, with the key that made it so.

#include "common/measurement/told_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

RigCalibration OneCamera() {
  CameraModel::Parameters parameters(9);
  parameters << 458.6, 457.3, 367.2, 248.4, -0.283, 0.0739, 1.9e-4, 1.8e-5, 0.002;
  RigCalibration rig;
  rig.cameras.push_back({CameraModel(DistortionModel::kRadialTangential, 752, 480, parameters),
                         Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()});
  return rig;
}

void Check(const CalibrationPriors& priors) { CheckTold(ToldRig(OneCamera(), priors), priors); }

TEST(CheckTold, RefusesCamerasThatTheRigDoesNotHave) {
  CalibrationPriors priors;
  priors.intrinsics.estimated = true;
  priors.cameras = {0};
  EXPECT_NO_THROW(Check(priors));
  priors.cameras = {0, 1};
  EXPECT_THAT([&] { Check(priors); },
              ThrowsMessage<InputError>(HasSubstr("shared.calibration.cameras: names camera 1; "
                                                  "expected cameras of the rig, counted from 0: "
                                                  "it has 1")));
}

TEST(CheckTold, RefusesFocalLengthsThatAreNotAboveZero) {
  CalibrationPriors priors;
  priors.told_offset.intrinsics_px = {0, 20, -300, 0};
  EXPECT_NO_THROW(Check(priors));
  priors.told_offset.intrinsics_px = {0, -500, 0, 0};
  EXPECT_THAT([&] { Check(priors); },
              ThrowsMessage<InputError>(HasSubstr(
                  "shared.calibration.told_offset.intrinsics_px: the told fy of camera 0 is -42")));
  RigCalibration drawn = OneCamera();
  drawn.cameras[0].model = CameraModel(DistortionModel::kRadialTangential, 752, 480,
                                       -drawn.cameras[0].model.parameters());
  priors.told_offset = {};
  priors.told_errors.intrinsics_px = 1e4;
  EXPECT_THAT([&] { CheckTold(drawn, priors); },
              ThrowsMessage<InputError>(HasSubstr("told_errors.intrinsics_px: the told fx")));
  priors.told_errors = {};
  EXPECT_THAT([&] { CheckTold(drawn, priors); },
              ThrowsMessage<InputError>(HasSubstr("intrinsics.sigma: the told fx")));
}

TEST(CheckTold, RefusesMatricesWithoutAnInverse) {
  CalibrationPriors priors;
  priors.told_offset.T_a = {-1, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_THAT([&] { Check(priors); },
              ThrowsMessage<InputError>(HasSubstr("shared.calibration.told_offset.T_a: the told "
                                                  "T_a has a determinant of 0")));
  priors.told_offset = {};
  priors.told_offset.T_g = {0, 1, 0, 1, 0, 0, 0, 0, 0};
  EXPECT_THAT([&] { Check(priors); },
              ThrowsMessage<InputError>(HasSubstr("expected a matrix with an inverse")));
  priors.told_offset.T_g = {0.1, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_NO_THROW(Check(priors));
}

}  // namespace
}  // namespace duet
