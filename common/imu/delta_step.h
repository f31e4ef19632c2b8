#pragma once

#include <Eigen/Core>
#include <array>

#include "common/geometry/so3.h"
#include "common/imu/nav_state.h"

// How the error of an IMU delta goes over one step between two readings: what every way of making
// its Jacobians and covariance shares (IntegrateImu of imu_delta.h; the thesis's trapezoids of
// backends/msckf/trapezoid_delta.h). With e = (theta, s, y) in the frame of the delta's start, the
// effect that came before the step is carried on by the step's exact structure,
//
//   theta_1 = theta_0,   s_1 = s_0 - [ds]x theta_0,   y_1 = y_0 + h s_0 - [dy]x theta_0;
//
// the two ways differ in the effect that the step itself adds, and in its noise.

namespace duet {

/// What one step needs of itself, at its begin, middle and end. Frame: the delta's start.
struct StepGeometry {
  double h_s;
  std::array<Eigen::Matrix3d, 3> R;
  std::array<Eigen::Matrix3d, 3> minus_Ra_hat;  ///< -[R a]x
  Eigen::Vector3d ds;                           ///< s_1 - s_0, m/s
  Eigen::Vector3d dy;                           ///< y_1 - y_0 - h s_0, m
};

/// d(theta, s, y) / d(a constant parameter) over one step that starts from zero.
template <int kColumns>
struct StepEffect {
  Eigen::Matrix<double, 3, kColumns> theta;
  Eigen::Matrix<double, 3, kColumns> s;
  Eigen::Matrix<double, 3, kColumns> y;
};

/// J <- F J + effect on the rows theta, s, y.
template <int kColumns>
void CarryOn(const StepGeometry& step, const StepEffect<kColumns>& effect,
             Eigen::Matrix<double, 9, kColumns>* J) {
  const Eigen::Matrix<double, 3, kColumns> theta = J->template topRows<3>();
  const Eigen::Matrix<double, 3, kColumns> s = J->template middleRows<3>(3);
  J->template bottomRows<3>() += step.h_s * s - Hat(step.dy) * theta + effect.y;
  J->template middleRows<3>(3) += effect.s - Hat(step.ds) * theta;
  J->template topRows<3>() += effect.theta;
}

/// P <- F P F' over (theta, s, y, b_g, b_a) with the step's F (identity plus the few blocks that
/// are not), rows then columns.
inline void PropagateStepCovariance(const StepGeometry& step, const StepEffect<3>& b_g,
                                    const StepEffect<3>& b_a, Matrix15d* P) {
  const Eigen::Matrix3d minus_ds = -Hat(step.ds);
  const Eigen::Matrix3d minus_dy = -Hat(step.dy);
  const auto apply_rows = [&](Matrix15d* M) {
    const Eigen::Matrix<double, 3, 15> theta = M->middleRows<3>(0);
    const Eigen::Matrix<double, 3, 15> s = M->middleRows<3>(3);
    const Eigen::Matrix<double, 3, 15> g = M->middleRows<3>(9);
    const Eigen::Matrix<double, 3, 15> a = M->middleRows<3>(12);
    M->middleRows<3>(0) += b_g.theta * g + b_a.theta * a;
    M->middleRows<3>(3) += minus_ds * theta + b_g.s * g + b_a.s * a;
    M->middleRows<3>(6) += minus_dy * theta + step.h_s * s + b_g.y * g + b_a.y * a;
  };
  apply_rows(P);
  P->transposeInPlace();
  apply_rows(P);
}

}  // namespace duet
