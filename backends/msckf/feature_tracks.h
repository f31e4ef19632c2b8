#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/dataset/track_stream.h"

namespace duet {

/// One observation of a track, in the frame of a clone.
struct ClonedObservation {
  std::uint64_t clone_id = 0;
  int camera = 0;
  float u = 0.0F;  ///< raw px
  float v = 0.0F;
};

/// A landmark's observations that have not been used yet, ascending by clone, then camera.
struct FeatureTrack {
  std::uint64_t track_id = 0;
  bool alive = true;  ///< seen in the newest frame
  std::vector<ClonedObservation> observations;
};

/// The tracks that clones of the window saw, in ascending order of track id. Every observation is
/// in here from the frame in which it came until it is used, or its clone dropped. Memory is reused
/// from track to track.
class FeatureTracks {
 public:
  /// Takes the frames of the clone that was just made. A track that no camera saw has ended
  /// (`alive` is false). Returns the number of observations.
  int Add(const TrackFrameSet& frames, std::uint64_t clone_id);

  [[nodiscard]] int size() const { return static_cast<int>(active_.size()); }
  [[nodiscard]] FeatureTrack& operator[](int i) { return pool_[active_[i]]; }
  [[nodiscard]] const FeatureTrack& operator[](int i) const { return pool_[active_[i]]; }

  /// Its observations were used, or refused: none of them will be used again. A live track goes on
  /// as a new landmark from its next observation.
  void Consume(int i);
  /// Forgets the observations of a clone that leaves the window.
  void RemoveClone(std::uint64_t clone_id);
  /// Forgets the tracks that have ended.
  void RemoveEnded();
  /// True where a track has an observation in the clone.
  [[nodiscard]] bool Sees(std::uint64_t clone_id) const;

 private:
  int Create(std::uint64_t track_id);

  std::vector<FeatureTrack> pool_;
  std::vector<int> free_;
  std::vector<int> active_;        // into pool_, ascending track id
  std::vector<int> next_active_;   // scratch
  std::vector<std::size_t> next_;  // scratch: next observation of each camera's frame
};

}  // namespace duet
