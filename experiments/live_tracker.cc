#include "experiments/live_tracker.h"

#include <utility>

#include "common/support/logging.h"

namespace duet {

LiveTracker::LiveTracker(std::vector<ImageFiles> files, const RigCalibration& rig,
                         const FrontendOptions& options, int max_tracks, std::uint64_t seed,
                         const std::vector<ImuSample>& imu, Observer observer)
    : imu_(imu),
      t_d_(ToNanoseconds(rig.t_d_s)),
      count_(static_cast<std::int64_t>(files.size())),
      images_(std::move(files), rig),
      frontend_(options, max_tracks, rig, seed),
      observer_(std::move(observer)) {
  frontend_.set_stage_timer(&stages_);
}

const TrackFrameSet* LiveTracker::Next() {
  const std::optional<ImageSet> images = images_.Next();
  for (; reported_drops_ < images_.dropped().size(); ++reported_drops_) {
    LOG(WARNING) << images_.dropped()[reported_drops_].path << ": cannot be read; left out";
  }
  if (!images) return nullptr;
  stages_.StartFrame();
  total_.StartFrame();
  decode_ms_ = images->decode_cpu_ms;
  const TrackFrameSet* tracks = nullptr;
  {
    const StageTimer::Scope scope(&total_, "tracking");
    while (next_imu_ < imu_.size() && imu_[next_imu_].timestamp <= images->timestamp + t_d_) {
      frontend_.AddImu(imu_[next_imu_++]);
    }
    tracks = &frontend_.Process(images->timestamp, images->images);
  }
  observer_(*tracks, *images);
  return tracks;
}

void LiveTracker::AddTiming(TimingLog* log) const {
  log->Add("decode", decode_ms_);
  log->Add("tracking", total_.stages().front().cpu_ms);
  log->Add("tracking", stages_.stages());
}

}  // namespace duet
