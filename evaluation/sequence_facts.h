#pragma once

#include <vector>

#include "common/geometry/se3.h"
#include "common/support/timestamp.h"

namespace duet {

/// What a recording's motion is like, from its truth: the columns of the thesis's table 7.1, under
/// the metrics truth.way_m, truth.duration_s, truth.speed_m_per_s, truth.rate_rad_per_s.
struct SequenceFacts {
  double way_m = 0.0;
  double duration_s = 0.0;
  double speed_m_per_s = 0.0;   ///< way over duration; 0 where there is no duration
  double rate_rad_per_s = 0.0;  ///< sum of the angles between samples, over duration
};

/// Between `start` and `end`, over samples at least `step_s` apart: the noise of a truth at 200 Hz
/// adds metres to a way, and radians to a turn, that nobody went.
[[nodiscard]] SequenceFacts FactsOfTruth(const std::vector<StampedPose>& truth, Timestamp start,
                                         Timestamp end, double step_s = 0.1);

}  // namespace duet
