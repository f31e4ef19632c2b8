#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/dataset/recording.h"
#include "common/geometry/pose_jumps.h"
#include "common/imu/inertial_truth_fit.h"
#include "common/imu/nav_state.h"
#include "experiments/simulation/spline_trajectory.h"

namespace duet {

struct RecordedMotionOptions {
  /// Puts the truth's stamps onto the IMU's clock, by the shift that was found.
  bool apply_time_shift = true;
  /// Turns the truth's body frame into the gyroscope's, by the rotation that was found. Off: where
  /// gyroscope and accelerometer are not aligned with each other it takes from the one what it
  /// gives to the other.
  bool apply_rotation = false;
  double knot_spacing_s = 0.0;  ///< as SplineOptions
  double bias_knots_s = 10.0;   ///< how slowly the biases go
  PoseJumpOptions jumps = {};
};

/// How much the IMU departs from the spline, both taken at the IMU's stamps, biases taken out.
struct MotionAgreement {
  double gyroscope_rms = 0.0;      ///< rad/s, over the three axes; vibration is in it
  double accelerometer_rms = 0.0;  ///< m/s^2
  /// The same of means over 0.1 s: what the vibration leaves.
  double slow_gyroscope_rms = 0.0;
  double slow_accelerometer_rms = 0.0;
  struct Second {
    double start_s = 0.0;  ///< since the spline's start
    double slow_gyroscope_rms = 0.0;
    double slow_accelerometer_rms = 0.0;
  };
  /// The five seconds that are worst, by both relative to the whole's; worst first.
  std::vector<Second> worst;
};

/// The IMU integrated over 1 s from the spline's state with the biases found, against the spline.
struct PredictionErrors {
  int count = 0;
  double median_m = 0.0;
  double p95_m = 0.0;
  double largest_m = 0.0;
  double median_deg = 0.0;
  double p95_deg = 0.0;
  double largest_deg = 0.0;
};

struct RecordedMotionReport {
  std::string label;  ///< "real IMU, synthetic vision along NAME's truth"
  /// IMU against truth as recorded: time shift and its sigma, rotation, bias. Nothing where the rig
  /// turns too little.
  std::optional<GyroTruthFit> fit;
  double applied_shift_s = 0.0;
  double applied_rotation_deg = 0.0;
  /// Stamps are the IMU's (after the shift).
  std::vector<PoseJump> jumps;
  /// How far the bridged truth has come from the recorded one at the end.
  double final_offset_m = 0.0;
  double final_offset_deg = 0.0;
  MotionAgreement agreement;
  PredictionErrors prediction;
  /// Biases found minus the recording's own, root mean square over the axes; nothing where it tells
  /// none.
  std::optional<double> b_g_difference;  ///< rad/s
  std::optional<double> b_a_difference;  ///< m/s^2
};

/// A recorded IMU and a smooth trajectory that belongs to it.
struct RecordedMotion {
  std::shared_ptr<const SplineTrajectory> trajectory;
  Timestamp start = 0;         ///< the stamp of the trajectory's t = 0
  std::vector<ImuSample> imu;  ///< as recorded, all of it
  ImuSensor imu_sensor;
  /// At the IMU's stamps within the trajectory: pose and velocity of the spline. The biases are no
  /// truth but an estimate, what the IMU reads more than the spline has, slowly varying: the
  /// reading's scale and alignment errors and the truth's own tilt are in them.
  std::vector<InertialState> states;
  RecordedMotionReport report;
};

/// The motion of a recording with IMU and truth, so that vision can be synthesized for a real IMU.
/// In this order: the time shift and the constant rotation between truth and IMU are found and, as
/// the options say, applied; the truth's jumps are found against the IMU and bridged with it
/// (common/geometry/pose_jumps.h); a spline is laid through what results; the biases are fitted.
/// Throws InputError where there is no truth, it shares less than 5 s with the IMU, or it is no
/// trajectory (SplineThrough).
[[nodiscard]] RecordedMotion FollowRecording(const Recording& recording, const std::string& name,
                                             const RecordedMotionOptions& options = {});
/// The same from an ASL folder; its name is the folder's.
[[nodiscard]] RecordedMotion LoadRecordedMotion(const std::filesystem::path& folder,
                                                const RecordedMotionOptions& options = {});

/// The report for a terminal; every jump with its time, offset and turn where `all_jumps`.
[[nodiscard]] std::string RecordedMotionText(const RecordedMotionReport& report, Timestamp start,
                                             bool all_jumps);

}  // namespace duet
