#include "experiments/simulation/track_simulator.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/simulation/simulator.h"

namespace duet {
namespace {

constexpr int kGridColumns = 10;
constexpr int kGridRows = 6;

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
                               const Trajectory& trajectory, Timestamp start, const Scene& scene,
                               Random random)
    : options_(options),
      rig_(rig),
      trajectory_(trajectory),
      start_(start),
      scene_(scene),
      random_(random),
      cell_counts_(kGridColumns * kGridRows) {
  for (const CameraCalibration& camera : rig_.cameras) {
    max_radius_.push_back(LargestRadius(camera.model));
  }
}

double TrackSimulator::TimeOf(int camera, Timestamp stamp, const Eigen::Vector2d& uv) const {
  const CameraModel& model = rig_.cameras[static_cast<std::size_t>(camera)].model;
  const double count = rig_.readout_by_columns ? model.width_px() : model.height_px();
  const double line = rig_.readout_by_columns ? uv.x() : uv.y();
  const double delay_s = rig_.t_d_s + (line - 0.5 * (count - 1.0)) * rig_.t_r_s / count;
  return SecondsBetween(start_, stamp) + delay_s;
}

Pose TrackSimulator::CameraPoseAt(int camera, double t_s) const {
  const CameraCalibration& calibration = rig_.cameras[static_cast<std::size_t>(camera)];
  return Pose{calibration.R_CB, calibration.p_CB} * trajectory_.At(t_s).T_GB.Inverse();
}

bool TrackSimulator::See(int camera, Timestamp stamp, const ScenePoint& point,
                         Eigen::Vector2d* uv) const {
  const CameraModel& model = rig_.cameras[static_cast<std::size_t>(camera)].model;
  Eigen::Vector2d pixel(0.5 * (model.width_px() - 1), 0.5 * (model.height_px() - 1));
  // The row decides about the pose and the pose about the row; each round takes the error down by
  // the share of the readout that the image moves in, a few percent.
  const int rounds = rig_.t_r_s == 0.0 ? 1 : 8;
  for (int i = 0; i < rounds; ++i) {
    const double t_s = TimeOf(camera, stamp, pixel);
    const Eigen::Vector3d p_C = CameraPoseAt(camera, t_s) * scene_.PositionAt(point, t_s);
    if (p_C.z() < 0.05) return false;
    if (p_C.head<2>().norm() > max_radius_[static_cast<std::size_t>(camera)] * p_C.z()) {
      return false;
    }
    if (!model.Project(p_C, &pixel)) return false;
  }
  *uv = pixel;
  if (!model.Contains(pixel)) return false;
  const double t_s = TimeOf(camera, stamp, pixel);
  return scene_.Sees(CameraPoseAt(camera, t_s).Inverse().p, point, t_s);
}

std::optional<ScenePoint> TrackSimulator::DrawPoint(Timestamp stamp, const Eigen::Vector2d& uv) {
  const auto ray_C = rig_.cameras[0].model.Unproject(uv);
  if (!ray_C) return std::nullopt;
  const double t_s = TimeOf(0, stamp, uv);
  const Pose T_GC = CameraPoseAt(0, t_s).Inverse();
  return scene_.Draw(T_GC.p, T_GC.R * *ray_C, t_s, &random_);
}

int TrackSimulator::CellOf(const Eigen::Vector2d& uv) const {
  const CameraModel& model = rig_.cameras[0].model;
  const int column = static_cast<int>((uv.x() + 0.5) * kGridColumns / model.width_px());
  const int row = static_cast<int>((uv.y() + 0.5) * kGridRows / model.height_px());
  return std::clamp(row, 0, kGridRows - 1) * kGridColumns + std::clamp(column, 0, kGridColumns - 1);
}

void TrackSimulator::EndTracks(Timestamp stamp) {
  std::size_t kept = 0;
  for (Track& track : tracks_) {
    const double mean_frames = track.weak ? options_.weak_track_frames : options_.mean_track_frames;
    const bool ends = random_.Uniform() < 1.0 / mean_frames;
    if (ends || !See(0, stamp, track.point, &track.uv)) continue;
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
    const auto point = DrawPoint(stamp, track.uv);
    if (!point) continue;
    track.point = *point;
    track.weak = options_.weak_share > 0.0 && random_.Uniform() < options_.weak_share;
    track.id = next_id_++;
    tracks_.push_back(track);
  }
}

void TrackSimulator::Mismatch(Timestamp stamp, Track* track) {
  const double angle = random_.Uniform(0.0, 2.0 * std::numbers::pi);
  const double throw_px = random_.Uniform(5.0, options_.outlier_px);
  const Eigen::Vector2d uv =
      track->uv + throw_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  if (!rig_.cameras[0].model.Contains(uv)) return;
  if (const auto point = DrawPoint(stamp, uv)) {
    track->point = *point;
    track->uv = uv;
  }
}

TrackObservation TrackSimulator::Noisy(std::uint64_t id, const Eigen::Vector2d& uv) {
  const double sigma_px = options_.noise_scale * options_.pixel_noise_px;
  Eigen::Vector2d noisy = uv + sigma_px * random_.NormalVector<2>();
  if (options_.outlier_share > 0.0 && random_.Uniform() < options_.outlier_share) {
    const double angle = random_.Uniform(0.0, 2.0 * std::numbers::pi);
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
      if (camera == 0 || See(camera, stamp, track.point, &uv)) {
        frame.observations.push_back(Noisy(track.id, uv));
      }
    }
    set.frames.push_back(std::move(frame));
  }
  return set;
}

}  // namespace duet
