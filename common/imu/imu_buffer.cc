#include "common/imu/imu_buffer.h"

#include <algorithm>

#include "common/support/logging.h"

namespace duet {
namespace {

// First sample at or after t.
template <class Samples>
auto LowerBound(const Samples& samples, Timestamp t) {
  return std::lower_bound(samples.begin(), samples.end(), t,
                          [](const ImuSample& s, Timestamp at) { return s.timestamp < at; });
}

// First sample after t.
template <class Samples>
auto UpperBound(const Samples& samples, Timestamp t) {
  return std::upper_bound(samples.begin(), samples.end(), t,
                          [](Timestamp at, const ImuSample& s) { return at < s.timestamp; });
}

}  // namespace

void ImuBuffer::Add(const ImuSample& sample) {
  CHECK(samples_.empty() || samples_.back().timestamp < sample.timestamp)
      << "IMU samples must come in order";
  samples_.push_back(sample);
}

void ImuBuffer::DropBefore(Timestamp t) {
  while (samples_.size() > 1 && samples_[1].timestamp <= t) samples_.pop_front();
}

bool ImuBuffer::Covers(Timestamp t0, Timestamp t1) const {
  return !samples_.empty() && first() <= std::min(t0, t1) && std::max(t0, t1) <= last();
}

double ImuBuffer::LongestGap(Timestamp t0, Timestamp t1) const {
  if (samples_.size() < 2) return 0.0;
  if (t1 < t0) std::swap(t0, t1);
  auto it = UpperBound(samples_, t0);
  if (it != samples_.begin()) --it;
  Timestamp gap = 0;
  for (auto next = it; it != samples_.end() && it->timestamp < t1; it = next) {
    if (++next == samples_.end()) break;
    gap = std::max(gap, next->timestamp - it->timestamp);
  }
  return SecondsBetween(0, gap);
}

ImuSample ImuBuffer::At(Timestamp t) const {
  CHECK(Covers(t, t)) << "no IMU at " << t;
  const auto after = LowerBound(samples_, t);
  if (after->timestamp == t) return *after;
  const auto before = after - 1;
  const double w =
      SecondsBetween(before->timestamp, t) / SecondsBetween(before->timestamp, after->timestamp);
  return {t, (1.0 - w) * before->omega_m + w * after->omega_m,
          (1.0 - w) * before->a_m + w * after->a_m};
}

void ImuBuffer::Extract(Timestamp t0, Timestamp t1, std::vector<ImuSample>* out) const {
  out->clear();
  out->push_back(At(t0));
  if (t0 == t1) return;
  const Timestamp low = std::min(t0, t1);
  const Timestamp high = std::max(t0, t1);
  const auto begin = UpperBound(samples_, low);
  const auto end = LowerBound(samples_, high);
  if (t0 < t1) {
    for (auto it = begin; it < end; ++it) out->push_back(*it);
  } else {
    for (auto it = end; it > begin; --it) out->push_back(*(it - 1));
  }
  out->push_back(At(t1));
}

}  // namespace duet
