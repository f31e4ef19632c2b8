#include "backends/msckf/feature_tracks.h"

#include <algorithm>
#include <limits>

namespace duet {

int FeatureTracks::Create(std::uint64_t track_id) {
  int slot = 0;
  if (free_.empty()) {
    slot = static_cast<int>(pool_.size());
    pool_.emplace_back();
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  FeatureTrack& track = pool_[slot];
  track.track_id = track_id;
  track.observations.clear();
  return slot;
}

int FeatureTracks::Add(const TrackFrameSet& frames, std::uint64_t clone_id) {
  constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
  next_.assign(frames.frames.size(), 0);
  next_active_.clear();
  std::size_t known = 0;
  int count = 0;
  // A merge of the known tracks and of the cameras' frames, all ascending by track id.
  while (true) {
    std::uint64_t seen_id = kNone;
    for (std::size_t c = 0; c < next_.size(); ++c) {
      const auto& observations = frames.frames[c].observations;
      if (next_[c] < observations.size()) {
        seen_id = std::min(seen_id, observations[next_[c]].track_id);
      }
    }
    const std::uint64_t known_id = known < active_.size() ? pool_[active_[known]].track_id : kNone;
    if (seen_id == kNone && known == active_.size()) break;
    const bool is_known = known < active_.size() && known_id <= seen_id;
    const int slot = is_known ? active_[known++] : Create(seen_id);
    next_active_.push_back(slot);
    FeatureTrack& track = pool_[slot];
    track.alive = track.track_id == seen_id;
    if (!track.alive) continue;
    for (std::size_t c = 0; c < next_.size(); ++c) {
      const auto& observations = frames.frames[c].observations;
      if (next_[c] >= observations.size() || observations[next_[c]].track_id != seen_id) continue;
      const TrackObservation& observation = observations[next_[c]++];
      track.observations.push_back(
          {clone_id, frames.frames[c].camera, observation.u, observation.v});
      ++count;
    }
  }
  active_.swap(next_active_);
  return count;
}

void FeatureTracks::Consume(int i) { pool_[active_[i]].observations.clear(); }

void FeatureTracks::RemoveClone(std::uint64_t clone_id) {
  for (const int slot : active_) {
    std::erase_if(pool_[slot].observations,
                  [&](const ClonedObservation& o) { return o.clone_id == clone_id; });
  }
}

void FeatureTracks::RemoveEnded() {
  std::erase_if(active_, [&](int slot) {
    if (pool_[slot].alive) return false;
    free_.push_back(slot);
    return true;
  });
}

bool FeatureTracks::Sees(std::uint64_t clone_id) const {
  return std::any_of(active_.begin(), active_.end(), [&](int slot) {
    const auto& observations = pool_[slot].observations;
    return std::any_of(observations.begin(), observations.end(),
                       [&](const ClonedObservation& o) { return o.clone_id == clone_id; });
  });
}

}  // namespace duet
