#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "common/measurement/calibration.h"
#include "experiments/simulation/moving_camera.h"
#include "experiments/simulation/trajectory.h"
#include "experiments/simulation/world/world.h"

namespace duet {

/// A point on a surface; goes with its body.
struct SurfacePoint {
  int surface = -1;
  Eigen::Vector2d uv_m = Eigen::Vector2d::Zero();
  double distance_m = 0.0;  ///< from the camera that saw it
};

/// What the cameras of a rig that moves through a world truly see: exact, pixel by pixel, in
/// double. The renderer draws it and TrackAccuracy judges tracks by it.
class TrueCamera : public MovingCamera {
 public:
  TrueCamera(RigCalibration rig, std::shared_ptr<const World> world,
             std::shared_ptr<const Trajectory> trajectory, Timestamp start,
             Shutter shutter = Shutter::kAsItIs);

  [[nodiscard]] const World& world() const { return *world_; }

  /// What is seen at `uv`; nothing where the pixel has no direction or the world ends.
  [[nodiscard]] std::optional<SurfacePoint> PointAt(int camera, Timestamp stamp,
                                                    const Eigen::Vector2d& uv) const;
  /// The pixel of a point, occluded or not; as MovingCamera::PixelOf.
  [[nodiscard]] std::optional<Eigen::Vector2d> PixelOf(int camera, Timestamp stamp,
                                                       const SurfacePoint& point) const;

  /// True where nothing stands before a point whose pixel (PixelOf) is `uv`.
  [[nodiscard]] bool IsVisible(int camera, Timestamp stamp, const SurfacePoint& point,
                               const Eigen::Vector2d& uv) const;

 private:
  std::shared_ptr<const World> world_;
};

}  // namespace duet
