#include "evaluation/sequence_facts.h"

#include "common/support/logging.h"

namespace duet {

SequenceFacts FactsOfTruth(const std::vector<StampedPose>& truth, Timestamp start, Timestamp end,
                           double step_s) {
  CHECK_GT(step_s, 0.0);
  SequenceFacts facts;
  const StampedPose* first = nullptr;
  const StampedPose* last = nullptr;
  double turned_rad = 0.0;
  for (const StampedPose& pose : truth) {
    if (pose.timestamp < start || pose.timestamp > end) continue;
    if (first == nullptr) first = last = &pose;
    if (SecondsBetween(last->timestamp, pose.timestamp) < step_s) continue;
    facts.way_m += (pose.T_GB.p - last->T_GB.p).norm();
    turned_rad += pose.T_GB.R.angularDistance(last->T_GB.R);
    last = &pose;
  }
  if (first == nullptr || last == first) return facts;
  facts.duration_s = SecondsBetween(first->timestamp, last->timestamp);
  facts.speed_m_per_s = facts.way_m / facts.duration_s;
  facts.rate_rad_per_s = turned_rad / facts.duration_s;
  return facts;
}

}  // namespace duet
