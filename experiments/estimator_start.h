#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "backends/initialization/initialization.h"
#include "common/dataset/ground_truth.h"

namespace duet {

/// How an estimator gets its first state (--init): fitted to the truth's poses; standing still; the
/// true state itself, off by errors drawn from the start covariance (what NEES needs).
enum class StartMode { kGroundTruth, kRest, kDrawn };

/// Tries to find the first state at each frame until there is one; the same for all estimators.
class EstimatorStart {
 public:
  /// `truth` is needed by kGroundTruth only. `imu`: the whole recording's; a start from the truth
  /// fits velocity and biases to what lies on both sides of the first frame.
  EstimatorStart(StartMode mode, const EstimatorSetup& setup, const InitializationOptions& options,
                 std::vector<StampedPose> truth, const std::vector<ImuSample>& imu);
  /// kDrawn, with the errors of `seed`. `truth` is in the estimator's axes and has velocities and
  /// biases.
  EstimatorStart(const EstimatorSetup& setup, const InitializationOptions& options,
                 GroundTruth truth, std::uint64_t seed);

  /// The first state at these frames' instant, or nothing yet.
  [[nodiscard]] std::optional<InitialCondition> Try(const TrackFrameSet& frames);

  /// What was missing at the last try.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  [[nodiscard]] InitializationResult Draw(Timestamp instant) const;

  StartMode mode_;
  EstimatorSetup setup_;
  InitializationOptions options_;
  GroundTruth truth_;  ///< of kGroundTruth: its poses alone
  std::uint64_t seed_ = 0;
  ImuBuffer imu_;
  RestInitializer at_rest_;
  std::string reason_;
};

}  // namespace duet
