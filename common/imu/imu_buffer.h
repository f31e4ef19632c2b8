#pragma once

#include <deque>
#include <vector>

#include "common/imu/imu_sample.h"

namespace duet {

/// Samples in order of time, kept as long as an estimator may ask for them.
class ImuBuffer {
 public:
  /// CHECKs that stamps increase strictly (readers have refused anything else).
  void Add(const ImuSample& sample);
  /// Forgets samples that no interval from `t` on needs (the last one at or before `t` stays).
  void DropBefore(Timestamp t);

  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] Timestamp first() const { return samples_.front().timestamp; }
  [[nodiscard]] Timestamp last() const { return samples_.back().timestamp; }
  [[nodiscard]] const std::deque<ImuSample>& samples() const { return samples_; }

  /// True where `t0` and `t1` (in either order) lie within the samples.
  [[nodiscard]] bool Covers(Timestamp t0, Timestamp t1) const;
  /// The longest time between neighbouring samples that touch [t0, t1], s.
  [[nodiscard]] double LongestGap(Timestamp t0, Timestamp t1) const;

  /// The reading at `t`, linear between its neighbours. CHECKs Covers(t, t).
  [[nodiscard]] ImuSample At(Timestamp t) const;

  /// Replaces *out by the readings at t0, at every sample strictly between, and at t1; in
  /// descending order where t1 < t0; one reading where they are equal. CHECKs Covers(t0, t1).
  void Extract(Timestamp t0, Timestamp t1, std::vector<ImuSample>* out) const;

 private:
  std::deque<ImuSample> samples_;
};

}  // namespace duet
