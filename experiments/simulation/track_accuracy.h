#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/dataset/track_stream.h"
#include "evaluation/statistics.h"
#include "experiments/simulation/render/true_camera.h"

namespace duet {

struct TrackAccuracyOptions {
  /// Observations this close to a depth edge (NearDepthEdge) are left out; a track that has once
  /// come so close is left out of the drift from then on. 0: none is.
  double edge_distance_px = 5.0;
  int max_age = 40;  ///< of the drift, frames
};

/// How far a front end's tracks are from the truth of the world that they were made in, px.
struct TrackAccuracyReport {
  /// From each frame to the next: the surface point that is truly seen at the track's pixel in the
  /// earlier one, seen in the later one, against the track's pixel there.
  ErrorSummary frame_to_frame;
  /// Entry n: the same over n frames, from the track's first pixel (n = 0 is empty).
  std::vector<ErrorSummary> drift;
  /// Pairs of neighbouring observations of a track, and the shares of them that are left out: for a
  /// depth edge close to either; for want of a truth (the world ends, or the point went out of
  /// view behind another surface).
  int pairs = 0;
  double edge_share = 0.0;
  double hidden_share = 0.0;
};

/// Judges the tracks of one camera by the true geometry, frame after frame.
class TrackAccuracy {
 public:
  /// `truth` must outlive this. Its shutter decides what tracks are held against: kAsItIs for how
  /// good they are, kMiddleRow for what it costs to take a rolling shutter for a global one.
  TrackAccuracy(const TrueCamera* truth, int camera, const TrackAccuracyOptions& options);

  /// In order of time.
  void Add(const TrackFrame& frame);
  [[nodiscard]] TrackAccuracyReport Report() const;

 private:
  struct Sighting {
    Timestamp stamp = 0;
    std::optional<SurfacePoint> point;
    bool near_edge = false;
  };
  struct Track {
    Sighting first, newest;
    int age = 0;
    bool was_near_edge = false;
  };

  [[nodiscard]] Sighting Look(Timestamp stamp, const Eigen::Vector2d& uv) const;
  // The distance of `uv` from where the point is seen; nothing where it is not.
  [[nodiscard]] std::optional<double> Error(Timestamp stamp,
                                            const std::optional<SurfacePoint>& point,
                                            const Eigen::Vector2d& uv) const;

  const TrueCamera* truth_;
  int camera_;
  TrackAccuracyOptions options_;
  std::map<std::uint64_t, Track> tracks_;  // of the newest frame
  std::vector<double> errors_;
  std::vector<std::vector<double>> drift_;  // by age
  int pairs_ = 0;
  int at_edge_ = 0;
  int hidden_ = 0;
};

}  // namespace duet
