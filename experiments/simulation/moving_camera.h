#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>

#include "common/measurement/calibration.h"
#include "common/support/timestamp.h"
#include "experiments/simulation/trajectory.h"

namespace duet {

/// The cameras of a rig that moves along a trajectory: when each line of an image is read, from
/// where, and at which pixel a point is then seen. From the trajectory itself, not through the
/// estimators' measurement model, so that what is simulated tests it.
///
/// Row k of N (column, where the rig reads by columns) sees the world at the trajectory's time
/// stamp - start + t_d + (k - (N - 1) / 2) t_r / N (DESIGN.md section 3).
class MovingCamera {
 public:
  enum class Shutter {
    kAsItIs,
    kMiddleRow,  ///< every row as if taken with the middle one: for showing what that costs
  };
  /// Where a point is at the trajectory's time, in G.
  using PointAtTime = std::function<Eigen::Vector3d(double t_s)>;

  MovingCamera(RigCalibration rig, std::shared_ptr<const Trajectory> trajectory, Timestamp start,
               Shutter shutter = Shutter::kAsItIs);

  [[nodiscard]] const RigCalibration& rig() const { return rig_; }
  [[nodiscard]] const Trajectory& trajectory() const { return *trajectory_; }
  [[nodiscard]] const CameraModel& model(int camera) const {
    return rig_.cameras[static_cast<std::size_t>(camera)].model;
  }
  [[nodiscard]] Timestamp start() const { return start_; }

  /// Rows, or columns where these are read one after the other.
  [[nodiscard]] int LineCount(int camera) const;
  /// The trajectory's time [s] at which a line is read (at the middle of its exposure); outside of
  /// the image that of the nearest.
  [[nodiscard]] double TimeOfLine(int camera, Timestamp stamp, double line) const;
  [[nodiscard]] double TimeOf(int camera, Timestamp stamp, const Eigen::Vector2d& uv) const {
    return TimeOfLine(camera, stamp, rig_.readout_by_columns ? uv.x() : uv.y());
  }
  /// T_CG at the trajectory's time.
  [[nodiscard]] Pose PoseAt(int camera, double t_s) const;

  /// The pixel of a point, its row solved for, in the image or not; nothing behind the camera,
  /// beyond the branch that its model shows, or where the row does not converge (the image moves
  /// faster than it is read).
  [[nodiscard]] std::optional<Eigen::Vector2d> PixelOf(int camera, Timestamp stamp,
                                                       const PointAtTime& point) const;

 private:
  RigCalibration rig_;
  std::shared_ptr<const Trajectory> trajectory_;
  Timestamp start_;
  Shutter shutter_;
};

}  // namespace duet
