#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/study/study_plan.h"

namespace duet {

/// How long runs will take, one after the other.
struct TimeEstimate {
  double total_s = 0.0;
  std::string from;  ///< in words: what it was estimated from
};

/// From the records that the folder has: a frame costs what it cost the same estimator with the
/// same setting, else the same estimator; where there is none, a rough rate that is stated.
[[nodiscard]] TimeEstimate EstimateTime(const StudyPlan& plan, const std::vector<int>& runs,
                                        const std::filesystem::path& folder);

/// "40 s", "12 min", "3.5 h".
[[nodiscard]] std::string DurationText(double seconds);

}  // namespace duet
