#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "common/geometry/pose_spline.h"

namespace duet {

/// A smooth motion of the rig with exact derivatives, over [0, duration_s()].
class Trajectory {
 public:
  virtual ~Trajectory() = default;
  [[nodiscard]] virtual double duration_s() const = 0;
  [[nodiscard]] virtual Kinematics At(double t_s) const = 0;
};

/// offset + slope s + sum of amplitude sin(rate s + phase).
struct HarmonicChannel {
  struct Term {
    double amplitude;
    double rate;  ///< rad per unit of s
    double phase;
  };
  double offset = 0.0;
  double slope = 0.0;
  std::vector<Term> terms;

  /// Value, first and second derivative at s.
  [[nodiscard]] std::array<double, 3> At(double s) const;
};

/// How far along its path a rig has come at a time: s(t) with the speed s'(t) going smoothly
/// between levels, so that a path can be started, stopped and gone on with.
class TimeWarp {
 public:
  /// The speed is `initial_speed` up to the first ramp; each ramp takes it to `speed` from start_s
  /// on within duration_s, by the smooth step 6x^5 - 15x^4 + 10x^3 (s'' and s''' continuous). Ramps
  /// in order, not overlapping.
  struct Ramp {
    double start_s;
    double duration_s;
    double speed;
  };
  explicit TimeWarp(double initial_speed = 1.0, std::vector<Ramp> ramps = {});

  /// s, s' and s'' at t >= 0.
  [[nodiscard]] std::array<double, 3> At(double t_s) const;

 private:
  double initial_speed_;
  std::vector<Ramp> ramps_;
};

/// Position by three harmonic channels, orientation R_GB = Rz(yaw) Ry(pitch) Rx(roll) R_0 by three
/// more; R_0 carries the body as EuRoC's rig has it (x up, z forward) to (forward, left, up).
class HarmonicTrajectory final : public Trajectory {
 public:
  struct Channels {
    HarmonicChannel x, y, z;           ///< m
    HarmonicChannel yaw, pitch, roll;  ///< rad
  };
  HarmonicTrajectory(Channels channels, TimeWarp warp, double duration_s);

  [[nodiscard]] double duration_s() const override { return duration_s_; }
  [[nodiscard]] Kinematics At(double t_s) const override;

 private:
  Channels channels_;
  TimeWarp warp_;
  double duration_s_;
};

/// A spline through recorded poses.
class SplineTrajectory final : public Trajectory {
 public:
  explicit SplineTrajectory(PoseSpline spline) : spline_(std::move(spline)) {}

  [[nodiscard]] double duration_s() const override;
  /// `t_s` is rounded to nanoseconds.
  [[nodiscard]] Kinematics At(double t_s) const override;

 private:
  PoseSpline spline_;
};

/// Names that MakeTrajectory takes: circle (constant rates: weakly excited), figure_eight,
/// lissajous (all six degrees of freedom, strong), room_walk (as EuRoC's easy flights: 0.5 m/s, 0.4
/// rad/s), hover (room_walk that stands still from 8 to 14 s and for 6 s of every further 20).
[[nodiscard]] const std::vector<std::string>& TrajectoryNames();

/// Within about 3 m of (0, 0), 0.8 to 2.2 m above the floor. `rest_s` > 0: at rest for that long
/// first, then off within a second. Throws InputError for an unknown name.
[[nodiscard]] std::shared_ptr<const Trajectory> MakeTrajectory(const std::string& name,
                                                               double duration_s, double rest_s);

}  // namespace duet
