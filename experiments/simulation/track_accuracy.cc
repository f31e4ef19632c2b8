#include "experiments/simulation/track_accuracy.h"

#include <utility>

#include "common/support/logging.h"
#include "experiments/simulation/depth_edge.h"

namespace duet {

TrackAccuracy::TrackAccuracy(const TrueCamera* truth, int camera,
                             const TrackAccuracyOptions& options)
    : truth_(truth),
      camera_(camera),
      options_(options),
      drift_(static_cast<std::size_t>(options.max_age) + 1) {
  CHECK(truth_ != nullptr);
}

TrackAccuracy::Sighting TrackAccuracy::Look(Timestamp stamp, const Eigen::Vector2d& uv) const {
  Sighting sighting;
  sighting.stamp = stamp;
  sighting.point = truth_->PointAt(camera_, stamp, uv);
  sighting.near_edge = options_.edge_distance_px > 0.0 &&
                       NearDepthEdge(*truth_, camera_, stamp, uv, options_.edge_distance_px);
  return sighting;
}

std::optional<double> TrackAccuracy::Error(Timestamp stamp,
                                           const std::optional<SurfacePoint>& point,
                                           const Eigen::Vector2d& uv) const {
  if (!point) return std::nullopt;
  const auto true_uv = truth_->PixelOf(camera_, stamp, *point);
  if (!true_uv || !truth_->IsVisible(camera_, stamp, *point, *true_uv)) return std::nullopt;
  return (uv - *true_uv).norm();
}

void TrackAccuracy::Add(const TrackFrame& frame) {
  CHECK_EQ(frame.camera, camera_);
  std::map<std::uint64_t, Track> tracks;
  for (const TrackObservation& observation : frame.observations) {
    const Eigen::Vector2d uv(observation.u, observation.v);
    const Sighting sighting = Look(frame.timestamp, uv);
    const auto known = tracks_.find(observation.track_id);
    if (known == tracks_.end()) {
      tracks[observation.track_id] = {
          .first = sighting, .newest = sighting, .age = 0, .was_near_edge = sighting.near_edge};
      continue;
    }
    Track track = known->second;
    ++pairs_;
    if (track.newest.near_edge || sighting.near_edge) {
      ++at_edge_;
    } else if (const auto error = Error(frame.timestamp, track.newest.point, uv)) {
      errors_.push_back(*error);
    } else {
      ++hidden_;
    }
    ++track.age;
    track.was_near_edge = track.was_near_edge || sighting.near_edge;
    if (!track.was_near_edge && track.age <= options_.max_age) {
      const auto error = Error(frame.timestamp, track.first.point, uv);
      if (error) drift_[static_cast<std::size_t>(track.age)].push_back(*error);
    }
    track.newest = sighting;
    tracks[observation.track_id] = std::move(track);
  }
  tracks_ = std::move(tracks);
}

TrackAccuracyReport TrackAccuracy::Report() const {
  TrackAccuracyReport report;
  report.frame_to_frame = Summarize(errors_);
  for (const std::vector<double>& errors : drift_) report.drift.push_back(Summarize(errors));
  report.pairs = pairs_;
  if (pairs_ > 0) {
    report.edge_share = static_cast<double>(at_edge_) / pairs_;
    report.hidden_share = static_cast<double>(hidden_) / pairs_;
  }
  return report;
}

}  // namespace duet
