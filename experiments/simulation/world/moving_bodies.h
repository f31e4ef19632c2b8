#pragma once

#include "experiments/simulation/world/world_builder.h"

namespace duet {

/// A way to and fro for ever: from `a` to `b` and back within `period_s`, smooth, with a turn
/// at the ends; heading is +x of the body. `phase` in 0..1 is where in the period it is at t = 0.
struct ShuttleWay {
  Eigen::Vector2d a, b;
  double period_s = 12.0;
  double phase = 0.0;
  [[nodiscard]] Pose At(double t_s) const;
  /// Of the way, m/s, never negative.
  [[nodiscard]] double Speed(double t_s) const;
};

/// A way round for ever: along y = -half_width_m from -half_length_m to half_length_m, a half
/// circle, back along y = half_width_m, a half circle; anticlockwise at constant speed.
struct LoopWay {
  double half_length_m = 50.0;
  double half_width_m = 4.0;
  double speed_m_s = 8.0;
  double start_m = 0.0;  ///< how far along the loop it is at t = 0
  [[nodiscard]] Pose At(double t_s) const;
};

/// Somebody who walks: body, head, two arms and two legs that swing as the way's speed says.
/// Nothing of the walker is farther than 0.6 m from the upright through the way.
void AddWalker(WorldBuilder& builder, const ShuttleWay& way, double height_m);

/// A car of 4.2 x 1.76 x 1.45 m on the loop.
void AddMovingCar(WorldBuilder& builder, const LoopWay& way);
/// The same at rest; `pose` at the middle of its foot print, heading +x.
void AddParkedCar(WorldBuilder& builder, const Pose& pose);

}  // namespace duet
