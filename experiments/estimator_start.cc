#include "experiments/estimator_start.h"

#include <utility>

#include "experiments/record_reader.h"
#include "experiments/simulation/monte_carlo.h"

namespace duet {

EstimatorStart::EstimatorStart(StartMode mode, const EstimatorSetup& setup,
                               const InitializationOptions& options, std::vector<StampedPose> truth,
                               const std::vector<ImuSample>& imu)
    : mode_(mode),
      setup_(setup),
      options_(options),
      truth_{.poses = std::move(truth), .velocities = {}, .biases = {}},
      at_rest_(setup, options),
      reason_("there was no frame") {
  for (const ImuSample& sample : imu) imu_.Add(sample);
}

EstimatorStart::EstimatorStart(const EstimatorSetup& setup, const InitializationOptions& options,
                               GroundTruth truth, std::uint64_t seed)
    : mode_(StartMode::kDrawn),
      setup_(setup),
      options_(options),
      truth_(std::move(truth)),
      seed_(seed),
      at_rest_(setup, options),
      reason_("there was no frame") {}

InitializationResult EstimatorStart::Draw(Timestamp instant) const {
  const std::optional<InertialState> truth = TruthStateAt(truth_, instant);
  if (!truth) return InitializationFailure{"the truth does not cover the frame"};
  return DrawStart(*truth, options_, 1.0, seed_);
}

std::optional<InitialCondition> EstimatorStart::Try(const TrackFrameSet& frames) {
  const Timestamp instant = frames.timestamp + ToNanoseconds(setup_.rig.t_d_s);
  InitializationResult result =
      mode_ == StartMode::kDrawn ? Draw(instant)
      : mode_ == StartMode::kGroundTruth
          ? InitializeFromPoses(truth_.poses, imu_, instant, setup_, options_)
          : at_rest_.Update(frames, imu_);
  if (const auto* failure = std::get_if<InitializationFailure>(&result)) {
    reason_ = failure->reason;
    return std::nullopt;
  }
  return std::get<InitialCondition>(std::move(result));
}

}  // namespace duet
