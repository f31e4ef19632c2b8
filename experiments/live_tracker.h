#pragma once

#include <functional>
#include <vector>

#include "common/imu/imu_sample.h"
#include "experiments/frame_source.h"
#include "frontend/frontend.h"
#include "frontend/image_source.h"

namespace duet {

/// The front end at work on a recording's images.
class LiveTracker : public FrameSource {
 public:
  /// What is to be done with each frame's tracks and images: writing, drawing.
  using Observer = std::function<void(const TrackFrameSet& tracks, const ImageSet& images)>;

  /// `imu` must outlive the tracker. `t_d_s`: as the recording tells it.
  LiveTracker(std::vector<ImageFiles> files, const RigCalibration& rig,
              const FrontendOptions& options, int max_tracks, std::uint64_t seed,
              const std::vector<ImuSample>& imu, Observer observer);

  const TrackFrameSet* Next() override;
  [[nodiscard]] std::int64_t count() const override { return count_; }
  void AddTiming(TimingLog* log) const override;

  [[nodiscard]] const FrontendStatistics& statistics() const { return frontend_.statistics(); }
  [[nodiscard]] const std::vector<DroppedImage>& dropped() const { return images_.dropped(); }

 private:
  const std::vector<ImuSample>& imu_;
  std::size_t next_imu_ = 0;
  Timestamp t_d_;
  std::int64_t count_;
  ImageSource images_;
  Frontend frontend_;
  Observer observer_;
  StageTimer stages_;
  StageTimer total_;
  double decode_ms_ = 0.0;
  std::size_t reported_drops_ = 0;
};

}  // namespace duet
