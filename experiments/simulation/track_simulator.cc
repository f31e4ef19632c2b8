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

}  // namespace

TrackSimulator::TrackSimulator(const SimulationOptions& options, MovingCamera camera,
                               const Scene& scene, Random random)
    : options_(options),
      camera_(std::move(camera)),
      scene_(scene),
      random_(random),
      cell_counts_(kGridColumns * kGridRows) {}

std::optional<Eigen::Vector2d> TrackSimulator::See(int camera, Timestamp stamp,
                                                   const ScenePoint& point) const {
  const auto uv = camera_.PixelOf(
      camera, stamp, [this, &point](double t_s) { return scene_.PositionAt(point, t_s); });
  if (!uv || !camera_.model(camera).Contains(*uv)) return std::nullopt;
  const double t_s = camera_.TimeOf(camera, stamp, *uv);
  if (!scene_.Sees(camera_.PoseAt(camera, t_s).Inverse().p, point, t_s)) return std::nullopt;
  return uv;
}

std::optional<ScenePoint> TrackSimulator::DrawPoint(Timestamp stamp, const Eigen::Vector2d& uv) {
  const auto ray_C = camera_.model(0).Unproject(uv);
  if (!ray_C) return std::nullopt;
  const double t_s = camera_.TimeOf(0, stamp, uv);
  const Pose T_GC = camera_.PoseAt(0, t_s).Inverse();
  return scene_.Draw(T_GC.p, T_GC.R * *ray_C, t_s, &random_);
}

int TrackSimulator::CellOf(const Eigen::Vector2d& uv) const {
  const CameraModel& model = camera_.model(0);
  const int column = static_cast<int>((uv.x() + 0.5) * kGridColumns / model.width_px());
  const int row = static_cast<int>((uv.y() + 0.5) * kGridRows / model.height_px());
  return std::clamp(row, 0, kGridRows - 1) * kGridColumns + std::clamp(column, 0, kGridColumns - 1);
}

void TrackSimulator::EndTracks(Timestamp stamp) {
  std::size_t kept = 0;
  for (Track& track : tracks_) {
    const double mean_frames = track.weak ? options_.weak_track_frames : options_.mean_track_frames;
    const bool ends = random_.Uniform() < 1.0 / mean_frames;
    if (ends) continue;
    const auto uv = See(0, stamp, track.point);
    if (!uv) continue;
    track.uv = *uv;
    tracks_[kept++] = track;
  }
  tracks_.resize(kept);
}

void TrackSimulator::StartTracks(Timestamp stamp) {
  const CameraModel& model = camera_.model(0);
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
  if (!camera_.model(0).Contains(uv)) return;
  if (const auto point = DrawPoint(stamp, uv)) {
    track->point = *point;
    track->uv = uv;
  }
}

void TrackSimulator::Drift() {
  const double sigma_px = options_.noise_scale * options_.pixel_drift_px;
  if (sigma_px == 0.0) return;
  for (Track& track : tracks_) {
    track.drift.resize(camera_.rig().cameras.size(), Eigen::Vector2d::Zero());
    for (Eigen::Vector2d& drift : track.drift) drift += sigma_px * random_.NormalVector<2>();
  }
}

TrackObservation TrackSimulator::Noisy(const Track& track, int camera, const Eigen::Vector2d& uv) {
  const double sigma_px = options_.noise_scale * options_.pixel_noise_px;
  Eigen::Vector2d noisy = uv + sigma_px * random_.NormalVector<2>();
  if (!track.drift.empty()) noisy += track.drift[static_cast<std::size_t>(camera)];
  if (options_.outlier_share > 0.0 && random_.Uniform() < options_.outlier_share) {
    const double angle = random_.Uniform(0.0, 2.0 * std::numbers::pi);
    const double throw_px = random_.Uniform(5.0, options_.outlier_px);
    noisy += throw_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return {
      .track_id = track.id, .u = static_cast<float>(noisy.x()), .v = static_cast<float>(noisy.y())};
}

TrackFrameSet TrackSimulator::Observe(Timestamp stamp) {
  EndTracks(stamp);
  Drift();
  if (options_.mismatch_share > 0.0) {
    for (Track& track : tracks_) {
      if (random_.Uniform() < options_.mismatch_share) Mismatch(stamp, &track);
    }
  }
  StartTracks(stamp);
  TrackFrameSet set;
  set.timestamp = stamp;
  for (int camera = 0; camera < static_cast<int>(camera_.rig().cameras.size()); ++camera) {
    TrackFrame frame;
    frame.timestamp = stamp;
    frame.camera = camera;
    frame.observations.reserve(tracks_.size());
    for (const Track& track : tracks_) {
      const std::optional<Eigen::Vector2d> uv =
          camera == 0 ? track.uv : See(camera, stamp, track.point);
      if (uv) frame.observations.push_back(Noisy(track, camera, *uv));
    }
    set.frames.push_back(std::move(frame));
  }
  return set;
}

}  // namespace duet
