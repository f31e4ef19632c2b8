#include "common/geometry/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "test/common/geometry/rotation_vectors.h"
#include "test/numeric_jacobian.h"

namespace duet {
namespace {

// A handful of roundings on numbers of size 1.
constexpr double kRounding = 4e-15;

TEST(So3, HatIsTheCrossProduct) {
  const Eigen::Vector3d v(1.0, 2.0, 3.0), w(-2.0, 0.5, 4.0);
  EXPECT_EQ(Hat(v) * w, v.cross(w));
}

TEST(So3, ExpTurnsByTheAngleAboutTheAxis) {
  const Eigen::Matrix3d R = Exp({0.0, 0.0, std::numbers::pi / 6.0});
  const double c = std::sqrt(3.0) / 2.0;
  Eigen::Matrix3d expected;
  expected << c, -0.5, 0.0, 0.5, c, 0.0, 0.0, 0.0, 1.0;
  EXPECT_LT((R - expected).norm(), kRounding);
}

TEST(So3, ExpAgreesWithAngleAxis) {
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const double angle = theta.stableNorm();
    if (angle == 0.0) continue;
    const Eigen::AngleAxisd angle_axis(angle, theta / angle);
    EXPECT_LT((Exp(theta) - angle_axis.toRotationMatrix()).norm(), kRounding) << theta.transpose();
    EXPECT_LT(std::abs(ExpQuaternion(theta).norm() - 1.0), kRounding);
  }
}

TEST(So3, LogOfExpIsTheVector) {
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    // Relative: a tiny angle keeps its digits. The quaternion does so up to pi.
    EXPECT_LE((Log(ExpQuaternion(theta)) - theta).stableNorm(), 1e-15 * 4 * theta.stableNorm())
        << theta.transpose();
    Eigen::Quaterniond negative = ExpQuaternion(theta);
    negative.coeffs() *= -1.0;
    EXPECT_EQ(Log(negative), Log(ExpQuaternion(theta)));
    // The matrix of a rotation has the axis of an angle near pi in products only.
    EXPECT_LE((Log(Exp(theta)) - theta).stableNorm(), 1e-14 * std::max(theta.stableNorm(), 1e-150))
        << theta.transpose();
  }
}

TEST(So3, LogIsTheShortestAndKnowsWholeTurns) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  const double pi = std::numbers::pi;
  for (const double angle : {-7.0 * pi + 0.3, -4.0, 4.0, 2.0 * pi + 1e-3, 30.0}) {
    const Eigen::Vector3d theta = Log(ExpQuaternion(angle * axis));
    EXPECT_LE(theta.norm(), pi);
    // sin(angle / 2) of an argument of 30 is known to 30 eps.
    EXPECT_LT((theta - std::remainder(angle, 2.0 * pi) * axis).norm(), 1e-14);
  }
  // Exactly half a turn: one vector for both signs.
  const Eigen::Quaterniond half(0.0, 0.6, -0.8, 0.0), negative(-0.0, -0.6, 0.8, 0.0);
  EXPECT_NEAR(Log(half).norm(), pi, kRounding);
  EXPECT_EQ(Log(half), Log(negative));
}

TEST(So3, LogDoesNotNeedAUnitQuaternion) {
  const Eigen::Vector3d theta(0.3, -0.2, 1.0);
  Eigen::Quaterniond q = ExpQuaternion(theta);
  q.coeffs() *= 3.7;
  EXPECT_LT((Log(q) - theta).norm(), kRounding);
}

// exp(theta)'s derivative by theta, in the tangent space on the left: numeric.
Eigen::Matrix3d NumericLeftJacobian(const Eigen::Vector3d& theta) {
  const Eigen::Quaterniond R = ExpQuaternion(theta);
  return test::NumericJacobian(
      [&](const Eigen::Vector3d& x) { return BoxMinus(ExpQuaternion(x), R); }, theta, 1e-2);
}

TEST(So3, LeftJacobianIsTheDerivative) {
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    // 1e-13: what NumericJacobian promises, with some room for the norm of nine entries.
    EXPECT_LT((LeftJacobian(theta) - NumericLeftJacobian(theta)).norm(), 5e-13)
        << theta.transpose();
  }
}

TEST(So3, LeftJacobianEqualsItsSeries) {
  // sum of [theta]x^n / (n + 1)!: independent of the closed form and exact to rounding.
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    Eigen::Matrix3d term = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d sum = term;
    for (int n = 1; n < 40; ++n) {
      term = term * Hat(theta) / (n + 1.0);
      sum += term;
    }
    EXPECT_LT((LeftJacobian(theta) - sum).norm(), 1e-14) << theta.transpose();
  }
}

TEST(So3, JacobianInversesAreInverse) {
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    EXPECT_LT(
        (LeftJacobian(theta) * LeftJacobianInverse(theta) - Eigen::Matrix3d::Identity()).norm(),
        2e-14)
        << theta.transpose();
    EXPECT_LT(
        (RightJacobian(theta) * RightJacobianInverse(theta) - Eigen::Matrix3d::Identity()).norm(),
        2e-14)
        << theta.transpose();
  }
}

TEST(So3, LeftAndRightJacobiansAreRelated) {
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    EXPECT_EQ(RightJacobian(theta), LeftJacobian(-theta));
    EXPECT_EQ(RightJacobianInverse(theta), LeftJacobianInverse(-theta));
    EXPECT_LT((LeftJacobian(theta) - Exp(theta) * RightJacobian(theta)).norm(), 1e-14);
    // Both leave the axis alone.
    EXPECT_LT((LeftJacobian(theta) * theta - theta).stableNorm(),
              kRounding * theta.stableNorm() + 1e-300);
  }
}

