#include "experiments/simulation/moving_camera.h"

#include <algorithm>
#include <utility>

#include "common/support/logging.h"

namespace duet {
namespace {

// Each round takes the row's error down by the share of the readout that the image moves in.
constexpr int kMaxRounds = 50;
constexpr double kConverged_px = 1e-9;

}  // namespace

MovingCamera::MovingCamera(RigCalibration rig, std::shared_ptr<const Trajectory> trajectory,
                           Timestamp start, Shutter shutter)
    : rig_(std::move(rig)), trajectory_(std::move(trajectory)), start_(start), shutter_(shutter) {
  CHECK(trajectory_ != nullptr);
}

int MovingCamera::LineCount(int camera) const {
  return rig_.readout_by_columns ? model(camera).width_px() : model(camera).height_px();
}

double MovingCamera::TimeOfLine(int camera, Timestamp stamp, double line) const {
  const double t_s = SecondsBetween(start_, stamp) + rig_.t_d_s;
  if (shutter_ == Shutter::kMiddleRow) return t_s;
  const double count = LineCount(camera);
  // No line is read outside of the image: a point there is seen with the nearest one.
  line = std::clamp(line, -0.5, count - 0.5);
  return t_s + (line - 0.5 * (count - 1.0)) * rig_.t_r_s / count;
}

Pose MovingCamera::PoseAt(int camera, double t_s) const {
  const CameraCalibration& calibration = rig_.cameras[static_cast<std::size_t>(camera)];
  return Pose{calibration.R_CB, calibration.p_CB} * trajectory_->At(t_s).T_GB.Inverse();
}

std::optional<Eigen::Vector2d> MovingCamera::PixelOf(int camera, Timestamp stamp,
                                                     const PointAtTime& point) const {
  const CameraModel& camera_model = model(camera);
  Eigen::Vector2d uv(0.5 * (camera_model.width_px() - 1), 0.5 * (camera_model.height_px() - 1));
  double t_s = TimeOf(camera, stamp, uv);
  for (int round = 0; round < kMaxRounds; ++round) {
    const Eigen::Vector3d p_C = PoseAt(camera, t_s) * point(t_s);
    if (!(p_C.z() > 0.0) || p_C.head<2>().norm() > camera_model.max_radius() * p_C.z()) {
      return std::nullopt;
    }
    const Eigen::Vector2d before = uv;
    if (!camera_model.Project(p_C, &uv)) return std::nullopt;
    const double next_s = TimeOf(camera, stamp, uv);
    // Without a rolling shutter there is nothing to solve for.
    if (next_s == t_s || (uv - before).norm() < kConverged_px) return uv;
    t_s = next_s;
  }
  return std::nullopt;
}

}  // namespace duet
