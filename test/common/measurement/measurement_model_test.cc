#include "common/measurement/measurement_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "common/geometry/so3.h"
#include "common/imu/imu_delta.h"
#include "common/measurement/rate_profile.h"
#include "common/measurement/triangulation.h"
#include "common/support/random.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using test::NumericJacobian;
using test::RelativeDifference;

const Eigen::Vector3d kGravity(0, 0, -9.81);

Eigen::Vector3d RandomVector(Random* random, double sigma) {
  return {sigma * random->Normal(), sigma * random->Normal(), sigma * random->Normal()};
}

RigCalibration StereoRig(Random* random) {
  RigCalibration rig;
  CameraModel::Parameters radtan(9);
  radtan << 458.6, 457.3, 367.2, 248.4, -0.283, 0.0739, 1.9e-4, 1.8e-5, 0.002;
  CameraModel::Parameters equidistant(8);
  equidistant << 450.1, 449.2, 370.0, 240.0, -0.01, 0.02, -0.01, 0.003;
  rig.cameras.push_back({CameraModel(DistortionModel::kRadialTangential, 752, 480, radtan),
                         ExpQuaternion(RandomVector(random, 1.0)), RandomVector(random, 0.1)});
  rig.cameras.push_back({CameraModel(DistortionModel::kEquidistant, 752, 480, equidistant),
                         ExpQuaternion(RandomVector(random, 0.05)) * rig.cameras[0].R_CB,
                         RandomVector(random, 0.1)});
  return rig;
}

// IMU of a moving body around the instant 1 s.
ImuBuffer MovingImu() {
  ImuBuffer buffer;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.005 * i;
    buffer.Add({ToNanoseconds(t), Eigen::Vector3d(std::sin(3 * t), 1.5 * std::cos(2 * t), 0.8),
                Eigen::Vector3d(2 * std::cos(t), 1.0, 9.8 + std::sin(4 * t))});
  }
  return buffer;
}

constexpr Timestamp kInstant = 1'001'234'567;

// A landmark that the observing camera sees well inside its image.
struct Scene {
  RigCalibration rig;
  Pose anchor;
  InverseDepth landmark;
  ObservingState state;
  PixelObservation observation;
};

Scene RandomScene(Random* random, const RateProfile* rates) {
  while (true) {
    Scene s;
    s.rig = StereoRig(random);
    s.anchor = {ExpQuaternion(RandomVector(random, 1.0)), RandomVector(random, 2.0)};
    s.landmark = {0.4 * random->Normal(), 0.3 * random->Normal(), 0.1 + 0.5 * random->Uniform()};
    s.state.nav.R_GB = ExpQuaternion(RandomVector(random, 0.1)) * s.anchor.R;
    s.state.nav.p_GB = s.anchor.p + RandomVector(random, 0.3);
    s.state.nav.v_GB = RandomVector(random, 1.0);
    s.state.rates = rates;
    s.rig.t_d_s = 0.004 * random->Normal();
    s.state.t_d_at_instant_s = s.rig.t_d_s + 0.003 * random->Normal();
    s.rig.t_r_s = 0.04 * (2.0 * random->Uniform() - 1.0);
    s.rig.readout_by_columns = random->UniformInt(2) == 1;
    s.observation.camera = random->UniformInt(2);
    s.observation.uv = {752 * random->Uniform(), 480 * random->Uniform()};
    Eigen::Vector2d uv;
    if (!PredictPixel(s.rig, s.anchor, s.landmark, s.state, s.observation, kGravity, &uv) ||
        !s.rig.cameras[s.observation.camera].model.Contains(uv)) {
      continue;
    }
    // Within 50 degrees of the axis: beyond, the distortion polynomial folds points back into the
    // image with derivatives that no difference quotient resolves.
    const CameraCalibration& camera = s.rig.cameras[s.observation.camera];
    const Eigen::Vector3d p_C = camera.R_CB * (s.state.nav.pose().Inverse() *
                                               LandmarkInGlobal(s.rig, s.anchor, s.landmark)) +
                                camera.p_CB;
    if (p_C.z() > 0.64 * p_C.norm()) return s;
  }
}

