#include "evaluation/alignment.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/support/input_error.h"
#include "test/evaluation/test_trajectories.h"

namespace duet {
namespace {

std::vector<PosePair> FromPoints(const std::vector<Eigen::Vector3d>& p_true,
                                 const std::vector<Eigen::Vector3d>& p_est) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < p_true.size(); ++i) {
    PosePair pair;
    pair.timestamp = static_cast<Timestamp>(i);
    pair.T_GB_true.p = p_true[i];
    pair.T_EB.p = p_est[i];
    pairs.push_back(pair);
  }
  return pairs;
}

double SumOfSquares(const std::vector<PosePair>& pairs, const Alignment& a) {
  double sum = 0.0;
  for (const PosePair& pair : pairs) {
    sum += (pair.T_GB_true.p - a.Apply(pair.T_EB.p)).squaredNorm();
  }
  return sum;
}

TEST(Alignment, UmeyamaRecoversAKnownTransform) {
  Random random(1);
  const auto truth = Walk(12.0, 10.0);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Quaterniond R = RandomRotation(&random);
    const Eigen::Vector3d p = 10.0 * random.NormalVector<3>();
    const double scale = random.Uniform(0.1, 5.0);
    const auto sim3 = Align(PairUp(Moved(truth, R, p, scale), truth), AlignmentMode::kSim3);
    ASSERT_TRUE(sim3.alignment);
    EXPECT_NEAR(BoxMinus(sim3.alignment->R_GE, R).norm(), 0.0, 1e-12);
    EXPECT_NEAR((sim3.alignment->p_GE - p).norm(), 0.0, 1e-11);
    EXPECT_NEAR(sim3.alignment->scale, scale, 1e-12);
    const auto se3 = Align(PairUp(Moved(truth, R, p), truth), AlignmentMode::kSe3);
    ASSERT_TRUE(se3.alignment);
    EXPECT_NEAR(BoxMinus(se3.alignment->R_GE, R).norm(), 0.0, 1e-12);
    EXPECT_EQ(se3.alignment->scale, 1.0);
  }
}

TEST(Alignment, UmeyamasOwnExample) {
  // The paper's section IV: a triangle and its image whose best orthogonal map is a reflection in
  // the plane. As three-dimensional patterns the turn about x does it exactly, with z = 0 all over;
  // so the planar answer (c = 0.721, error 0.053) must come out where the turn is forbidden, and
  // the exact one where it is allowed.
  const std::vector<Eigen::Vector3d> x = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  const std::vector<Eigen::Vector3d> y = {{0, 0, 0}, {-1, 0, 0}, {0, 2, 0}};
  const auto pairs = FromPoints(y, x);
  const auto se3 = Align(pairs, AlignmentMode::kSe3);
  ASSERT_TRUE(se3.alignment);
  EXPECT_NEAR(SumOfSquares(pairs, *se3.alignment), 0.0, 1e-24);
  EXPECT_NEAR(se3.alignment->R_GE.toRotationMatrix().determinant(), 1.0, 1e-12);
  // In the plane: rotation by yaw alone, R = [0.832 0.555; -0.555 0.832], t = [-0.800, 0.400] with
  // the scale 0.721; the rotation does not depend on the scale.
  const auto yaw = Align(pairs, AlignmentMode::kPositionYaw);
  ASSERT_TRUE(yaw.alignment);
  const Eigen::Matrix3d R = yaw.alignment->R_GE.toRotationMatrix();
  EXPECT_NEAR(R(0, 0), 0.832, 5e-4);
  EXPECT_NEAR(R(0, 1), 0.555, 5e-4);
  EXPECT_NEAR(R(1, 0), -0.555, 5e-4);
}

TEST(Alignment, AMirroredPatternGivesARotationNotAReflection) {
  const auto truth = Walk(12.0, 10.0);
  auto mirrored = truth;
  for (StampedPose& pose : mirrored) pose.T_GB.p.z() *= -1.0;
  const auto pairs = PairUp(truth, mirrored);
  const auto result = Align(pairs, AlignmentMode::kSe3);
  ASSERT_TRUE(result.alignment);
  EXPECT_NEAR(result.alignment->R_GE.toRotationMatrix().determinant(), 1.0, 1e-12);
  // No rotation near or far does better.
  Random random(5);
  const double best = SumOfSquares(pairs, *result.alignment);
  EXPECT_GT(best, 0.1);
  for (int i = 0; i < 200; ++i) {
    Alignment other = *result.alignment;
    const double size = i < 100 ? 0.05 : 3.0;
    other.R_GE = BoxPlus(other.R_GE, size * random.NormalVector<3>());
    other.p_GE += 0.05 * random.NormalVector<3>();
    EXPECT_GE(SumOfSquares(pairs, other), best);
  }
}

