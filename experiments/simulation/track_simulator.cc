#include "experiments/simulation/track_simulator.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "experiments/simulation/simulator.h"

namespace duet {
namespace {

constexpr int kGridColumns = 10;
constexpr int kGridRows = 6;
constexpr double kPi = 3.14159265358979323846;

// The distance along `direction` from `origin` inside the room to its walls.
double DistanceToWall(const Room& room, const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction) {
  double distance = 1e9;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0.0) continue;
    const double wall = direction[i] > 0.0 ? room.high[i] : room.low[i];
    distance = std::min(distance, (wall - origin[i]) / direction[i]);
  }
  return distance;
}

// The largest tan of the angle off the axis that the image shows. Beyond it a distortion polynomial
// may fold points back into the image.
double LargestRadius(const CameraModel& model) {
  double radius = 0.0;
  for (const double u : {-0.5, model.width_px() - 0.5}) {
    for (const double v : {-0.5, model.height_px() - 0.5}) {
      const auto ray = model.Unproject({u, v});
      if (ray) radius = std::max(radius, ray->head<2>().norm());
    }
  }
  return radius > 0.0 ? 1.02 * radius : 1e9;
}

}  // namespace

TrackSimulator::TrackSimulator(const SimulationOptions& options, const RigCalibration& rig,
                               const Trajectory& trajectory, Timestamp start, const Room& room,
                               Random random)
    : options_(options),
      rig_(rig),
      trajectory_(trajectory),
      start_(start),
      room_(room),
      random_(random),
      cell_counts_(kGridColumns * kGridRows) {
  for (const CameraCalibration& camera : rig_.cameras) {
    max_radius_.push_back(LargestRadius(camera.model));
  }
}

Pose TrackSimulator::CameraPoseAt(int camera, Timestamp stamp, const Eigen::Vector2d& uv) const {
  const CameraCalibration& calibration = rig_.cameras[static_cast<std::size_t>(camera)];
  const CameraModel& model = calibration.model;
  const double count = rig_.readout_by_columns ? model.width_px() : model.height_px();
  const double line = rig_.readout_by_columns ? uv.x() : uv.y();
  const double delay_s = rig_.t_d_s + (line - 0.5 * (count - 1.0)) * rig_.t_r_s / count;
  const Pose T_GB = trajectory_.At(SecondsBetween(start_, stamp) + delay_s).T_GB;
  return Pose{calibration.R_CB, calibration.p_CB} * T_GB.Inverse();
}

bool TrackSimulator::See(int camera, Timestamp stamp, const Eigen::Vector3d& p_G,
                         Eigen::Vector2d* uv) const {
  const CameraModel& model = rig_.cameras[static_cast<std::size_t>(camera)].model;
  Eigen::Vector2d pixel(0.5 * (model.width_px() - 1), 0.5 * (model.height_px() - 1));
  // The row decides about the pose and the pose about the row; each round takes the error down by
  // the share of the readout that the image moves in, a few percent.
  const int rounds = rig_.t_r_s == 0.0 ? 1 : 8;
  for (int i = 0; i < rounds; ++i) {
    const Eigen::Vector3d p_C = CameraPoseAt(camera, stamp, pixel) * p_G;
    if (p_C.z() < 0.05) return false;
    if (p_C.head<2>().norm() > max_radius_[static_cast<std::size_t>(camera)] * p_C.z()) {
      return false;
    }
    if (!model.Project(p_C, &pixel)) return false;
  }
  *uv = pixel;
  return model.Contains(pixel);
}

bool TrackSimulator::DrawPoint(Timestamp stamp, const Eigen::Vector2d& uv, Eigen::Vector3d* p_G) {
  const double share = random_.Uniform();
  const double depth_share = random_.Uniform(0.35, 0.95);
  const auto ray_C = rig_.cameras[0].model.Unproject(uv);
  if (!ray_C) return false;
  const Pose T_GC = CameraPoseAt(0, stamp, uv).Inverse();
  const Eigen::Vector3d direction = T_GC.R * *ray_C;
  double distance = DistanceToWall(room_, T_GC.p, direction);
  CHECK_GT(distance, 0.0) << "the trajectory leaves the room";
  if (share < options_.clutter_share) distance *= depth_share;
  *p_G = T_GC.p + distance * direction;
  return true;
}

