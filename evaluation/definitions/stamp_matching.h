#pragma once

#include <vector>

#include "common/geometry/se3.h"

namespace duet {

/// How other programs pair two trajectories by their stamps: the nearest neighbours in time, never
/// interpolated, so that up to the bound's worth of motion stays in every error. They keep stamps
/// as doubles of seconds, whose last digit is 0.24 us at today's dates; so do these functions, in
/// order to decide ties and bounds alike. Both trajectories have strictly increasing stamps.

/// Positions of two poses in their trajectories.
struct StampMatch {
  int estimate = 0;
  int truth = 0;
  bool operator==(const StampMatch&) const = default;
};

/// A stamp as these programs read it: the double nearest to the decimal seconds.
[[nodiscard]] double StampSeconds(Timestamp t);

/// evo 1.x, evo/core/sync.py, associate_trajectories (commit 0e935978893c; the default,
/// "nearest_time", of later versions): each pose of the *shorter* trajectory, the estimate where
/// both have as many, takes the nearest of the longer one, the first of two equally near, where
/// that is at most `max_difference_s` away. Nothing forbids that two poses take the same one: evo
/// then counts both pairs. `offset_s` is added to the estimate's stamps (--t_offset).
[[nodiscard]] std::vector<StampMatch> MatchLikeEvo(const std::vector<StampedPose>& truth,
                                                   const std::vector<StampedPose>& estimate,
                                                   double max_difference_s = 0.01,
                                                   double offset_s = 0.0);

/// rpg_trajectory_evaluation, src/rpg_trajectory_evaluation/associate_timestamps.py, associate
/// (749ce6e7161c), as trajectory_loading.py calls it, with 0.02 s: of all pairs less than
/// `max_difference_s` apart the closest come first, and each pose is used once, so that a pose can
/// be left with a worse partner than its nearest. `offset_s` is added to the truth's stamps.
[[nodiscard]] std::vector<StampMatch> MatchLikeRpg(const std::vector<StampedPose>& truth,
                                                   const std::vector<StampedPose>& estimate,
                                                   double max_difference_s = 0.02,
                                                   double offset_s = 0.0);

/// ov_eval (OpenVINS), ov_eval/src/alignment/AlignUtils.cpp, perform_association (5d9fbeeb52f7), as
/// ResultTrajectory.cpp calls it, with 0.02 s: the estimate is walked in time with a pointer into
/// the truth that only moves forward, and the first of the estimate's poses that comes less than
/// `max_difference_s` near a true pose takes it, although its next may be nearer. A denser estimate
/// is so paired early, by up to the bound. The program then gives the estimate the truth's stamps.
/// `offset_s` is added to the estimate's stamps.
[[nodiscard]] std::vector<StampMatch> MatchLikeOvEval(const std::vector<StampedPose>& truth,
                                                      const std::vector<StampedPose>& estimate,
                                                      double max_difference_s = 0.02,
                                                      double offset_s = 0.0);

}  // namespace duet