TEST(PredictPixel, JacobiansAreDerivativesAtRandomStates) {
  // Both camera models, t_r up to 40 ms either way, rates corrected by biases and by T matrices up
  // to 5 % off the identity (T_s: 5e-3 rad/s per m/s^2).
  Random random(21);
  const ImuBuffer imu = MovingImu();
  const auto uniform = [&random](double bound) {
    return Eigen::Matrix3d::NullaryExpr([&]() { return random.Uniform(-bound, bound); }).eval();
  };
  std::array<int, 2> seen_by = {};
  for (int trial = 0; trial < 200; ++trial) {
    ImuCalibration calibration;
    calibration.T_g += uniform(0.05);
    calibration.T_s += uniform(0.005);
    calibration.T_a += uniform(0.05);
    RateProfile rates;
    rates.Assign(imu, kInstant, 0.06, {RandomVector(&random, 0.02), RandomVector(&random, 0.1)},
                 calibration);
    const Scene s = RandomScene(&random, &rates);
    ++seen_by[s.observation.camera];
    ObservationJacobians J;
    Eigen::Vector2d uv;
    ASSERT_TRUE(
        PredictPixel(s.rig, s.anchor, s.landmark, s.state, s.observation, kGravity, &uv, &J));
    const int camera = s.observation.camera;
    const int parameters = s.rig.cameras[camera].model.parameter_count();
    const auto moved = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      Scene m = s;
      m.landmark += x.segment<3>(0);
      m.anchor.R = BoxPlus(m.anchor.R, Eigen::Vector3d(x.segment<3>(3)));
      m.anchor.p += x.segment<3>(6);
      m.state.nav = BoxPlus(m.state.nav, Vector9d(x.segment<9>(9)));
      CameraCalibration& c0 = m.rig.cameras[0];
      CameraCalibration& ck = m.rig.cameras[camera];
      c0.p_CB += x.segment<3>(18);
      c0.R_CB = BoxPlus(c0.R_CB, Eigen::Vector3d(x.segment<3>(21)));
      if (camera != 0) {
        ck.p_CB += x.segment<3>(24);
        ck.R_CB = BoxPlus(ck.R_CB, Eigen::Vector3d(x.segment<3>(27)));
      }
      ck.model.set_parameters(ck.model.parameters() + x.segment(30, parameters));
      m.rig.t_d_s += x[39];
      m.rig.t_r_s += x[40];
      Eigen::Vector2d pixel;
      EXPECT_TRUE(
          PredictPixel(m.rig, m.anchor, m.landmark, m.state, m.observation, kGravity, &pixel));
      return pixel;
    };
    // Steps of 1e-4 keep the differences good to 1e-9 of a block.
    const Eigen::MatrixXd N = NumericJacobian(moved, Eigen::VectorXd::Zero(41), 1e-4);
    // Relative to the block's largest number. Where a block may vanish it is measured against the
    // least that means anything: J_v = tau J_p, against 1 px per m/s; C0's extrinsics seen by C0
    // itself are the difference of two terms of 100 px per rad or more; t_r acts by k t_r / N and
    // not at all in the middle row, against 1 px/s.
    constexpr double kTolerance = 1e-6;
    EXPECT_LT(RelativeDifference(J.landmark, N.middleCols<3>(0)), kTolerance);
    EXPECT_LT(RelativeDifference(J.anchor.leftCols<3>(), N.middleCols<3>(3)), kTolerance);
    EXPECT_LT(RelativeDifference(J.anchor.rightCols<3>(), N.middleCols<3>(6)), kTolerance);
    EXPECT_LT(RelativeDifference(J.state.leftCols<3>(), N.middleCols<3>(9)), kTolerance);
    EXPECT_LT(RelativeDifference(J.state.middleCols<3>(3), N.middleCols<3>(12)), kTolerance);
    EXPECT_LT(RelativeDifference(J.state.rightCols<3>(), N.middleCols<3>(15), 1.0), kTolerance);
    Eigen::Matrix<double, 2, 6> c0 = J.anchor_extrinsics;
    if (camera == 0) c0 += J.extrinsics;
    EXPECT_LT(RelativeDifference(c0.leftCols<3>(), N.middleCols<3>(18), 100.0), kTolerance);
    EXPECT_LT(RelativeDifference(c0.rightCols<3>(), N.middleCols<3>(21), 100.0), kTolerance);
    if (camera != 0) {
      EXPECT_LT(RelativeDifference(J.extrinsics.leftCols<3>(), N.middleCols<3>(24)), kTolerance);
      EXPECT_LT(RelativeDifference(J.extrinsics.rightCols<3>(), N.middleCols<3>(27)), kTolerance);
    }
    constexpr int kPinhole = CameraModel::kPinholeParameters;
    const int distortion = parameters - kPinhole;
    EXPECT_LT(RelativeDifference(J.parameters.leftCols<kPinhole>(), N.middleCols<kPinhole>(30)),
              kTolerance);
    EXPECT_LT(RelativeDifference(J.parameters.middleCols(kPinhole, distortion),
                                 N.middleCols(30 + kPinhole, distortion)),
              kTolerance);
    // The rates have a kink at every IMU sample: shorter steps, which rarely cross one.
    const auto moved_times = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      Eigen::VectorXd all = Eigen::VectorXd::Zero(41);
      all.tail<2>() = x;
      return moved(all);
    };
    const Eigen::MatrixXd T = NumericJacobian(moved_times, Eigen::VectorXd::Zero(2), 1e-6);
    EXPECT_LT(RelativeDifference(J.t_d, T.col(0)), kTolerance);
    EXPECT_LT(RelativeDifference(J.t_r, T.col(1), 1.0), kTolerance);
  }
  EXPECT_GT(*std::min_element(seen_by.begin(), seen_by.end()), 50);  // both models
}

