#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "frontend/outlier_rejection.h"

namespace duet {

/// Where the tracks of one camera were in the last frames, for tests against a frame some way back.
class TrackHistory {
 public:
  struct Entry {
    std::uint64_t id = 0;
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();  // (x, y, 1)
  };

  /// Remembers `length` frames.
  explicit TrackHistory(int length) : length_(static_cast<std::size_t>(length)) {}

  /// The newest frame's tracks, ascending by id; R_C1C0: the rotation to it from the frame before.
  void Push(const Eigen::Matrix3d& R_C1C0, std::span<const Entry> tracks);

  /// Pairs of `tracks` (ascending by id, of a frame that is not pushed yet; R_C1C0 as for Push)
  /// with the frame `length` before it; `indices` say which of `tracks` they are. The rotation
  /// between the two frames is the product of those pushed. Empty while the history is shorter.
  Eigen::Matrix3d PairWithOldest(const Eigen::Matrix3d& R_C1C0, std::span<const Entry> tracks,
                                 std::vector<RayPair>* pairs,
                                 std::vector<std::size_t>* indices) const;

 private:
  struct Frame {
    Eigen::Matrix3d R_C1C0;
    std::vector<Entry> tracks;
  };
  std::size_t length_;
  std::deque<Frame> frames_;
};

}  // namespace duet
