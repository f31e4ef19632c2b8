#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/geometry/se3.h"
#include "common/imu/imu_model.h"
#include "common/support/timestamp.h"

namespace duet {

/// Orientation, position [m] and velocity [m/s] of B in G at one instant. Error (9): theta (global,
/// rad), p, v.
struct NavState {
  Eigen::Quaterniond R_GB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_GB = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_GB = Eigen::Vector3d::Zero();

  [[nodiscard]] Pose pose() const { return {R_GB, p_GB}; }
};

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Vector15d = Eigen::Matrix<double, 15, 1>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;

/// x (+) error and a (-) b in the order theta, p, v.
[[nodiscard]] NavState BoxPlus(const NavState& x, const Vector9d& error);
[[nodiscard]] Vector9d BoxMinus(const NavState& a, const NavState& b);

/// A navigation state with the biases, at its instant s_i. Error (15): theta, p, v, b_g, b_a.
struct InertialState {
  Timestamp instant = 0;
  NavState nav;
  ImuBiases biases;
};

[[nodiscard]] InertialState BoxPlus(const InertialState& x, const Vector15d& error);
[[nodiscard]] Vector15d BoxMinus(const InertialState& a, const InertialState& b);

}  // namespace duet
