#include "common/geometry/se3.h"

#include <gtest/gtest.h>

#include "test/common/geometry/rotation_vectors.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

Eigen::Matrix4d Matrix(const Pose& T) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = T.R.toRotationMatrix();
  M.topRightCorner<3, 1>() = T.p;
  return M;
}

Pose RandomPose(Random* random) {
  return {ExpQuaternion(RandomVector(random)), RandomVector(random)};
}

Vector6d Stack(const Eigen::Vector3d& theta, const Eigen::Vector3d& rho) {
  Vector6d v;
  v << theta, rho;
  return v;
}

TEST(Se3, PosesActComposeAndInvertAsMatrices) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Pose T_AB = RandomPose(&random);
    const Pose T_BC = RandomPose(&random);
    const Eigen::Vector3d x = RandomVector(&random);
    // A few roundings on numbers up to about 5.
    EXPECT_LT((T_AB * x - (Matrix(T_AB) * x.homogeneous()).head<3>()).norm(), 1e-14);
    EXPECT_LT((Matrix(T_AB * T_BC) - Matrix(T_AB) * Matrix(T_BC)).norm(), 1e-14);
    EXPECT_LT((Matrix(T_AB.Inverse()) - Matrix(T_AB).inverse()).norm(), 1e-14);
  }
}

TEST(Se3, ExpIsTheMatrixExponential) {
  Random random(2);
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const Eigen::Vector3d rho = RandomVector(&random);
    Eigen::Matrix4d twist = Eigen::Matrix4d::Zero();
    twist.topLeftCorner<3, 3>() = Hat(theta);
    twist.topRightCorner<3, 1>() = rho;
    Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d sum = term;
    for (int n = 1; n < 40; ++n) {
      term = term * twist / n;
      sum += term;
    }
    EXPECT_LT((Matrix(ExpSe3(Stack(theta, rho))) - sum).norm(), 5e-14) << theta.transpose();
  }
}

TEST(Se3, LogOfExpIsTheVector) {
  Random random(3);
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const Vector6d x = Stack(theta, RandomVector(&random));
    EXPECT_LT((LogSe3(ExpSe3(x)) - x).norm(), 2e-14) << theta.transpose();
  }
}

TEST(Se3, LeftJacobianIsTheDerivative) {
  Random random(4);
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const Vector6d x = Stack(theta, RandomVector(&random));
    const Pose inverse = ExpSe3(x).Inverse();
    const Matrix6d numeric = test::NumericJacobian(
        [&](const Vector6d& y) { return LogSe3(ExpSe3(y) * inverse); }, x, 1e-2);
    // NumericJacobian's 1e-13, with translations up to 3.
    EXPECT_LT((LeftJacobianSe3(x) - numeric).norm(), 3e-12) << theta.transpose();
  }
}

TEST(Se3, LeftJacobianEqualsItsSeries) {
  // sum of ad(x)^n / (n + 1)!, exact to rounding.
  Random random(5);
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const Vector6d x = Stack(theta, RandomVector(&random));
    Matrix6d ad = Matrix6d::Zero();
    ad.topLeftCorner<3, 3>() = Hat(theta);
    ad.bottomLeftCorner<3, 3>() = Hat(x.tail<3>());
    ad.bottomRightCorner<3, 3>() = Hat(theta);
    Matrix6d term = Matrix6d::Identity();
    Matrix6d sum = term;
    for (int n = 1; n < 40; ++n) {
      term = term * ad / (n + 1.0);
      sum += term;
    }
    EXPECT_LT((LeftJacobianSe3(x) - sum).norm(), 5e-14) << theta.transpose();
  }
}

}  // namespace
}  // namespace duet
