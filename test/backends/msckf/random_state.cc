#include "test/backends/msckf/random_state.h"

#include "common/geometry/so3.h"

namespace duet::test {

Eigen::Vector3d RandomVector(Random* random, double sigma) {
  const double x = sigma * random->Normal();
  const double y = sigma * random->Normal();
  const double z = sigma * random->Normal();
  return {x, y, z};
}

Eigen::MatrixXd RandomCovariance(Random* random, int size) {
  Eigen::MatrixXd A(size, size);
  for (Eigen::Index i = 0; i < A.size(); ++i) A(i) = random->Normal();
  const Eigen::MatrixXd P = A * A.transpose() / size + 0.1 * Eigen::MatrixXd::Identity(size, size);
  return 0.5 * (P + P.transpose());
}

ImuBuffer MovingImu() {
  ImuBuffer buffer;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.005 * i;
    buffer.Add({ToNanoseconds(t), Eigen::Vector3d(std::sin(3 * t), 0.6 * std::cos(2 * t), 0.4),
                Eigen::Vector3d(2 * std::cos(t), 1.0, 9.8 + std::sin(4 * t))});
  }
  return buffer;
}

RigCalibration StereoRig() {
  RigCalibration rig;
  CameraModel::Parameters radtan(9);
  radtan << 458.6, 457.3, 367.2, 248.4, -0.283, 0.0739, 1.9e-4, 1.8e-5, 0.002;
  CameraModel::Parameters equidistant(8);
  equidistant << 450.1, 449.2, 370.0, 240.0, -0.01, 0.02, -0.01, 0.003;
  rig.cameras.push_back({CameraModel(DistortionModel::kRadialTangential, 752, 480, radtan),
                         ExpQuaternion(Eigen::Vector3d(0.02, -0.03, 0.01)),
                         Eigen::Vector3d(0.06, -0.02, 0.01)});
  rig.cameras.push_back({CameraModel(DistortionModel::kEquidistant, 752, 480, equidistant),
                         ExpQuaternion(Eigen::Vector3d(0.01, 0.02, -0.02)),
                         Eigen::Vector3d(-0.05, -0.02, 0.015)});
  rig.imu.T_g(0, 1) = 0.02;
  rig.imu.T_s(1, 2) = 1e-3;
  rig.imu.T_a(2, 2) = 1.01;
  return rig;
}

FilterState RandomState(Random* random, const RigCalibration& rig, const CalibrationPriors& priors,
                        int clones) {
  const ImuBuffer imu = MovingImu();
  FilterState state(rig, priors, clones);
  InitialCondition initial;
  initial.state.instant = ToNanoseconds(0.5);
  initial.state.nav.p_GB = RandomVector(random, 5.0);
  initial.state.biases.b_g = RandomVector(random, 0.01);
  state.Start(initial);
  const Eigen::Quaterniond R_0 = ExpQuaternion(RandomVector(random, 0.05));
  for (int i = 0; i < clones; ++i) {
    const double t = 0.05 * i;
    NavState nav;
    nav.v_GB = Eigen::Vector3d(1.5, 0.3 * std::cos(4 * t), 0.2);
    nav.p_GB = initial.state.nav.p_GB + t * nav.v_GB + RandomVector(random, 0.02);
    nav.R_GB = ExpQuaternion(RandomVector(random, 0.03)) * R_0;
    state.SetPropagated(nav, initial.state.instant + ToNanoseconds(t));
    state.Augment(rig.t_d_s);
    Vector9d moved;
    moved << RandomVector(random, 0.01), RandomVector(random, 0.01), RandomVector(random, 0.05);
    Clone& clone = state.clones().back();
    clone.nav = BoxPlus(clone.nav_fej, moved);
    clone.rates.Assign(imu, clone.instant, 0.03, initial.state.biases, rig.imu);
  }
  state.P() = RandomCovariance(random, state.size());
  return state;
}

InverseDepth RandomLandmark(Random* random) {
  return {random->Uniform(-0.3, 0.3), random->Uniform(-0.2, 0.2), random->Uniform(0.2, 0.35)};
}

}  // namespace duet::test
