#pragma once

#include <optional>
#include <vector>

#include "common/dataset/track_stream.h"
#include "common/support/random.h"
#include "experiments/simulation/moving_camera.h"
#include "experiments/simulation/scene.h"

namespace duet {

struct SimulationOptions;

/// Makes the tracks of a recording, frame after frame.
class TrackSimulator {
 public:
  /// Keeps references to `options` and `scene`.
  TrackSimulator(const SimulationOptions& options, MovingCamera camera, const Scene& scene,
                 Random random);

  /// What the cameras see at the stamp; stamps ascend.
  [[nodiscard]] TrackFrameSet Observe(Timestamp stamp);

 private:
  struct Track {
    std::uint64_t id;
    ScenePoint point;
    Eigen::Vector2d uv;  // without noise, first camera
    bool weak = false;
    std::vector<Eigen::Vector2d> drift = {};  // a camera; empty without drift
  };

  // The pixel of a landmark; nothing where it is out of view or hidden.
  [[nodiscard]] std::optional<Eigen::Vector2d> See(int camera, Timestamp stamp,
                                                   const ScenePoint& point) const;
  // A landmark that is seen at `uv` in the first camera.
  [[nodiscard]] std::optional<ScenePoint> DrawPoint(Timestamp stamp, const Eigen::Vector2d& uv);
  void Drift();
  void EndTracks(Timestamp stamp);
  void StartTracks(Timestamp stamp);
  void Mismatch(Timestamp stamp, Track* track);
  [[nodiscard]] int CellOf(const Eigen::Vector2d& uv) const;
  [[nodiscard]] TrackObservation Noisy(const Track& track, int camera, const Eigen::Vector2d& uv);

  const SimulationOptions& options_;
  MovingCamera camera_;
  const Scene& scene_;
  Random random_;
  std::vector<Track> tracks_;  // ascending id
  std::vector<int> cell_counts_;
  std::uint64_t next_id_ = 1;
};

}  // namespace duet