/// Each mode gives the least sum of squares of its class: no small step inside it does better.
TEST(Alignment, IsTheMinimumOfItsClass) {
  Random random(7);
  const auto truth = Walk(12.0, 10.0);
  const auto estimate = Moved(WithNoise(truth, 0.1, 0.05, &random), YawRotation(2.0), {1, -2, 3});
  const auto pairs = PairUp(truth, estimate);
  for (const AlignmentMode mode :
       {AlignmentMode::kPositionYaw, AlignmentMode::kSe3, AlignmentMode::kSim3}) {
    const auto result = Align(pairs, mode);
    ASSERT_TRUE(result.alignment);
    const double best = SumOfSquares(pairs, *result.alignment);
    for (int i = 0; i < 100; ++i) {
      Alignment other = *result.alignment;
      Eigen::Vector3d theta = 0.01 * random.NormalVector<3>();
      if (mode == AlignmentMode::kPositionYaw) theta.head<2>().setZero();
      other.R_GE = BoxPlus(other.R_GE, theta);
      other.p_GE += 0.01 * random.NormalVector<3>();
      if (mode == AlignmentMode::kSim3) other.scale *= 1.0 + 0.01 * random.Normal();
      EXPECT_GE(SumOfSquares(pairs, other), best) << AlignmentModeName(mode);
    }
  }
}

