#include "common/measurement/standstill.h"

#include <gtest/gtest.h>

#include "common/geometry/so3.h"
#include "common/support/random.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

// Frames at 20 Hz of 40 points that move by `speed_px` a frame, IMU at 200 Hz that vibrates.
struct Recording {
  ImuBuffer imu;
  std::vector<TrackFrameSet> frames;
};

Recording Make(double speed_px, double rate_step, double vibration) {
  Recording r;
  Random random(1);
  for (int i = 0; i <= 400; ++i) {
    ImuSample s;
    s.timestamp = i * 5'000'000LL;
    for (int k = 0; k < 3; ++k) {
      s.omega_m[k] = vibration * 0.1 * random.Normal() + (i > 250 ? rate_step : 0.0);
      s.a_m[k] = vibration * random.Normal() + (k == 2 ? 9.81 : 0.0);
    }
    r.imu.Add(s);
  }
  for (int f = 0; f < 40; ++f) {
    TrackFrame frame{f * 50'000'000LL, 0, {}};
    for (std::uint64_t id = 1; id <= 40; ++id) {
      frame.observations.push_back({id,
                                    static_cast<float>(10.0 * static_cast<double>(id) +
                                                       speed_px * f + 0.1 * random.Normal()),
                                    static_cast<float>(100.0 + 0.1 * random.Normal())});
    }
    r.frames.push_back({frame.timestamp, {frame}});
  }
  return r;
}

int CountAtRest(const Recording& r, const StandstillOptions& options) {
  StandstillDetector detector(options);
  int count = 0;
  for (const TrackFrameSet& f : r.frames) count += detector.Update(f, f.timestamp, r.imu) ? 1 : 0;
  return count;
}

TEST(StandstillDetector, KnowsRestUnderVibrationFromMotion) {
  // Half a second is ten frames; all later ones are at rest.
  EXPECT_GE(CountAtRest(Make(0.0, 0.0, 1.0), {}), 28);
  EXPECT_EQ(CountAtRest(Make(0.5, 0.0, 1.0), {}), 0);  // 2.5 px between the halves
  // The image stands, the gyro's mean changes: not at rest while the window spans the change.
  EXPECT_LT(CountAtRest(Make(0.0, 0.5, 1.0), {}), CountAtRest(Make(0.0, 0.0, 1.0), {}));
  StandstillOptions off;
  off.enabled = false;
  EXPECT_EQ(CountAtRest(Make(0.0, 0.0, 1.0), off), 0);
}

TEST(StandstillResidual, JacobiansHoldAtRestAndYawStaysFree) {
  NavState i;
  i.R_GB = ExpQuaternion({0.3, -0.2, 0.9});
  NavState j = i;
  j.R_GB = BoxPlus(i.R_GB, Eigen::Vector3d(1e-4, -2e-4, 1e-4));
  j.v_GB = {0.01, 0.02, -0.01};
  const StandstillResidual s = EvaluateStandstill(i, j, {});
  const Eigen::MatrixXd N = test::NumericJacobian(
      [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        return -EvaluateStandstill(BoxPlus(i, Vector9d(x.head<9>())),
                                   BoxPlus(j, Vector9d(x.tail<9>())), {})
                    .r;
      },
      Eigen::VectorXd::Zero(18));
  // Linearized at no rotation: right to the size of the residual rotation, 2.5e-4 rad / 2.
  EXPECT_LT((N.leftCols<9>() - s.J_i).cwiseAbs().maxCoeff(), 2e-4);
  EXPECT_LT((N.rightCols<9>() - s.J_j).cwiseAbs().maxCoeff(), 2e-4);
  // A turn of the world about gravity: theta = z for both, and v turns with it; the position does
  // not enter.
  Vector9d yaw_i = Vector9d::Zero();
  yaw_i[2] = 1.0;
  Vector9d yaw_j = yaw_i;
  yaw_j.tail<3>() = Eigen::Vector3d::UnitZ().cross(j.v_GB);
  EXPECT_LT((s.J_i * yaw_i + s.J_j * yaw_j).norm(), 1e-16);
}

}  // namespace
}  // namespace duet
