#pragma once

#include <array>
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

/// offset + slope s + bend s^2 / 2 + sum of amplitude sin(rate s + phase).
struct HarmonicChannel {
  struct Term {
    double amplitude;
    double rate;  ///< rad per unit of s
    double phase;
  };
  double offset = 0.0;
  double slope = 0.0;
  std::vector<Term> terms = {};
  double bend = 0.0;

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

/// A car on a level road along G's x axis: the place on the road, x = x_start_m + s(t), goes with
/// the warp, the place across it is y(x), and the body heads along the path (yaw = atan y'(x)), R_0
/// as above.
class RoadTrajectory final : public Trajectory {
 public:
  /// `across` in m by x in m; `height_m`: z of the body.
  RoadTrajectory(HarmonicChannel across, double x_start_m, double height_m, TimeWarp warp,
                 double duration_s);

  [[nodiscard]] double duration_s() const override { return duration_s_; }
  [[nodiscard]] Kinematics At(double t_s) const override;

 private:
  HarmonicChannel across_;
  double x_start_m_;
  double height_m_;
  TimeWarp warp_;
  double duration_s_;
};

/// A trajectory seen from another place: turned about the vertical, then moved. Gravity, and with
/// it what an IMU reads, stays the same.
class PlacedTrajectory final : public Trajectory {
 public:
  PlacedTrajectory(std::shared_ptr<const Trajectory> trajectory, double yaw_rad,
                   const Eigen::Vector3d& shift);

  [[nodiscard]] double duration_s() const override { return trajectory_->duration_s(); }
  [[nodiscard]] Kinematics At(double t_s) const override;
  /// T_GG': from the trajectory's own G' to G.
  [[nodiscard]] const Pose& placement() const { return placement_; }

 private:
  std::shared_ptr<const Trajectory> trajectory_;
  Pose placement_;
};

}  // namespace duet
