#pragma once

#include <vector>

#include "common/dataset/track_stream.h"
#include "common/measurement/calibration.h"
#include "common/support/random.h"
#include "experiments/simulation/scene.h"
#include "experiments/simulation/trajectory.h"

namespace duet {

struct SimulationOptions;

/// Makes the tracks of a recording, frame after frame.
class TrackSimulator {
 public:
  /// Keeps references to `options`, `trajectory` and `scene`.
  TrackSimulator(const SimulationOptions& options, const RigCalibration& rig,
                 const Trajectory& trajectory, Timestamp start, const Scene& scene, Random random);

  /// What the cameras see at the stamp; stamps ascend.
  [[nodiscard]] TrackFrameSet Observe(Timestamp stamp);

 private:
  struct Track {
    std::uint64_t id;
    ScenePoint point;
    Eigen::Vector2d uv;  // without noise, first camera
    bool weak = false;
  };

  // When the row (or column) of `uv` was read, s of the trajectory.
  [[nodiscard]] double TimeOf(int camera, Timestamp stamp, const Eigen::Vector2d& uv) const;
  // T_CG then.
  [[nodiscard]] Pose CameraPoseAt(int camera, double t_s) const;
  // The pixel of a landmark, its row solved for; false where it is out of view or hidden.
  [[nodiscard]] bool See(int camera, Timestamp stamp, const ScenePoint& point,
                         Eigen::Vector2d* uv) const;
  // A landmark that is seen at `uv` in the first camera.
  [[nodiscard]] std::optional<ScenePoint> DrawPoint(Timestamp stamp, const Eigen::Vector2d& uv);
  void EndTracks(Timestamp stamp);
  void StartTracks(Timestamp stamp);
  void Mismatch(Timestamp stamp, Track* track);
  [[nodiscard]] int CellOf(const Eigen::Vector2d& uv) const;
  [[nodiscard]] TrackObservation Noisy(std::uint64_t id, const Eigen::Vector2d& uv);

  const SimulationOptions& options_;
  RigCalibration rig_;
  const Trajectory& trajectory_;
  Timestamp start_;
  const Scene& scene_;
  Random random_;
  std::vector<double> max_radius_;  // of (x/z, y/z) in view, a camera
  std::vector<Track> tracks_;       // ascending id
  std::vector<int> cell_counts_;
  std::uint64_t next_id_ = 1;
};

}  // namespace duet
