#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/geometry/se3.h"
#include "common/measurement/calibration.h"

namespace duet {

/// Images of a textured wall, the plane z = kDepth of G, by ray casting: where any pixel goes is
/// known exactly. The texture is smooth noise with structure of a few pixels to half the image.
class SyntheticScene {
 public:
  static constexpr double kDepth = 3.0;  // m

  explicit SyntheticScene(std::uint64_t seed);

  /// What a camera at T_GC sees.
  [[nodiscard]] cv::Mat Render(const CameraModel& model, const Pose& T_GC) const;

  /// Where the point of the wall that is seen at `uv` from T_GC lies, in G.
  [[nodiscard]] static std::optional<Eigen::Vector3d> PointAt(const CameraModel& model,
                                                              const Pose& T_GC,
                                                              const Eigen::Vector2d& uv);
  /// Its pixel in a camera at T_GC.
  [[nodiscard]] static std::optional<Eigen::Vector2d> PixelOf(const CameraModel& model,
                                                              const Pose& T_GC,
                                                              const Eigen::Vector3d& point_G);

 private:
  cv::Mat texture_;
};

/// 376 x 240 pixels, focal length 230, radial-tangential distortion like EuRoC's.
[[nodiscard]] CameraModel SmallCamera();

/// SmallCamera as the only camera, turned against the body; `stereo`: a second one 0.11 m to the
/// right of it, slightly turned.
[[nodiscard]] RigCalibration SmallRig(bool stereo);

[[nodiscard]] Pose CameraPose(const RigCalibration& rig, std::size_t camera, const Pose& T_GB);

}  // namespace duet
