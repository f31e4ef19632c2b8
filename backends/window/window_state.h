#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/imu/imu_delta.h"
#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"
#include "common/measurement/measurement_model.h"
#include "common/measurement/rate_profile.h"
#include "common/support/timestamp.h"

namespace duet {

/// Components of a frame's error and of the window's: 15 a frame (theta, p, v, b_g, b_a), then the
/// estimated calibration.
inline constexpr int kFrameSize = 15;
inline constexpr int kPoseOffset = 0;
inline constexpr int kVelocityOffset = 6;
inline constexpr int kBiasesOffset = 9;

/// The IMU between a frame and the one before it.
struct ImuLink {
  ImuDelta delta;
  Matrix15d sqrt_information;
};

/// A frame of the window.
struct WindowFrame {
  Timestamp timestamp = 0;            ///< the image's stamp
  InertialState state;                ///< at s_i; the current estimate
  double t_d_at_instant_s = 0.0;      ///< the t_d that s_i was made with
  RateProfile rates;                  ///< filled where observations lie off s_i
  std::optional<ImuLink> link;        ///< from the frame before; none where the prior holds it
  bool at_rest_since_before = false;  ///< the standstill measurement joins it to the one before

  /// First estimates: the values with which the parts of the state entered a prior, the origin of
  /// the prior's errors. Meaningful where the flag is set.
  InertialState origin;
  bool pose_in_prior = false;
  bool velocity_in_prior = false;
  bool biases_in_prior = false;
};

/// Values of everything that factors depend on, landmarks apart: where they are evaluated.
struct WindowPoint {
  std::vector<NavState> nav;
  std::vector<ImuBiases> biases;
  RigCalibration rig;
};

/// One pixel of a landmark; `frame` is the index of the window's frame.
struct LandmarkObservation {
  int frame = 0;
  PixelObservation pixel;
  Eigen::Vector3d bearing_B = Eigen::Vector3d::Zero();  ///< unit, by the calibration of its time
  mutable RateProfile::Memo motion = {};                ///< emptied with the frame's rates
};

/// A track's point: (alpha, beta, rho) in C0 of the anchor, the first frame that it was seen in.
struct Landmark {
  std::uint64_t track_id = 0;
  bool has_value = false;    ///< triangulated
  bool depth_known = false;  ///< beyond what the poses and the calibration are uncertain by
  bool in_problem = false;   ///< of the newest frame's problem
  bool seen_newest = false;  ///< observed in the newest frame
  InverseDepth value = InverseDepth::Zero();
  std::vector<LandmarkObservation> observations;  ///< ascending in (frame, camera)

  [[nodiscard]] int anchor() const { return observations.front().frame; }
};

/// True for the pixel that fixes alpha and beta where rho alone is free.
[[nodiscard]] inline bool IsAnchorPixel(const Landmark& landmark, const LandmarkObservation& o) {
  return o.frame == landmark.anchor() && o.pixel.camera == 0;
}

}  // namespace duet