TEST(Alignment, PositionYawHoldsTheVertical) {
  Random random(9);
  const auto truth = Walk(12.0, 10.0);
  for (const double yaw : {0.0, 1.0, -3.0, std::numbers::pi}) {
    const Eigen::Vector3d p = random.NormalVector<3>();
    const auto result =
        Align(PairUp(Moved(truth, YawRotation(yaw), p), truth), AlignmentMode::kPositionYaw);
    ASSERT_TRUE(result.alignment);
    EXPECT_NEAR(BoxMinus(result.alignment->R_GE, YawRotation(yaw)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((result.alignment->p_GE - p).norm(), 0.0, 1e-12);
    EXPECT_EQ(result.alignment->R_GE.x(), 0.0);
    EXPECT_EQ(result.alignment->R_GE.y(), 0.0);
  }
}

TEST(Alignment, FirstPoseMakesTheFirstPairAgree) {
  Random random(11);
  const auto truth = Walk(3.0, 10.0);
  const auto estimate = Moved(truth, RandomRotation(&random), random.NormalVector<3>());
  const auto result = Align(PairUp(truth, estimate), AlignmentMode::kFirstPose);
  ASSERT_TRUE(result.alignment);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR((result.alignment->Apply(estimate[i].T_GB.p) - truth[i].T_GB.p).norm(), 0, 1e-12);
  }
}

TEST(Alignment, DegenerateInputIsRefusedWithItsReason) {
  const auto refusal = [](const std::vector<PosePair>& pairs, AlignmentMode mode) {
    const AlignmentResult result = Align(pairs, mode);
    EXPECT_EQ(result.alignment.has_value(), result.refusal == AlignmentRefusal::kNone);
    return result.refusal;
  };
  const std::vector<Eigen::Vector3d> spread = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<Eigen::Vector3d> still = {{5, 5, 5}, {5.001, 5, 5}, {5, 5.001, 5}, {5, 5, 5}};
  const std::vector<Eigen::Vector3d> one = {{3, 3, 3}, {3, 3, 3}, {3, 3, 3}, {3, 3, 3}};
  const std::vector<Eigen::Vector3d> line = {{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {4, 8, 12}};
  const std::vector<Eigen::Vector3d> vertical = {{1, 1, 0}, {1, 1, 1}, {1, 1, 2}, {1, 1, 5}};
  for (const AlignmentMode mode :
       {AlignmentMode::kPositionYaw, AlignmentMode::kSe3, AlignmentMode::kSim3}) {
    EXPECT_EQ(refusal({}, mode), AlignmentRefusal::kNoPairs);
    EXPECT_EQ(refusal(FromPoints({spread[0], spread[1]}, {spread[0], spread[1]}), mode),
              AlignmentRefusal::kTooFewPoses);
    EXPECT_EQ(refusal(FromPoints(still, spread), mode), AlignmentRefusal::kCoincidentTruth);
    EXPECT_EQ(refusal(FromPoints(spread, one), mode), AlignmentRefusal::kCoincidentEstimate);
    EXPECT_EQ(refusal(FromPoints(vertical, vertical), mode),
              AlignmentRefusal::kRotationUndetermined);
    EXPECT_EQ(refusal(FromPoints(spread, spread), mode), AlignmentRefusal::kNone);
  }
  // A slanted line determines a yaw, but no rotation about itself.
  EXPECT_EQ(refusal(FromPoints(line, line), AlignmentMode::kPositionYaw), AlignmentRefusal::kNone);
  EXPECT_EQ(refusal(FromPoints(line, line), AlignmentMode::kSe3),
            AlignmentRefusal::kRotationUndetermined);
  // Nothing is fitted: nothing to refuse.
  EXPECT_EQ(refusal(FromPoints(still, still), AlignmentMode::kNone), AlignmentRefusal::kNone);
  EXPECT_EQ(refusal(FromPoints(still, still), AlignmentMode::kFirstPose), AlignmentRefusal::kNone);
}

TEST(Alignment, AMirrorImageThatTwoRotationsFitEquallyIsRefused) {
  // The octahedron's corners against their mirror image: every half turn about an axis in the
  // mirror is as good as another.
  const std::vector<Eigen::Vector3d> p = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                          {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  std::vector<Eigen::Vector3d> mirrored = p;
  for (Eigen::Vector3d& point : mirrored) point.z() *= -1.0;
  EXPECT_EQ(Align(FromPoints(p, mirrored), AlignmentMode::kSe3).refusal,
            AlignmentRefusal::kRotationUndetermined);
}

TEST(Alignment, OrientationFitsRecoverWhatWasApplied) {
  Random random(13);
  const auto truth = Walk(12.0, 10.0);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Quaterniond yaw = YawRotation(random.Uniform(-3.14, 3.14));
    const Eigen::Quaterniond any = RandomRotation(&random);
    const auto of_yaw = FitYawToOrientations(PairUp(Moved(truth, yaw, {1, 2, 3}), truth));
    const auto of_any = FitRotationToOrientations(PairUp(Moved(truth, any, {1, 2, 3}), truth));
    ASSERT_TRUE(of_yaw && of_any);
    EXPECT_NEAR(BoxMinus(*of_yaw, yaw).norm(), 0.0, 1e-12);
    EXPECT_NEAR(BoxMinus(*of_any, any).norm(), 0.0, 1e-12);
  }
}

TEST(Alignment, OrientationFitsDoNotWrap) {
  // Yaw errors on both sides of half a turn: their mean is half a turn, not zero.
  std::vector<PosePair> pairs(2);
  pairs[0].T_GB_true.R = YawRotation(std::numbers::pi - 0.1);
  pairs[1].T_GB_true.R = YawRotation(-std::numbers::pi + 0.1);
  const auto fit = FitYawToOrientations(pairs);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(BoxMinus(*fit, YawRotation(std::numbers::pi)).norm(), 0.0, 1e-12);
}

TEST(Alignment, OrientationFitsThatAreNotDeterminedAreRefused) {
  EXPECT_FALSE(FitYawToOrientations({}));
  EXPECT_FALSE(FitRotationToOrientations({}));
  std::vector<PosePair> opposite(2);
  opposite[1].T_GB_true.R = YawRotation(std::numbers::pi);
  EXPECT_FALSE(FitYawToOrientations(opposite));
}

TEST(Alignment, YawAndTiltOfARotation) {
  EXPECT_NEAR(YawOf(YawRotation(0.7)), 0.7, 1e-15);
  EXPECT_NEAR(YawOf(YawRotation(-3.0)), -3.0, 1e-15);
  Eigen::Quaterniond negative = YawRotation(0.7);
  negative.coeffs() *= -1.0;
  EXPECT_NEAR(YawOf(negative), 0.7, 1e-15);
  const Eigen::Quaterniond tipped = ExpQuaternion({0.03, -0.04, 0.0});
  EXPECT_NEAR(TiltOf(tipped), 0.05, 1e-15);
  EXPECT_NEAR(TiltOf(YawRotation(1.0) * tipped * YawRotation(-2.5)), 0.05, 1e-15);
  EXPECT_NEAR(TiltOf(ExpQuaternion({std::numbers::pi, 0, 0})), std::numbers::pi, 1e-15);
  EXPECT_NEAR(TiltOf(ExpQuaternion({1e-9, 0, 0})), 1e-9, 1e-20);  // no loss by an arc cosine
}

TEST(Alignment, NamesAreReadBack) {
  for (const char* name : {"none", "first", "posyaw", "se3", "sim3"}) {
    EXPECT_STREQ(AlignmentModeName(ParseAlignmentMode(name)), name);
  }
  EXPECT_THROW((void)ParseAlignmentMode("se2"), InputError);
}

}  // namespace
}  // namespace duet
