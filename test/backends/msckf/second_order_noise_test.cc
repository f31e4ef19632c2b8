#include "backends/msckf/second_order_noise.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "test/backends/msckf/random_state.h"

namespace duet {
namespace {

constexpr int kPixelRows = 12;
constexpr int kStateSize = 10;

using test::Normal;

/// A landmark whose Jacobians are linear in its inverse depth.
struct UncertainLandmark {
  explicit UncertainLandmark(std::uint64_t seed) : random(seed) {
    H_f = 5.0 * Normal<LandmarkRows>(&random, kPixelRows, 3);
    at_infinity = Normal<MeasurementRows>(&random, kPixelRows, kStateSize);
    D = Normal<MeasurementRows>(&random, kPixelRows, kStateSize);
    P = test::RandomCovariance(&random, kStateSize);
    H = at_infinity + rho * D;
  }

  Random random;
  double rho = 0.2;
  LandmarkRows H_f;
  MeasurementRows at_infinity;
  MeasurementRows D;
  MeasurementRows H;
  Eigen::MatrixXd P;
};

// Against what it stands for, the product of the two errors, drawn.
TEST(SecondOrderNoise, IsTheCovarianceOfWhatLinearizingLeavesOut) {
  constexpr int kAlike = 7;
  constexpr int kDraws = 200'000;
  UncertainLandmark landmark(3);
  landmark.P *= 0.01;  // of the inverse depth, then, less than is unknown
  SecondOrderNoise noise;
  noise.SetDepth(landmark.H, landmark.H_f, landmark.P);
  ASSERT_LT(noise.variance(), 1.0);
  ASSERT_TRUE(
      noise.SetDerivative(landmark.H, landmark.at_infinity, landmark.rho, landmark.P, kAlike));
  const Eigen::MatrixXd L = noise.factor().triangularView<Eigen::Lower>();
  const Eigen::MatrixXd of_s =
      (L * L.transpose() - Eigen::MatrixXd::Identity(kPixelRows, kPixelRows)) / kAlike;

  const Eigen::Matrix<double, 3, kPixelRows> least_squares =
      (landmark.H_f.transpose() * landmark.H_f).inverse() * landmark.H_f.transpose();
  const Eigen::MatrixXd L_P = landmark.P.llt().matrixL();
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(kPixelRows);
  Eigen::MatrixXd second_moment = Eigen::MatrixXd::Zero(kPixelRows, kPixelRows);
  double depth_moment = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd x = L_P * Normal<Eigen::VectorXd>(&landmark.random, kStateSize, 1);
    const Eigen::VectorXd n = Normal<Eigen::VectorXd>(&landmark.random, kPixelRows, 1);
    const double f_rho = -(least_squares * (landmark.H * x + n)).z();
    const Eigen::VectorXd s = landmark.D * x * f_rho;
    mean += s / kDraws;
    second_moment += s * s.transpose() / kDraws;
    depth_moment += f_rho * f_rho / kDraws;
  }
  const Eigen::MatrixXd drawn = second_moment - mean * mean.transpose();
  EXPECT_NEAR(noise.variance(), depth_moment, 0.02 * depth_moment);
  EXPECT_LT((drawn - of_s).norm(), 0.03 * of_s.norm());
}

// Errors of poses and pixels a tenth: beside the pixels', the noise is a hundredth, and soon not
// worth its cost.
TEST(SecondOrderNoise, FallsWithTheSquareOfTheErrors) {
  UncertainLandmark landmark(5);
  landmark.P *= 1e-3;
  const auto size = [&] {
    SecondOrderNoise noise;
    noise.SetDepth(landmark.H, landmark.H_f, landmark.P);
    EXPECT_TRUE(
        noise.SetDerivative(landmark.H, landmark.at_infinity, landmark.rho, landmark.P, 1'000'000));
    const Eigen::MatrixXd L = noise.factor().triangularView<Eigen::Lower>();
    return (L * L.transpose() - Eigen::MatrixXd::Identity(kPixelRows, kPixelRows)).norm();
  };
  const double before = size();
  landmark.P *= 1e-2;
  landmark.H *= 10.0;
  landmark.at_infinity *= 10.0;
  landmark.H_f *= 10.0;
  EXPECT_NEAR(size(), 1e-2 * before, 1e-8 * before);
  SecondOrderNoise noise;
  noise.SetDepth(landmark.H, landmark.H_f, landmark.P);
  EXPECT_FALSE(noise.Matters(landmark.rho, 30));
  EXPECT_TRUE(noise.Matters(1e-3 * landmark.rho, 30));
  EXPECT_TRUE(noise.Matters(0.0, 1));
}

}  // namespace
}  // namespace duet
