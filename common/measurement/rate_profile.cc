#include "common/measurement/rate_profile.h"

#include <algorithm>

#include "common/imu/motion_increment.h"
#include "common/support/logging.h"

namespace duet {
namespace {

ImuRates RatesOf(const RateProfile::Motion& motion) { return {motion.omega_B, motion.a_B}; }

// Takes `from` to `end` over h_s with the rates linear between both.
RateProfile::Motion Step(const RateProfile::Motion& from, const ImuRates& end, double h_s) {
  MotionIncrement increment{from.R, from.s, from.y};
  RungeKuttaStep(RatesOf(from), end, h_s, &increment);
  return {increment.R, increment.s, increment.y, end.omega_B, end.a_B};
}

}  // namespace

void RateProfile::Assign(const ImuBuffer& buffer, Timestamp instant, double reach_s,
                         const ImuBiases& biases, const ImuCalibration& calibration) {
  CHECK(buffer.Covers(instant, instant));
  const Timestamp reach = ToNanoseconds(reach_s);
  const ImuCorrection correction(calibration, biases);
  nodes_.clear();

  // Backwards first, so that nodes ascend once reversed.
  const auto walk = [&](Timestamp limit) {
    buffer.Extract(instant, limit, &readings_);
    Motion motion;
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      const ImuRates rates = correction(readings_[i].omega_m, readings_[i].a_m);
      if (i == 0) {
        motion.omega_B = rates.omega_B;
        motion.a_B = rates.a_B;
      } else {
        motion =
            Step(motion, rates, SecondsBetween(readings_[i - 1].timestamp, readings_[i].timestamp));
      }
      if (i == 0 && !nodes_.empty()) continue;  // the instant itself is there already
      nodes_.push_back({SecondsBetween(instant, readings_[i].timestamp), motion});
    }
  };
  walk(std::max(instant - reach, buffer.first()));
  std::reverse(nodes_.begin(), nodes_.end());
  zero_ = nodes_.size() - 1;
  walk(std::min(instant + reach, buffer.last()));
}

RateProfile::Motion RateProfile::At(double tau_s) const {
  const Node& zero = nodes_[zero_];
  if (tau_s == 0.0) return zero.motion;
  // The node between 0 and tau that is nearest to tau, and the next one beyond tau.
  std::size_t from = zero_;
  if (tau_s > 0.0) {
    while (from + 1 < nodes_.size() && nodes_[from + 1].tau_s <= tau_s) ++from;
  } else {
    while (from > 0 && nodes_[from - 1].tau_s >= tau_s) --from;
  }
  const Node& begin = nodes_[from];
  const double h_s = tau_s - begin.tau_s;
  if (h_s == 0.0) return begin.motion;
  const bool beyond = tau_s > 0.0 ? from + 1 == nodes_.size() : from == 0;
  ImuRates end = RatesOf(begin.motion);
  if (!beyond) {
    const Node& next = tau_s > 0.0 ? nodes_[from + 1] : nodes_[from - 1];
    const double w = h_s / (next.tau_s - begin.tau_s);
    end.omega_B += w * (next.motion.omega_B - begin.motion.omega_B);
    end.a_B += w * (next.motion.a_B - begin.motion.a_B);
  }
  return Step(begin.motion, end, h_s);
}

}  // namespace duet
