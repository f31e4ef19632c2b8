#pragma once

#include <Eigen/Geometry>
#include <string>

#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"

namespace duet {

/// The body's axes are a choice: for any rotation Q, x_B' = Q x_B with
///
///   R_GB' = R_GB Q',  R_CB' = R_CB Q',  T_g' = T_g Q',  T_s' = T_s Q',  T_a' = T_a Q'
///
/// and p, v, p_CB, the biases and everything else as they were predicts the same readings and the
/// same pixels. Where T_g, T_a and R_CB are all estimated, three directions of the error are
/// therefore free until `imu_frame` ties them down (docs/calibration.md):
///
///   gyroscope      T_g's numbers above the diagonal stay as told (told T_g = I: it is triangular)
///   accelerometer  the same of T_a
///   camera         R_CB of the first camera is not estimated; then T_g and T_a take up its error
///   free           nothing; what the prior says of them holds them
///
/// Under `free` an estimator falsely learns of the axes: first estimates keep yaw and position
/// unobserved, not these, and the rates that are frozen within a rolling shutter's readout do not
/// turn with the axes (a turn of the axes moves pixels by |omega| tau of what it moves them by if
/// the camera alone turns; 0.65 % in CalibratedObservability).
///
/// T_s, where it is fixed, ties the axes too, by as much as it is (1e-3 rad/s per m/s^2 against 1):
/// too little to count.
[[nodiscard]] bool GaugeActs(const CalibrationPriors& priors);

/// Of the nine numbers of a 3x3 matrix by rows: those that the gauge may hold.
[[nodiscard]] constexpr bool IsAboveDiagonal(int number) { return number % 3 > number / 3; }

/// The message of a contradiction (camera together with an estimated R_CB of the first camera, full
/// T_g and T_a); empty where there is none.
[[nodiscard]] std::string GaugeError(const CalibrationPriors& priors);

/// Q that takes the truth into the axes that the estimator's gauge ties the body to; the identity
/// where the gauge does not act.
[[nodiscard]] Eigen::Quaterniond GaugeRotation(const RigCalibration& true_rig,
                                               const RigCalibration& told_rig,
                                               const CalibrationPriors& priors);

/// The same rig and state with the body's axes turned by Q.
[[nodiscard]] RigCalibration Reoriented(const RigCalibration& rig, const Eigen::Quaterniond& Q);
[[nodiscard]] InertialState Reoriented(const InertialState& state, const Eigen::Quaterniond& Q);

}  // namespace duet
