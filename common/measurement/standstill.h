#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/dataset/track_stream.h"
#include "common/imu/imu_buffer.h"
#include "common/imu/nav_state.h"

namespace duet {

struct StandstillOptions {
  bool enabled = true;
  double velocity_sigma_m_per_s = 0.02;
  double rotation_sigma_rad = 0.002;
  double max_image_motion_px = 1.0;
  double max_mean_rate_change_sigmas = 4.0;
  double window_s = 0.5;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("enabled", &enabled,
            {.doc = "Use the standstill measurement while the rig is at rest."});
    v.Field("velocity_sigma_m_per_s", &velocity_sigma_m_per_s,
            {.doc = "Noise of the zero-velocity measurement, per axis and frame.",
             .unit = "m/s",
             .min = 1e-6});
    v.Field("rotation_sigma_rad", &rotation_sigma_rad,
            {.doc = "Noise of 'no rotation since the last frame', per axis.",
             .unit = "rad",
             .min = 1e-7});
    v.Field(
        "max_image_motion_px", &max_image_motion_px,
        {.doc = "At rest three quarters of the tracks move less than this between their means over "
                "the two halves of the window, and less than three times this between any frames "
                "(motors shake). 1 px in a quarter of a second is 0.026 m/s at 3 m and f = 460 px: "
                "the size of velocity_sigma_m_per_s.",
         .unit = "px",
         .min = 0});
    v.Field(
        "max_mean_rate_change_sigmas", &max_mean_rate_change_sigmas,
        {.doc =
             "At rest the means of gyro and accelerometer over the halves of the window differ by "
             "less than this many of their measured standard deviations.",
         .min = 0.1});
    v.Field("window_s", &window_s,
            {.doc = "Time over which rest is judged.", .unit = "s", .min = 0.05, .max = 10});
  }
};

/// Judges rest from the means of tracks and of the IMU over the two halves of a window, the IMU's
/// with the variance that is measured in it: running motors shake an IMU at rest by forty times its
/// densities, and the image by more than a pixel.
/// Deterministic; both estimators own one and come to the same verdict from the same stream.
class StandstillDetector {
 public:
  explicit StandstillDetector(const StandstillOptions& options) : options_(options) {}

  /// Takes a stamp's frames (those of the first camera count), in order; `imu` must cover the
  /// window up to `instant`. True where the rig has been at rest for the whole window.
  bool Update(const TrackFrameSet& frames, Timestamp instant, const ImuBuffer& imu);

 private:
  struct HalfSums {
    Eigen::Vector2f earlier = Eigen::Vector2f::Zero();
    Eigen::Vector2f later = Eigen::Vector2f::Zero();
    std::size_t frames = 0;
  };

  /// The tracks' part of the verdict, on the history and the newest frame.
  [[nodiscard]] bool ImageStands(const TrackFrame& newest);

  StandstillOptions options_;
  std::vector<TrackFrame> history_;  // of the first camera, ascending
  std::vector<float> motions_;       // scratch
  std::vector<HalfSums> sums_;       // scratch, one a track of the newest frame
  std::vector<ImuSample> readings_;  // scratch
};

/// The measurement at rest: no velocity and no rotation from state i to state j, residual (6):
/// z - h = (-R_j' v_j, -Log(R_j R_i')). It says nothing of the IMU's readings, which enter once, by
/// propagation. Jacobians of h: J_i, J_j (6x9 each, over theta, p, v).
///
/// The velocity is measured in the body's frame: of v_j = 0 in G, linearized where the estimate of
/// v_j is not quite zero, a turn about gravity would change the prediction, and every frame at rest
/// would tell yaw by |v_j|^2 / sigma^2. As it is both rows are blind to such a turn, exactly,
/// wherever they are linearized.
struct StandstillResidual {
  Eigen::Matrix<double, 6, 1> r;
  Eigen::Matrix<double, 6, 9> J_i;
  Eigen::Matrix<double, 6, 9> J_j;
  Eigen::Matrix<double, 6, 1> sigma;
};
[[nodiscard]] StandstillResidual EvaluateStandstill(const NavState& state_i,
                                                    const NavState& state_j,
                                                    const StandstillOptions& options);

}  // namespace duet
