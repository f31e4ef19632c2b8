#include "frontend/outlier_rejection.h"

#include <gtest/gtest.h>

#include "common/geometry/so3.h"

namespace duet {
namespace {

constexpr double kFocal = 458.0;

struct Problem {
  std::vector<RayPair> pairs;
  std::vector<bool> planted;  // outliers
  Eigen::Matrix3d R_C1C0 = Exp(Eigen::Vector3d(0.02, -0.05, 0.03));
};

// Points in a room seen twice with `noise_px`, the camera moved by t; every fifth pair is moved by
// 4 to 20 px.
Problem Make(const Eigen::Vector3d& t, double noise_px, bool outliers) {
  Problem problem;
  Random random(5);
  for (int i = 0; i < 150; ++i) {
    const Eigen::Vector3d p_C0(random.Uniform(-3, 3), random.Uniform(-2, 2), random.Uniform(2, 8));
    const Eigen::Vector3d p_C1 = problem.R_C1C0 * p_C0 + t;
    RayPair pair{p_C0 / p_C0.z(), p_C1 / p_C1.z()};
    pair.from.head<2>() += noise_px / kFocal * random.NormalVector<2>();
    pair.to.head<2>() += noise_px / kFocal * random.NormalVector<2>();
    const bool outlier = outliers && i % 5 == 0;
    if (outlier) {
      const double angle = random.Uniform(0, 6.28);
      pair.to.head<2>() +=
          random.Uniform(4, 20) / kFocal * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    problem.pairs.push_back(pair);
    problem.planted.push_back(outlier);
  }
  return problem;
}

EpipolarMotion Solve(const Problem& problem, const Eigen::Matrix3d& R, std::vector<bool>* inlier) {
  Random random(1);
  return FindEpipolarMotion(problem.pairs, R,
                            {.iterations = 48, .focal_px = kFocal, .threshold_px = 1.0}, &random,
                            inlier);
}

TEST(OutlierRejectionTest, FindsPlantedOutliersAndKeepsTheRest) {
  const Problem problem = Make({0.15, 0.05, -0.1}, 0.2, true);
  std::vector<bool> inlier;
  const EpipolarMotion motion = Solve(problem, problem.R_C1C0, &inlier);
  EXPECT_TRUE(motion.valid);
  int missed = 0;
  int lost = 0;
  for (std::size_t i = 0; i < inlier.size(); ++i) {
    missed += problem.planted[i] && inlier[i] ? 1 : 0;
    lost += !problem.planted[i] && !inlier[i] ? 1 : 0;
  }
  // An outlier that moved along its epipolar line cannot be seen: within 1.4 px of a line, of 4 to
  // 20 px in any direction, that is about one in seven.
  EXPECT_LE(missed, 8);
  EXPECT_EQ(lost, 0);
}

// What the gyroscope's bias and a wrong time shift do to the told rotation: about 4 px.
TEST(OutlierRejectionTest, CorrectsTheToldRotation) {
  const Problem problem = Make({0.15, 0.05, -0.1}, 0.1, true);
  const Eigen::Vector3d error(0.004, -0.006, 0.005);
  std::vector<bool> inlier;
  const EpipolarMotion motion = Solve(problem, Exp(-error) * problem.R_C1C0, &inlier);
  EXPECT_TRUE(motion.valid);
  // A tenth of what was wrong. 120 residuals of 0.15 px alone would give 5e-5 rad; a turn and a
  // shift to the side look alike, which costs a factor of ten.
  EXPECT_LT((motion.delta - error).norm(), 8e-4);
  EXPECT_LT(motion.t.cross(Eigen::Vector3d(0.15, 0.05, -0.1).normalized()).norm(), 0.02);
  EXPECT_GE(motion.inliers, 118);
}

TEST(OutlierRejectionTest, AtRestNothingIsRefused) {
  const Problem problem = Make(Eigen::Vector3d::Zero(), 0.1, false);
  std::vector<bool> inlier;
  const EpipolarMotion motion = Solve(problem, problem.R_C1C0, &inlier);
  EXPECT_EQ(motion.inliers, 150);
  EXPECT_LT(motion.delta.norm(), 1e-3);
}

TEST(OutlierRejectionTest, WithoutAgreementNothingIsRefused) {
  Random random(3);
  Problem problem;
  for (int i = 0; i < 60; ++i) {
    problem.pairs.push_back({Eigen::Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), 1.0),
                             Eigen::Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), 1.0)});
  }
  std::vector<bool> inlier;
  EXPECT_FALSE(Solve(problem, problem.R_C1C0, &inlier).valid);
  EXPECT_EQ(std::count(inlier.begin(), inlier.end(), true), 60);
  problem.pairs.resize(7);
  EXPECT_FALSE(Solve(problem, problem.R_C1C0, &inlier).valid);
  EXPECT_EQ(inlier.size(), 7U);
}

TEST(OutlierRejectionTest, SameSeedSameBytes) {
  const Problem problem = Make({0.1, 0.0, 0.2}, 0.3, true);
  std::vector<bool> first;
  std::vector<bool> second;
  const EpipolarMotion a = Solve(problem, problem.R_C1C0, &first);
  const EpipolarMotion b = Solve(problem, problem.R_C1C0, &second);
  EXPECT_EQ(a.delta, b.delta);
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace duet
