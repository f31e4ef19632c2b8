#pragma once

#include <optional>
#include <vector>

#include "common/geometry/se3.h"

namespace duet {

/// The pose at `t`, linear in position and by slerp in rotation, between the two neighbours of
/// `poses` (strictly increasing stamps). Nothing where `t` lies outside them or where the two are
/// more than `max_gap_s` apart (an exact hit needs no neighbour).
[[nodiscard]] std::optional<Pose> InterpolatePose(const std::vector<StampedPose>& poses,
                                                  Timestamp t, double max_gap_s);

/// Makes the signs of quaternions continuous along the sequence (q and -q are one rotation).
void MakeQuaternionSignsContinuous(std::vector<StampedPose>* poses);

}  // namespace duet
