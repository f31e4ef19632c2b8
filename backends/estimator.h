#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backends/failure_rule.h"
#include "common/config/options.h"
#include "common/dataset/track_stream.h"
#include "common/imu/imu_sample.h"
#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"
#include "common/measurement/standstill.h"
#include "common/support/stage_timer.h"

namespace duet {

/// What the told noise densities are multiplied by: inflation against what the white noise model
/// leaves out, or a noise that is told wrong on purpose.
struct ImuNoiseFactors {
  double gyroscope_density = 1.0;
  double accelerometer_density = 1.0;
  double gyroscope_random_walk = 1.0;
  double accelerometer_random_walk = 1.0;

  [[nodiscard]] ImuNoise Times(const ImuNoise& told) const {
    return {
        .gyroscope_density = gyroscope_density * told.gyroscope_density,
        .accelerometer_density = accelerometer_density * told.accelerometer_density,
        .gyroscope_random_walk = gyroscope_random_walk * told.gyroscope_random_walk,
        .accelerometer_random_walk = accelerometer_random_walk * told.accelerometer_random_walk};
  }

  template <class Visitor>
  void Visit(Visitor& v) {
    const double min = 1e-3;
    const double max = 1e3;
    v.Field("gyroscope_density", &gyroscope_density,
            {.doc = "Of the gyroscope's white noise.", .min = min, .max = max});
    v.Field("accelerometer_density", &accelerometer_density,
            {.doc = "Of the accelerometer's white noise.", .min = min, .max = max});
    v.Field("gyroscope_random_walk", &gyroscope_random_walk,
            {.doc = "Of the walk of the gyroscope's bias.", .min = min, .max = max});
    v.Field("accelerometer_random_walk", &accelerometer_random_walk,
            {.doc = "Of the walk of the accelerometer's bias.", .min = min, .max = max});
  }
};

/// What both estimators must agree on (configuration `shared:`). Told values of the sensors come
/// with the recording (RigCalibration, ImuNoise).
struct SharedOptions {
  double pixel_noise_px = 1.0;
  int max_tracks = 150;
  double max_abs_t_d_s = 0.05;
  double max_abs_t_r_s = 0.05;
  double max_imu_gap_s = 0.05;
  ImuNoiseFactors imu_noise_factors;
  CalibrationPriors calibration;
  StandstillOptions standstill;
  FailureRule failure;

  [[nodiscard]] TimeBounds time_bounds() const { return {max_abs_t_d_s, max_abs_t_r_s}; }

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("pixel_noise_px", &pixel_noise_px,
            {.doc = "Standard deviation of a tracked pixel, per axis.",
             .unit = "px",
             .min = 1e-3,
             .max = 50});
    v.Field("max_tracks", &max_tracks,
            {.doc = "Most tracks that the front end keeps in a frame of one camera.",
             .min = 10,
             .max = 2000});
    v.Field("max_abs_t_d_s", &max_abs_t_d_s,
            {.doc = "Bound of |t_d|: IMU is fed that far ahead of a frame, estimates stay within.",
             .unit = "s",
             .min = 0,
             .max = 1});
    v.Field("max_abs_t_r_s", &max_abs_t_r_s,
            {.doc = "Bound of the readout time |t_r|, as max_abs_t_d_s.",
             .unit = "s",
             .min = 0,
             .max = 0.2});
    v.Field("max_imu_gap_s", &max_imu_gap_s,
            {.doc = "A frame whose interval holds a longer gap between IMU samples is not covered.",
             .unit = "s",
             .min = 1e-4,
             .max = 10});
    v.Group("imu_noise_factors", &imu_noise_factors,
            "What the recording's told noise densities are multiplied by.");
    v.Group("calibration", &calibration,
            "Which calibration states are estimated, with what prior.");
    v.Group("standstill", &standstill,
            "The standstill measurement: zero velocity, mean rate zero.");
    v.Group("failure", &failure, "When a run counts as failed.");
  }
};

