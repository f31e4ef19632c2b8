#include "frontend/track_history.h"

#include <utility>

namespace duet {

void TrackHistory::Push(const Eigen::Matrix3d& R_C1C0, std::span<const Entry> tracks) {
  if (length_ == 0) return;
  Frame frame;
  if (frames_.size() == length_) {  // reuses the oldest one's memory
    frame = std::move(frames_.front());
    frames_.pop_front();
  }
  frame.R_C1C0 = R_C1C0;
  frame.tracks.assign(tracks.begin(), tracks.end());
  frames_.push_back(std::move(frame));
}

Eigen::Matrix3d TrackHistory::PairWithOldest(const Eigen::Matrix3d& R_C1C0,
                                             std::span<const Entry> tracks,
                                             std::vector<RayPair>* pairs,
                                             std::vector<std::size_t>* indices) const {
  pairs->clear();
  indices->clear();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (length_ == 0 || frames_.size() < length_) return R;
  for (std::size_t i = 1; i < frames_.size(); ++i) R = frames_[i].R_C1C0 * R;
  R = R_C1C0 * R;
  auto past = frames_.front().tracks.begin();
  const auto end = frames_.front().tracks.end();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    while (past != end && past->id < tracks[i].id) ++past;
    if (past == end) break;
    if (past->id != tracks[i].id) continue;
    pairs->push_back({past->ray, tracks[i].ray});
    indices->push_back(i);
  }
  return R;
}

}  // namespace duet
