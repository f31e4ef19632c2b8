#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backends/initialization/initialization.h"

namespace duet {

/// How an estimator gets its first state (--init).
enum class StartMode { kGroundTruth, kRest };

/// Tries to find the first state at each frame until there is one; the same for all estimators.
class EstimatorStart {
 public:
  /// `truth` is needed by kGroundTruth only. `imu`: the whole recording's; a start from the truth
  /// fits velocity and biases to what lies on both sides of the first frame.
  EstimatorStart(StartMode mode, const EstimatorSetup& setup, const InitializationOptions& options,
                 std::vector<StampedPose> truth, const std::vector<ImuSample>& imu);

  /// The first state at these frames' instant, or nothing yet.
  [[nodiscard]] std::optional<InitialCondition> Try(const TrackFrameSet& frames);

  /// What was missing at the last try.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  StartMode mode_;
  EstimatorSetup setup_;
  InitializationOptions options_;
  std::vector<StampedPose> truth_;
  ImuBuffer imu_;
  RestInitializer at_rest_;
  std::string reason_;
};

}  // namespace duet
