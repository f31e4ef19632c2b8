#include "common/geometry/rotation_manifold.h"

#include <gtest/gtest.h>

#include "common/geometry/so3.h"
#include "test/common/geometry/rotation_vectors.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

using Lift = Eigen::Matrix<double, 4, 3, Eigen::RowMajor>;
using Drop = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

Eigen::Vector4d Plus(const Eigen::Vector4d& x, const Eigen::Vector3d& delta) {
  Eigen::Vector4d result;
  EXPECT_TRUE(RotationManifold().Plus(x.data(), delta.data(), result.data()));
  return result;
}

Eigen::Vector3d Minus(const Eigen::Vector4d& y, const Eigen::Vector4d& x) {
  Eigen::Vector3d result;
  EXPECT_TRUE(RotationManifold().Minus(y.data(), x.data(), result.data()));
  return result;
}

Lift PlusJacobian(const Eigen::Vector4d& x) {
  Lift J;
  EXPECT_TRUE(RotationManifold().PlusJacobian(x.data(), J.data()));
  return J;
}

Drop MinusJacobian(const Eigen::Vector4d& x) {
  Drop J;
  EXPECT_TRUE(RotationManifold().MinusJacobian(x.data(), J.data()));
  return J;
}

class RotationManifoldTest : public ::testing::Test {
 protected:
  Eigen::Vector4d RandomRotation() {
    Eigen::Vector4d x;
    for (double& c : x) c = random_.Normal();
    return x.normalized();
  }
  Random random_{1};
};

TEST_F(RotationManifoldTest, IsTheGlobalFullAngleError) {
  const Eigen::Quaterniond R = ExpQuaternion({0.3, -1.0, 0.2});
  const Eigen::Vector3d theta(0.1, 0.2, -0.4);
  EXPECT_EQ(Plus(R.coeffs(), theta), BoxPlus(R, theta).coeffs());
}

TEST_F(RotationManifoldTest, PlusOfZeroIsTheIdentity) {
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector4d x = RandomRotation();
    // One normalization.
    EXPECT_LT((Plus(x, Eigen::Vector3d::Zero()) - x).norm(), 4e-16);
    EXPECT_LT(Minus(x, x).norm(), 4e-16);
  }
}

TEST_F(RotationManifoldTest, MinusUndoesPlus) {
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const Eigen::Vector4d x = RandomRotation();
    EXPECT_LT((Minus(Plus(x, theta), x) - theta).norm(), 4e-15) << theta.transpose();
  }
}

TEST_F(RotationManifoldTest, PlusUndoesMinusSignIncluded) {
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector4d x = RandomRotation();
    const Eigen::Vector4d y = RandomRotation();
    EXPECT_LT((Plus(x, Minus(y, x)) - y).norm(), 4e-15);
  }
  const Eigen::Vector4d x = RandomRotation();
  EXPECT_LT((Plus(x, Minus(-x, x)) + x).norm(), 4e-15) << "a full turn changes the sign";
}

TEST_F(RotationManifoldTest, JacobiansAreTheDerivatives) {
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector4d x = RandomRotation();
    const Eigen::Matrix<double, 4, 3> lift = test::NumericJacobian(
        [&](const Eigen::Vector3d& d) { return Plus(x, d); }, Eigen::Vector3d::Zero(), 1e-2);
    EXPECT_LT((PlusJacobian(x) - lift).norm(), 1e-13);
    // Minus is defined on unit quaternions: its derivative counts along Plus.
    const Eigen::Matrix3d drop =
        test::NumericJacobian([&](const Eigen::Vector3d& d) { return Minus(Plus(x, d), x); },
                              Eigen::Vector3d::Zero(), 1e-2);
    EXPECT_LT((MinusJacobian(x) * lift - drop).norm(), 1e-12);
    // Off the sphere too: Minus does not depend on the length of y.
    const Eigen::Matrix<double, 3, 4> ambient =
        test::NumericJacobian([&](const Eigen::Vector4d& y) { return Minus(y, x); }, x, 1e-3);
    EXPECT_LT((MinusJacobian(x) - ambient).norm(), 1e-12);
  }
}

TEST_F(RotationManifoldTest, JacobiansAreInverseOnTheTangentSpace) {
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector4d x = RandomRotation();
    EXPECT_LT((MinusJacobian(x) * PlusJacobian(x) - Eigen::Matrix3d::Identity()).norm(), 2e-15);
  }
}

TEST_F(RotationManifoldTest, RightMultiplyIsTheProduct) {
  const Eigen::Vector4d x = RandomRotation();
  const Eigen::Matrix<double, 2, 4, Eigen::RowMajor> J =
      Eigen::Matrix<double, 2, 4, Eigen::RowMajor>::Random();
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> product;
  ASSERT_TRUE(
      RotationManifold().RightMultiplyByPlusJacobian(x.data(), 2, J.data(), product.data()));
  EXPECT_LT((product - J * PlusJacobian(x)).norm(), 1e-15);
}

// A cost function's ambient Jacobian is J_tangent * MinusJacobian: Ceres multiplies it by
// PlusJacobian and gets J_tangent back.
TEST_F(RotationManifoldTest, LiftedTangentJacobianIsTheAmbientDerivative) {
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector4d x = RandomRotation();
    const Eigen::Vector3d point = RandomVector(&random_);
    const auto rotate = [&](const Eigen::Vector4d& q) -> Eigen::Vector3d {
      Eigen::Quaterniond R;
      R.coeffs() = q.normalized();
      return R * point;
    };
    const Eigen::Matrix3d J_tangent = -Hat(rotate(x));
    const Eigen::Matrix<double, 3, 4> ambient = test::NumericJacobian(rotate, x, 1e-3);
    // 1e-12 of NumericJacobian, twelve entries, points up to 4 from the origin.
    EXPECT_LT((J_tangent * MinusJacobian(x) - ambient).norm(), 1e-11);
  }
}

}  // namespace
}  // namespace duet
