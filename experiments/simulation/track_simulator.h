#pragma once

#include <vector>

#include "common/dataset/track_stream.h"
#include "common/measurement/calibration.h"
#include "common/support/random.h"
#include "experiments/simulation/trajectory.h"

namespace duet {

struct SimulationOptions;

/// A box with points on its walls, m in G.
struct Room {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

/// Makes the tracks of a recording, frame after frame.
class TrackSimulator {
 public:
  /// Keeps references to `trajectory`.
  TrackSimulator(const SimulationOptions& options, const RigCalibration& rig,
                 const Trajectory& trajectory, Timestamp start, const Room& room, Random random);

  /// What the cameras see at the stamp; stamps ascend.
  [[nodiscard]] TrackFrameSet Observe(Timestamp stamp);

 private:
  struct Track {
    std::uint64_t id;
    Eigen::Vector3d p_G;
    Eigen::Vector2d uv;  // without noise, first camera
  };

  // The camera's pose T_CG at the instant at which its row (or column) `uv` was read.
  [[nodiscard]] Pose CameraPoseAt(int camera, Timestamp stamp, const Eigen::Vector2d& uv) const;
  // The pixel of a point, its row solved for; false where it is out of view.
  [[nodiscard]] bool See(int camera, Timestamp stamp, const Eigen::Vector3d& p_G,
                         Eigen::Vector2d* uv) const;
  // A point of the room that is seen at `uv` in the first camera; false where none is.
  [[nodiscard]] bool DrawPoint(Timestamp stamp, const Eigen::Vector2d& uv, Eigen::Vector3d* p_G);
  void EndTracks(Timestamp stamp);
  void StartTracks(Timestamp stamp);
  void Mismatch(Timestamp stamp, Track* track);
  [[nodiscard]] int CellOf(const Eigen::Vector2d& uv) const;
  [[nodiscard]] TrackObservation Noisy(std::uint64_t id, const Eigen::Vector2d& uv);

  const SimulationOptions& options_;
  RigCalibration rig_;
  const Trajectory& trajectory_;
  Timestamp start_;
  Room room_;
  Random random_;
  std::vector<double> max_radius_;  // of (x/z, y/z) in view, a camera
  std::vector<Track> tracks_;       // ascending id
  std::vector<int> cell_counts_;
  std::uint64_t next_id_ = 1;
};

}  // namespace duet