int TrackSimulator::CellOf(const Eigen::Vector2d& uv) const {
  const CameraModel& model = rig_.cameras[0].model;
  const int column = static_cast<int>((uv.x() + 0.5) * kGridColumns / model.width_px());
  const int row = static_cast<int>((uv.y() + 0.5) * kGridRows / model.height_px());
  return std::clamp(row, 0, kGridRows - 1) * kGridColumns + std::clamp(column, 0, kGridColumns - 1);
}

void TrackSimulator::EndTracks(Timestamp stamp) {
  const double end_probability = 1.0 / options_.mean_track_frames;
  std::size_t kept = 0;
  for (Track& track : tracks_) {
    const bool ends = random_.Uniform() < end_probability;
    if (ends || !See(0, stamp, track.p_G, &track.uv)) continue;
    tracks_[kept++] = track;
  }
  tracks_.resize(kept);
}

void TrackSimulator::StartTracks(Timestamp stamp) {
  const CameraModel& model = rig_.cameras[0].model;
  std::fill(cell_counts_.begin(), cell_counts_.end(), 0);
  for (const Track& track : tracks_) ++cell_counts_[static_cast<std::size_t>(CellOf(track.uv))];
  // A pixel at which no point can be had is tried once; the bound only guards against a camera
  // that sees nothing at all.
  int tries = 10 * options_.max_tracks;
  while (static_cast<int>(tracks_.size()) < options_.max_tracks && tries-- > 0) {
    const auto emptiest = std::min_element(cell_counts_.begin(), cell_counts_.end());
    const int cell = static_cast<int>(emptiest - cell_counts_.begin());
    ++*emptiest;
    Track track;
    const double column = cell % kGridColumns + random_.Uniform();
    const double row = cell / kGridColumns + random_.Uniform();
    track.uv = {column * model.width_px() / kGridColumns - 0.5,
                row * model.height_px() / kGridRows - 0.5};
    if (!DrawPoint(stamp, track.uv, &track.p_G)) continue;
    track.id = next_id_++;
    tracks_.push_back(track);
  }
}

void TrackSimulator::Mismatch(Timestamp stamp, Track* track) {
  const double angle = random_.Uniform(0.0, 2.0 * kPi);
  const double throw_px = random_.Uniform(5.0, options_.outlier_px);
  const Eigen::Vector2d uv =
      track->uv + throw_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  if (!rig_.cameras[0].model.Contains(uv)) return;
  if (DrawPoint(stamp, uv, &track->p_G)) track->uv = uv;
}

TrackObservation TrackSimulator::Noisy(std::uint64_t id, const Eigen::Vector2d& uv) {
  const double sigma_px = options_.noise_scale * options_.pixel_noise_px;
  Eigen::Vector2d noisy = uv + sigma_px * random_.NormalVector<2>();
  if (options_.outlier_share > 0.0 && random_.Uniform() < options_.outlier_share) {
    const double angle = random_.Uniform(0.0, 2.0 * kPi);
    const double throw_px = random_.Uniform(5.0, options_.outlier_px);
    noisy += throw_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return {.track_id = id, .u = static_cast<float>(noisy.x()), .v = static_cast<float>(noisy.y())};
}

TrackFrameSet TrackSimulator::Observe(Timestamp stamp) {
  EndTracks(stamp);
  if (options_.mismatch_share > 0.0) {
    for (Track& track : tracks_) {
      if (random_.Uniform() < options_.mismatch_share) Mismatch(stamp, &track);
    }
  }
  StartTracks(stamp);
  TrackFrameSet set;
  set.timestamp = stamp;
  for (int camera = 0; camera < static_cast<int>(rig_.cameras.size()); ++camera) {
    TrackFrame frame;
    frame.timestamp = stamp;
    frame.camera = camera;
    frame.observations.reserve(tracks_.size());
    for (const Track& track : tracks_) {
      Eigen::Vector2d uv = track.uv;
      if (camera == 0 || See(camera, stamp, track.p_G, &uv)) {
        frame.observations.push_back(Noisy(track.id, uv));
      }
    }
    set.frames.push_back(std::move(frame));
  }
  return set;
}

}  // namespace duet
