#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backends/estimator.h"
#include "common/dataset/track_stream.h"
#include "common/imu/imu_sample.h"
#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"
#include "common/support/random.h"
#include "experiments/simulation/trajectory.h"

namespace duet {

/// The world without surfaces: points on the walls of a box and between them.
inline constexpr const char* kBoxWorld = "box";
/// The IMU before the first and after the last frame: room for |t_d|, t_r and a sample.
inline constexpr double kImuMargin_s = 0.2;

/// What is simulated. Defaults: EuRoC's rates and noise densities, an easy flight through a room.
struct SimulationOptions {
  std::string trajectory = "room_walk";
  std::string imu;
  bool imu_apply_time_shift = true;
  bool imu_apply_rotation = false;
  std::string sensors;
  double duration_s = 30.0;
  double rest_s = 0.0;
  int seed = 1;

  double imu_rate_hz = 200.0;
  double gyroscope_density = 1.6968e-4;
  double accelerometer_density = 2.0e-3;
  double gyroscope_random_walk = 1.9393e-5;
  double accelerometer_random_walk = 3.0e-3;
  double noise_scale = 1.0;
  double gravity_m_per_s2 = 9.81;
  std::vector<double> b_g_rad_per_s = {-0.002, 0.021, 0.075};
  std::vector<double> b_a_m_per_s2 = {-0.05, 0.12, 0.07};
  double gyroscope_range_rad_per_s = 0.0;
  double accelerometer_range_m_per_s2 = 0.0;
  double imu_jitter_s = 0.0;
  bool imu_jitter_is_stamped = true;
  double imu_drop_share = 0.0;

  double camera_rate_hz = 20.0;
  int cameras = 1;
  double t_d_s = 0.0;
  double t_r_s = 0.0;
  std::string world = kBoxWorld;
  double world_scale = 0.0;
  bool moving_bodies = false;
  int max_tracks = 120;
  double mean_track_frames = 60.0;
  double weak_share = 0.0;
  double weak_track_frames = 4.0;
  double pixel_noise_px = 1.0;
  double pixel_drift_px = 0.0;
  double outlier_share = 0.0;
  double mismatch_share = 0.0;
  double outlier_px = 30.0;
  double clutter_share = 0.5;

  /// The rig; EurocLikeRig(cameras) with t_d and t_r from above where it is not set.
  std::optional<RigCalibration> true_rig;
  /// The told rig is the true one minus drawn errors; their sigmas are multiplied by noise_scale.
  ToldErrors told_errors;
  ImuFrame told_imu_frame = ImuFrame::kFree;  ///< numbers that it holds are told right
  std::vector<int> told_cameras = {};         ///< others are told right; empty: all are wrong

  template <class Visitor>
  void Visit(Visitor& v);
};

/// A recording in memory, and the truth about it.
struct SimulatedRecording {
  std::vector<ImuSample> imu;
  std::vector<TrackFrameSet> frames;
  /// At the IMU's stamps, those of lost samples too, with the true biases.
  std::vector<InertialState> truth;
  RigCalibration true_rig;
  RigCalibration told_rig;
  ImuNoise noise;  ///< scaled; what the estimators are told
  double pixel_noise_px = 0.0;
  Eigen::Vector3d g_G = Eigen::Vector3d::Zero();
  Timestamp start = 0;  ///< the instant of the trajectory's t = 0
  std::shared_ptr<const Trajectory> trajectory;
  std::string label;  ///< for tables: what was simulated, and what of it was real
  int dropped_imu_samples = 0;
  int clipped_gyroscope_samples = 0;  ///< at the end of the range
  int clipped_accelerometer_samples = 0;

