#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "common/measurement/calibration.h"
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
///
/// Row k of N (column, where the rig reads by columns) sees the world at the trajectory's time
/// stamp - start + t_d + (k - (N - 1) / 2) t_r / N (DESIGN.md section 3).
class TrueCamera {
 public:
  enum class Shutter {
    kAsItIs,
    kMiddleRow,  ///< every row as if taken with the middle one: for showing what that costs
  };

  TrueCamera(RigCalibration rig, std::shared_ptr<const World> world,
             std::shared_ptr<const Trajectory> trajectory, Timestamp start,
             Shutter shutter = Shutter::kAsItIs);

  [[nodiscard]] const RigCalibration& rig() const { return rig_; }
  [[nodiscard]] const World& world() const { return *world_; }
  [[nodiscard]] const Trajectory& trajectory() const { return *trajectory_; }
  [[nodiscard]] const CameraModel& model(int camera) const {
    return rig_.cameras[static_cast<std::size_t>(camera)].model;
  }

  [[nodiscard]] Timestamp start() const { return start_; }

  /// Rows, or columns where these are read one after the other.
  [[nodiscard]] int LineCount(int camera) const;
  /// The trajectory's time [s] at which a line is read (at the middle of its exposure).
  [[nodiscard]] double TimeOfLine(int camera, Timestamp stamp, double line) const;
  [[nodiscard]] double TimeOf(int camera, Timestamp stamp, const Eigen::Vector2d& uv) const {
    return TimeOfLine(camera, stamp, rig_.readout_by_columns ? uv.x() : uv.y());
  }
  /// T_CG at the trajectory's time.
  [[nodiscard]] Pose PoseAt(int camera, double t_s) const;

  /// What is seen at `uv`; nothing where the pixel has no direction or the world ends.
  [[nodiscard]] std::optional<SurfacePoint> PointAt(int camera, Timestamp stamp,
                                                    const Eigen::Vector2d& uv) const;
  /// The pixel of a point, its row solved for, occluded or not, in the image or not; nothing behind
  /// the camera, beyond the branch that its model shows, or where the row does not converge (the
  /// image moves faster than it is read).
  [[nodiscard]] std::optional<Eigen::Vector2d> PixelOf(int camera, Timestamp stamp,
                                                       const SurfacePoint& point) const;

  /// True where nothing stands before a point whose pixel (PixelOf) is `uv`.
  [[nodiscard]] bool IsVisible(int camera, Timestamp stamp, const SurfacePoint& point,
                               const Eigen::Vector2d& uv) const;

 private:
  RigCalibration rig_;
  std::shared_ptr<const World> world_;
  std::shared_ptr<const Trajectory> trajectory_;
  Timestamp start_;
  Shutter shutter_;
};

}  // namespace duet
