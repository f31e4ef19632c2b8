#pragma once

#include <string>
#include <vector>

#include "experiments/simulation/trajectory.h"

namespace duet {

/// What a flight is in the thesis's table 7.1.
struct SequenceRow {
  double length_m = 0.0;
  double duration_s = 0.0;
  double average_speed_m_per_s = 0.0;
  double average_rate_rad_per_s = 0.0;  ///< mean of |omega|
};

/// A sequence of EuRoC as the thesis describes it.
struct EurocSequence {
  std::string name;   ///< EuRoC's own: MH_01_easy, ...
  std::string world;  ///< in which a simulation of it flies: hall or room
  SequenceRow thesis;
};

/// The eleven of table 7.1.
[[nodiscard]] const std::vector<EurocSequence>& EurocSequences();

/// How long a flight like one of them stands before it sets off, s; counts in the averages, as the
/// waiting on the ground does in EuRoC's.
inline constexpr double kEurocRest_s = 3.0;

/// A flight like the sequence, made from formulas and the sequence's number alone: sums of
/// harmonics with random rates and phases that fill the world's flight space, slow loops with a
/// wobble of 2 to 3 rad/s on them and a gaze that wanders. Two numbers are solved for, the rate of
/// the loops and that of the gaze, so that after kEurocRest_s of rest, over the table's duration,
/// length and mean rate are the table's. It goes on in the same manner beyond.
[[nodiscard]] HarmonicTrajectory::Channels EurocLikeChannels(const EurocSequence& sequence);

/// The row of any trajectory over its first `duration_s`, by sums over 20 ms.
[[nodiscard]] SequenceRow MeasureMotion(const Trajectory& trajectory, double duration_s);

/// The thesis's rows and those of the flights made like them, one beside the other.
[[nodiscard]] std::string EurocSequencesText();

}  // namespace duet
