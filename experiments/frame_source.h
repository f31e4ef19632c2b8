#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/track_stream.h"
#include "experiments/timing_log.h"

namespace duet {

/// Where an estimator's frames come from: the live tracker or a recorded track stream. What comes
/// out is the same, float for float.
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;

  /// The next stamp's frames, null after the last; valid until the next call.
  virtual const TrackFrameSet* Next() = 0;
  /// How many there are, for showing progress.
  [[nodiscard]] virtual std::int64_t count() const = 0;
  /// Adds what the newest frame cost to the log's current row.
  virtual void AddTiming(TimingLog* /*log*/) const {}
};

/// A recorded stream, in memory.
class TrackReplay : public FrameSource {
 public:
  explicit TrackReplay(std::vector<TrackFrameSet> frames) : frames_(std::move(frames)) {}

  const TrackFrameSet* Next() override {
    return next_ < frames_.size() ? &frames_[next_++] : nullptr;
  }
  [[nodiscard]] std::int64_t count() const override {
    return static_cast<std::int64_t>(frames_.size());
  }

 private:
  std::vector<TrackFrameSet> frames_;
  std::size_t next_ = 0;
};

}  // namespace duet
