#include "experiments/estimator_start.h"

#include <utility>

namespace duet {

EstimatorStart::EstimatorStart(StartMode mode, const EstimatorSetup& setup,
                               const InitializationOptions& options, std::vector<StampedPose> truth,
                               const std::vector<ImuSample>& imu)
    : mode_(mode),
      setup_(setup),
      options_(options),
      truth_(std::move(truth)),
      at_rest_(setup, options),
      reason_("there was no frame") {
  for (const ImuSample& sample : imu) imu_.Add(sample);
}

std::optional<InitialCondition> EstimatorStart::Try(const TrackFrameSet& frames) {
  const Timestamp instant = frames.timestamp + ToNanoseconds(setup_.rig.t_d_s);
  InitializationResult result = mode_ == StartMode::kGroundTruth
                                    ? InitializeFromPoses(truth_, imu_, instant, setup_, options_)
                                    : at_rest_.Update(frames, imu_);
  if (const auto* failure = std::get_if<InitializationFailure>(&result)) {
    reason_ = failure->reason;
    return std::nullopt;
  }
  return std::get<InitialCondition>(std::move(result));
}

}  // namespace duet
