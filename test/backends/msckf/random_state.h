#pragma once

#include "backends/msckf/filter_state.h"
#include "common/imu/imu_buffer.h"
#include "common/measurement/measurement_model.h"
#include "common/support/random.h"

namespace duet::test {

inline const Eigen::Vector3d kGravity(0, 0, -9.81);

/// Independent standard normal numbers.
template <class Matrix>
Matrix Normal(Random* random, Eigen::Index rows, Eigen::Index cols) {
  return Matrix::NullaryExpr(rows, cols,
                             [random](Eigen::Index, Eigen::Index) { return random->Normal(); });
}

[[nodiscard]] Eigen::Vector3d RandomVector(Random* random, double sigma);
/// A symmetric positive definite matrix with eigenvalues about 1.
[[nodiscard]] Eigen::MatrixXd RandomCovariance(Random* random, int size);

/// A moving body's IMU over [0, 2 s] at 200 Hz.
[[nodiscard]] ImuBuffer MovingImu();

/// Two cameras side by side, one of each distortion model, T matrices off the identity.
[[nodiscard]] RigCalibration StereoRig();

/// A body moving sideways in front of a point cloud about 4 m ahead: `clones` clones at 50 ms, each
/// off its first estimate by about 1 cm and 0.5 degrees, with a random covariance.
[[nodiscard]] FilterState RandomState(Random* random, const RigCalibration& rig,
                                      const CalibrationPriors& priors, int clones);

/// A landmark ahead of the body, in the frame of the anchor clone.
[[nodiscard]] InverseDepth RandomLandmark(Random* random);

}  // namespace duet::test
