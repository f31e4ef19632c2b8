#pragma once

#include <vector>

#include "backends/estimator.h"

namespace duet {

/// Hands a recording's IMU to an estimator, ahead of its frames.
class ImuFeed {
 public:
  /// `samples` must outlive it.
  explicit ImuFeed(const std::vector<ImuSample>& samples) : samples_(samples) {}

  /// Up to an instant and the one sample after it.
  void Advance(Timestamp until, Estimator* estimator) {
    while (next_ < samples_.size() && !Reached(until)) estimator->AddImu(samples_[next_++]);
  }

 private:
  [[nodiscard]] bool Reached(Timestamp until) const {
    return next_ > 0 && samples_[next_ - 1].timestamp >= until;
  }

  const std::vector<ImuSample>& samples_;
  std::size_t next_ = 0;
};

}  // namespace duet