  /// The truth at any instant of the recording: exact pose and velocity, biases linear between the
  /// IMU's samples.
  [[nodiscard]] InertialState TruthAt(Timestamp instant) const;
};

/// One or two cameras with numbers close to EuRoC's rig: 752x480, f = 458 px, radial-tangential
/// distortion, 11 cm baseline.
[[nodiscard]] RigCalibration EurocLikeRig(int cameras);

/// Simulates a recording: the IMU by the full error model (DESIGN.md section 3: T matrices, biases
/// that walk at the IMU's rate, white noise of density * sqrt(rate) a sample), and tracks of points
/// of its world. A camera's row k sees the world at
/// stamp + t_d + k t_r / N. Pixels are projected from the trajectory itself, not through the
/// estimators' measurement model, so that they test it. Tracks are spread evenly over the image,
/// end at random (mean_track_frames) or with their point out of view, and have ids never reused;
/// with two cameras, the second sees those points of the first that are in its view.
/// The IMU reaches 0.2 s past the first and the last frame. The same options give the same bytes.
/// Throws InputError for an unknown trajectory or options that contradict each other.
[[nodiscard]] SimulatedRecording Simulate(const SimulationOptions& options);

/// The same along a given trajectory (which decides about the duration); points lie on the walls of
/// a box 2 m around the path.
[[nodiscard]] SimulatedRecording Simulate(const SimulationOptions& options,
                                          std::shared_ptr<const Trajectory> trajectory);

/// A first state that is off from the truth by an error drawn from the covariance: what it takes
/// for an estimator's NEES to be what it promises.
[[nodiscard]] InitialCondition DrawInitialCondition(const InertialState& truth,
                                                    const Matrix15d& covariance, Random* random);

/// What the estimators are told of the recording. `shared` with the recording's pixel noise.
[[nodiscard]] EstimatorSetup MakeSetup(const SimulatedRecording& recording,
                                       const SharedOptions& shared);

/// Named settings: room_easy (30 s, mono), room_easy_stereo, room_rest (starts at rest), hover,
/// excited (lissajous), outliers, and one like each sequence of EuRoC with its duration and
/// kEurocRest_s of rest (MH_01_easy, ... V2_03_difficult). Throws InputError for an unknown name.
[[nodiscard]] const std::vector<std::string>& SimulationPresetNames();
[[nodiscard]] SimulationOptions SimulationPreset(const std::string& name);

template <class Visitor>
void SimulationOptions::Visit(Visitor& v) {
  v.Field(
      "trajectory", &trajectory,
      {.doc = "Name of a trajectory (duet simulate --list), or a truth file in EuRoC's or TUM's "
              "form."});
  v.Field("imu", &imu,
          {.doc = "Folder of a recording whose IMU is taken as it is, with vision simulated along "
                  "its truth; empty: the IMU is simulated."});
  v.Field(
      "imu_apply_time_shift", &imu_apply_time_shift,
      {.doc = "Of imu: the truth's stamps are put onto the IMU's clock by the shift found between "
              "them."});
  v.Field(
      "imu_apply_rotation", &imu_apply_rotation,
      {.doc = "Of imu: the truth's body is turned into the gyroscope's by the rotation found "
              "between them. Where gyroscope and accelerometer are not aligned it takes from the "
              "one what it gives to the other."});
  v.Field("sensors", &sensors,
          {.doc = "The rig and its noise: a file like configs/sensors/euroc_like.yaml or a "
                  "recording's folder; empty: EuRoC's numbers, with the keys below."});
  v.Field("duration_s", &duration_s,
          {.doc = "Time from the first to the last frame; 0: to the end of the motion.",
           .unit = "s",
           .min = 0,
           .max = 86400});
  v.Field("rest_s", &rest_s,
          {.doc = "At rest for this long before setting off.", .unit = "s", .min = 0, .max = 600});
  v.Field("seed", &seed, {.doc = "Seed of everything random.", .min = 0, .max = 2e9});
  v.Field("imu_rate_hz", &imu_rate_hz,
          {.doc = "Rate of the IMU.", .unit = "Hz", .min = 10, .max = 20000});
  v.Field("gyroscope_density", &gyroscope_density,
          {.doc = "White noise of the gyroscope.", .unit = "rad/s/sqrt(Hz)", .min = 0});
  v.Field("accelerometer_density", &accelerometer_density,
          {.doc = "White noise of the accelerometer.", .unit = "m/s^2/sqrt(Hz)", .min = 0});
  v.Field("gyroscope_random_walk", &gyroscope_random_walk,
          {.doc = "Random walk of the gyroscope's bias.", .unit = "rad/s^2/sqrt(Hz)", .min = 0});
  v.Field("accelerometer_random_walk", &accelerometer_random_walk,
          {.doc = "Random walk of the accelerometer's bias.", .unit = "m/s^3/sqrt(Hz)", .min = 0});
  v.Field(
      "noise_scale", &noise_scale,
      {.doc = "Multiplies the four densities, the pixel noise and the told calibration's errors.",
       .min = 0});
  v.Field("gravity_m_per_s2", &gravity_m_per_s2,
          {.doc = "Magnitude of gravity.", .unit = "m/s^2", .min = 0.1, .max = 30});
  v.Field("b_g_rad_per_s", &b_g_rad_per_s,
          {.doc = "The gyroscope's bias at the start, x y z.", .unit = "rad/s"});
  v.Field("b_a_m_per_s2", &b_a_m_per_s2,
          {.doc = "The accelerometer's bias at the start, x y z.", .unit = "m/s^2"});
  v.Field("gyroscope_range_rad_per_s", &gyroscope_range_rad_per_s,
          {.doc = "Largest reading of an axis, either sign; 0: none.", .unit = "rad/s", .min = 0});
  v.Field("accelerometer_range_m_per_s2", &accelerometer_range_m_per_s2,
          {.doc = "Largest reading of an axis, either sign; 0: none.", .unit = "m/s^2", .min = 0});
  v.Field("imu_jitter_s", &imu_jitter_s,
          {.doc = "1 sigma of the IMU's sampling instants about even ones, at most 0.45 intervals.",
           .unit = "s",
           .min = 0,
           .max = 0.05});
  v.Field("imu_jitter_is_stamped", &imu_jitter_is_stamped,
          {.doc = "Stamps follow the jittered instants; false: they stay even and are wrong."});
  v.Field("imu_drop_share", &imu_drop_share,
          {.doc = "Share of IMU samples that are lost.", .min = 0, .max = 0.9});
  v.Field("camera_rate_hz", &camera_rate_hz,
          {.doc = "Rate of the cameras.", .unit = "Hz", .min = 1, .max = 200});
  v.Field("cameras", &cameras, {.doc = "One or two cameras.", .min = 1, .max = 2});
  v.Field(
      "t_d_s", &t_d_s,
      {.doc = "An image stamped t was taken at t + t_d.", .unit = "s", .min = -0.1, .max = 0.1});
  v.Field("t_r_s", &t_r_s,
          {.doc = "Readout time of all rows; 0: global shutter; negative: upwards.",
           .unit = "s",
           .min = -0.1,
           .max = 0.1});
  v.Field(
      "world", &world,
      {.doc = "Where the tracks' points are: on the surfaces of room, bare_room, hall or street, "
              "with occlusion, or (box) on the walls of a box and between them, without."});
  v.Field("world_scale", &world_scale,
          {.doc = "Multiplies all lengths of the world; 0: 1, or as large as a truth's path needs.",
           .min = 0,
           .max = 20});
  v.Field("moving_bodies", &moving_bodies, {.doc = "Walkers and cars in the world."});
  v.Field("max_tracks", &max_tracks,
          {.doc = "Tracks in each frame of the first camera.", .min = 1, .max = 5000});
  v.Field("mean_track_frames", &mean_track_frames,
          {.doc = "Mean length of a track whose point stays in view.", .unit = "frames", .min = 2});
  v.Field("weak_share", &weak_share,
          {.doc = "Share of tracks that are on weak corners and end early, as a real tracker's do.",
           .min = 0,
           .max = 1});
  v.Field("weak_track_frames", &weak_track_frames,
          {.doc = "Mean length of those.", .unit = "frames", .min = 1});
  v.Field("pixel_noise_px", &pixel_noise_px,
          {.doc = "Noise of a pixel, per axis.", .unit = "px", .min = 0, .max = 50});
  v.Field(
      "pixel_drift_px", &pixel_drift_px,
      {.doc = "A track walks away from its point by this much a frame, per axis; the first camera "
              "and the second each for itself.",
       .unit = "px",
       .min = 0,
       .max = 5});
  v.Field("outlier_share", &outlier_share,
          {.doc = "Share of observations thrown off by 5 to outlier_px.", .min = 0, .max = 1});
  v.Field("mismatch_share", &mismatch_share,
          {.doc = "Share of observations at which a track goes over to another point for good.",
           .min = 0,
           .max = 1});
  v.Field(
      "outlier_px", &outlier_px,
      {.doc = "Largest throw of an outlier or a mismatch.", .unit = "px", .min = 5, .max = 500});
  v.Field("clutter_share", &clutter_share,
          {.doc = "Share of points that stand in the box, not on its walls (world box).",
           .min = 0,
           .max = 1});
}

}  // namespace duet