TEST(PredictPixel, AnchorsOwnObservationIsTheLandmarksDirection) {
  Random random(2);
  const RigCalibration rig = StereoRig(&random);
  const Pose anchor = {ExpQuaternion(RandomVector(&random, 1.0)), RandomVector(&random, 2.0)};
  ObservingState state;
  state.nav = {anchor.R, anchor.p, Eigen::Vector3d::Zero()};
  Eigen::Vector2d uv;
  Eigen::Vector2d expected;
  ObservationJacobians J;
  ASSERT_TRUE(PredictPixel(rig, anchor, {0.1, -0.2, 0.3}, state, {0, {}}, kGravity, &uv, &J));
  ASSERT_TRUE(rig.cameras[0].model.Project({0.1, -0.2, 1.0}, &expected));
  EXPECT_LT((uv - expected).norm(), 1e-9);
  // Where anchor and observing state are one, its pose drops out.
  EXPECT_LT((J.anchor + J.state.leftCols<6>()).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((J.anchor_extrinsics + J.extrinsics).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(J.landmark.col(2).norm(), 1e-9);
}

TEST(PredictPixel, RowTimeIsTheStateTakenThereByTheImu) {
  Random random(4);
  const ImuBuffer imu = MovingImu();
  RateProfile rates;
  rates.Assign(imu, kInstant, 0.06, {}, {});
  for (int trial = 0; trial < 50; ++trial) {
    const Scene s = RandomScene(&random, &rates);
    const double tau = ObservationDelay(s.rig, s.observation, s.state.t_d_at_instant_s);
    const Timestamp there = kInstant + ToNanoseconds(tau);
    std::vector<ImuSample> readings;
    imu.Extract(kInstant, there, &readings);
    ObservingState moved;
    moved.nav = Predict(s.state.nav, IntegrateImu(readings, {}, {}, {}), kGravity);
    RigCalibration global_shutter = s.rig;
    global_shutter.t_d_s = 0.0;
    global_shutter.t_r_s = 0.0;
    Eigen::Vector2d direct;
    Eigen::Vector2d through_profile;
    ASSERT_TRUE(PredictPixel(s.rig, s.anchor, s.landmark, s.state, s.observation, kGravity,
                             &through_profile));
    ASSERT_TRUE(PredictPixel(global_shutter, s.anchor, s.landmark, moved, s.observation, kGravity,
                             &direct));
    EXPECT_LT((through_profile - direct).norm(), 1e-5);  // a nanosecond of rounding is 1e-6 px
  }
}

TEST(RateProfile, FrozenRatesStayFrozen) {
  const ImuBuffer imu = MovingImu();
  RateProfile a;
  RateProfile b;
  a.Assign(imu, kInstant, 0.03, {}, {});
  ImuBiases biases;
  biases.b_g.setConstant(0.01);
  b.Assign(imu, kInstant, 0.03, biases, {});
  // The profile knows its own biases alone; what a bias does within tau is left out of every
  // Jacobian by definition: b_g tau, 0.02 rad/s over 20 ms is 0.2 px at a focal length of 460 px.
  const double tau = 0.02;
  const double angle = BoxMinus(a.At(tau).R, b.At(tau).R).norm();
  EXPECT_NEAR(angle, biases.b_g.norm() * tau, 1e-6);
  EXPECT_EQ(a.At(0.0).s.norm(), 0.0);
  // Beyond its reach the outermost rates go on.
  EXPECT_LT((a.At(0.2).omega_B - a.At(0.0301).omega_B).norm(), 1e-12);
}

TEST(Triangulation, FindsThePointAndSaysWhyNot) {
  Random random(6);
  const RigCalibration rig = StereoRig(&random);
  for (int trial = 0; trial < 100; ++trial) {
    const Pose anchor = {ExpQuaternion(RandomVector(&random, 1.0)), RandomVector(&random, 2.0)};
    const InverseDepth truth(0.3 * random.Normal(), 0.2 * random.Normal(), 0.1 + random.Uniform());
    std::vector<TrackObservationInState> observations;
    for (int i = 0; i < 8; ++i) {
      TrackObservationInState o;
      o.state.nav.R_GB = ExpQuaternion(RandomVector(&random, 0.05)) * anchor.R;
      o.state.nav.p_GB = anchor.p + RandomVector(&random, 0.2);
      o.observation.camera = i % 2;
      if (PredictPixel(rig, anchor, truth, o.state, o.observation, kGravity, &o.observation.uv) &&
          rig.cameras[o.observation.camera].model.Contains(o.observation.uv)) {
        observations.push_back(o);
      }
    }
    if (observations.size() < 4) continue;
    InverseDepth landmark;
    ASSERT_EQ(Triangulate(rig, observations, anchor, kGravity, {}, &landmark),
              TriangulationStatus::kOk);
    EXPECT_LT((landmark - truth).norm(), 1e-6);  // exact pixels: the solver's own stop

    const std::span<const TrackObservationInState> one(observations.data(), 1);
    EXPECT_EQ(Triangulate(rig, one, anchor, kGravity, {}, &landmark),
              TriangulationStatus::kTooFewObservations);
    const std::vector<TrackObservationInState> same(5, observations[0]);
    EXPECT_EQ(Triangulate(rig, same, anchor, kGravity, {}, &landmark),
              TriangulationStatus::kNoParallax);
    TriangulationOptions near_only;
    near_only.max_depth_m = 0.5 / truth.z();
    EXPECT_EQ(Triangulate(rig, observations, anchor, kGravity, near_only, &landmark),
              TriangulationStatus::kTooFar);
    auto outlier = observations;
    outlier[1].observation.uv += Eigen::Vector2d(60.0, -60.0);
    const TriangulationStatus status = Triangulate(rig, outlier, anchor, kGravity, {}, &landmark);
    EXPECT_NE(status, TriangulationStatus::kOk);
  }
}

TEST(CalibrationLayout, KeepsTheOrderOfTheCalibrationVector) {
  Random random(8);
  const RigCalibration rig = StereoRig(&random);
  CalibrationPriors priors;
  priors.T_s.estimated = priors.p_CB.estimated = priors.distortion.estimated = true;
  priors.R_CB.estimated = priors.t_d.estimated = true;
  const CalibrationLayout layout(priors, rig);
  EXPECT_EQ(layout.size(), 9 + (3 + 3 + 5) + (3 + 3 + 4) + 1);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kTs), 0);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kTg), -1);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kExtrinsicRotation, 0), 12);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kExtrinsicTranslation, 1), 20);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kTimeOffset), 30);
  EXPECT_EQ(layout.OffsetOf(CalibrationBlock::kReadoutTime), -1);
  const auto names = layout.ComponentNames();
  ASSERT_EQ(names.size(), 31U);
  EXPECT_EQ(names[0], "T_s.11");
  EXPECT_EQ(names[12], "cam0.R_CB.x");
  EXPECT_EQ(names[15], "cam0.k1");
  EXPECT_EQ(names[30], "t_d");
  Eigen::VectorXd error(31);
  for (int i = 0; i < 31; ++i) error[i] = 0.01 * random.Normal();
  const RigCalibration moved = BoxPlus(rig, layout, error);
  EXPECT_LT((BoxMinus(moved, rig, layout) - error).norm(), 1e-12);
  EXPECT_EQ(CalibrationLayout().size(), 0);
}

}  // namespace
}  // namespace duet