/// Everything an estimator is told before it starts.
struct EstimatorSetup {
  RigCalibration rig;  ///< told values; cameras in the order of TrackFrame::camera
  ImuNoise imu_noise;
  Eigen::Vector3d g_G = Eigen::Vector3d(0, 0, -9.81);
  SharedOptions shared;
};

/// The first state and how far off it may be, the same for every estimator. Its error (order theta,
/// p, v, b_g, b_a) is one of `covariance`, independent of the calibration's, plus
/// `calibration_gain` times the error of the estimated calibration.
struct InitialCondition {
  InertialState state;
  Matrix15d covariance = Matrix15d::Identity();
  /// 15 x the size of the calibration's layout; empty: zero.
  Eigen::MatrixXd calibration_gain = {};
};

enum class EstimatorStatus { kInitializing, kTracking, kDeadReckoning, kFailed };
[[nodiscard]] const char* EstimatorStatusName(EstimatorStatus status);

/// What became of the features of one frame, for features.csv; counts of landmarks (tracks).
struct FeatureCounts {
  int observed = 0;          ///< observations in the frame, all cameras
  int used = 0;              ///< landmarks in this frame's update or problem
  int cleaned = 0;           ///< of these, without some of their observations (outliers)
  int gated = 0;             ///< refused by the chi-squared gate or as outliers
  int not_triangulated = 0;  ///< refused by triangulation
  int too_short = 0;         ///< ended with too few observations
  int lost = 0;              ///< ended in this frame
};

/// What an estimator says after a frame, of the newest frame, when it came.
struct EstimatorOutput {
  Timestamp frame_timestamp = 0;
  EstimatorStatus status = EstimatorStatus::kInitializing;
  std::string reason;   ///< of kFailed and kDeadReckoning
  InertialState state;  ///< at s_i = frame stamp + t_d used for it
  RigCalibration rig;
  /// Over theta, p, v, b_g, b_a and the estimated calibration (CalibrationLayout's order).
  Eigen::MatrixXd covariance;
  FeatureCounts features;
  bool keyframe = true;     ///< the frame before this one stays in the window
  bool standstill = false;  ///< the standstill measurement was used
  int iterations = 0;       ///< of the solver
};

/// The contract of DESIGN.md section 4. IMU samples and frames come in order; the caller has fed
/// the IMU up to the frame's stamp plus Horizon() before the frame, as far as the recording goes.
/// An estimator reads no file, no clock and no global, prints no result and owns no thread.
class Estimator {
 public:
  virtual ~Estimator() = default;

  /// The state to start from; once, before the first frame whose instant is at or after it. The
  /// first frame processed is stamped so that s_i is the state's instant, or later.
  virtual void Initialize(const InitialCondition& initial) = 0;

  virtual void AddImu(const ImuSample& sample) = 0;

  /// One stamp's frames of all cameras. The output is valid until the next call.
  virtual const EstimatorOutput& ProcessFrame(const TrackFrameSet& frames) = 0;

  /// The newest state taken to `t` by the IMU; nothing before the start or where the IMU ends.
  [[nodiscard]] virtual std::optional<NavState> PredictAt(Timestamp t) const = 0;

  [[nodiscard]] virtual const CalibrationLayout& layout() const = 0;

  /// Stages are timed into it where it is not null; not owned. Influences nothing.
  void set_stage_timer(StageTimer* timer) { timer_ = timer; }

 protected:
  StageTimer* timer_ = nullptr;
};

/// Widens the bounds of |t_d| and |t_r| to hold the told values: for studies that draw these, where
/// a rare draw is no bad input.
void IncludeTold(const RigCalibration& told, SharedOptions* shared);

/// How far past a frame's stamp the IMU must have been fed before the frame: the bounds of |t_d|
/// and |t_r| / 2 plus one sample (the caller adds the sample), s.
[[nodiscard]] double ImuHorizon(const SharedOptions& options);

}  // namespace duet