TEST(So3, RightJacobianIsTheDerivativeOnTheRight) {
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const Eigen::Quaterniond R = ExpQuaternion(theta);
    const Eigen::Matrix3d numeric = test::NumericJacobian(
        [&](const Eigen::Vector3d& x) { return Log(R.conjugate() * ExpQuaternion(x)); }, theta,
        1e-2);
    EXPECT_LT((RightJacobian(theta) - numeric).norm(), 5e-13) << theta.transpose();
  }
}

TEST(So3, BoxMinusUndoesBoxPlus) {
  Random random(3);
  for (const Eigen::Vector3d& theta : HardRotationVectors()) {
    const Eigen::Quaterniond R = ExpQuaternion(RandomVector(&random));
    EXPECT_LT((BoxMinus(BoxPlus(R, theta), R) - theta).norm(), kRounding) << theta.transpose();
    // Global: the vector is in the frame on the left.
    EXPECT_LT((BoxPlus(R, theta).toRotationMatrix() - Exp(theta) * R.toRotationMatrix()).norm(),
              kRounding);
  }
}

TEST(So3, NearestRotationProjects) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d R = Exp(RandomVector(&random));
    EXPECT_LT((NearestRotation(R) - R).norm(), kRounding);
    Eigen::Matrix3d M = R;
    for (double& m : M.reshaped()) m += 0.2 * random.Normal();
    const Eigen::Matrix3d nearest = NearestRotation(M);
    // Two Jacobi factors multiplied: a few more roundings.
    EXPECT_LT((nearest * nearest.transpose() - Eigen::Matrix3d::Identity()).norm(), 2e-14);
    EXPECT_NEAR(nearest.determinant(), 1.0, 2e-14);
    // No rotation a little away is nearer.
    for (int k = 0; k < 20; ++k) {
      EXPECT_LE((nearest - M).norm(), (Exp(1e-3 * RandomVector(&random)) * nearest - M).norm());
    }
  }
  EXPECT_LT(
      (NearestRotation(Eigen::Vector3d(1.0, 2.0, -0.1).asDiagonal()) - Eigen::Matrix3d::Identity())
          .norm(),
      kRounding);
}

// The thesis's quaternions (appendix A), written from its equations: (x, y, z, w), JPL.
Eigen::Vector4d JplProduct(const Eigen::Vector4d& q, const Eigen::Vector4d& p) {  // A.6
  return {q[3] * p[0] + q[2] * p[1] - q[1] * p[2] + q[0] * p[3],
          -q[2] * p[0] + q[3] * p[1] + q[0] * p[2] + q[1] * p[3],
          q[1] * p[0] - q[0] * p[1] + q[3] * p[2] + q[2] * p[3],
          -q[0] * p[0] - q[1] * p[1] - q[2] * p[2] + q[3] * p[3]};
}

Eigen::Matrix3d JplMatrix(const Eigen::Vector4d& q) {  // A.7
  const Eigen::Vector4d s = q.cwiseAbs2();
  Eigen::Matrix3d C;
  C << s[0] - s[1] - s[2] + s[3], 2 * (q[0] * q[1] + q[2] * q[3]), 2 * (q[0] * q[2] - q[1] * q[3]),
      2 * (q[0] * q[1] - q[2] * q[3]), -s[0] + s[1] - s[2] + s[3], 2 * (q[1] * q[2] + q[0] * q[3]),
      2 * (q[0] * q[2] + q[1] * q[3]), 2 * (q[1] * q[2] - q[0] * q[3]), -s[0] - s[1] + s[2] + s[3];
  return C;
}

TEST(So3, TheThesissQuaternionHasTheSameNumbers) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond R_GB = ExpQuaternion(RandomVector(&random));
    // coeffs() is x, y, z, w. C takes a vector from G to B.
    EXPECT_LT((JplMatrix(R_GB.coeffs()) - R_GB.toRotationMatrix().transpose()).norm(), kRounding);
    // JPL's product is Hamilton's in the other order: C_BG = C_BA C_AG there, R_GB = R_GA R_AB
    // here.
    const Eigen::Quaterniond R_GA = ExpQuaternion(RandomVector(&random));
    const Eigen::Quaterniond R_AB = R_GA.conjugate() * R_GB;
    EXPECT_LT((JplProduct(R_AB.coeffs(), R_GA.coeffs()) - (R_GA * R_AB).coeffs()).norm(),
              kRounding);
  }
}

TEST(So3, TheThesissUpdateIsTheGlobalError) {
  // 6.35: q_hat (x) (theta / 2, 1), normalized, equals Exp(theta) R_GB up to third order in theta.
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond R_GB = ExpQuaternion(RandomVector(&random));
    const Eigen::Vector3d theta = 1e-3 * RandomVector(&random);
    Eigen::Vector4d delta;
    delta << 0.5 * theta, 1.0;
    Eigen::Quaterniond updated;
    updated.coeffs() = JplProduct(R_GB.coeffs(), delta).normalized();
    // atan(x) against x: |theta|^3 / 12.
    const double third_order = std::pow(theta.norm(), 3) / 12.0;
    EXPECT_LT(BoxMinus(updated, BoxPlus(R_GB, theta)).norm(), 1.1 * third_order + kRounding);
  }
}

}  // namespace
}  // namespace duet
