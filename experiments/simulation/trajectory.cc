#include "experiments/simulation/trajectory.h"

#include <algorithm>
#include <cmath>

#include "common/support/logging.h"

namespace duet {
namespace {

// The body as EuRoC's rig has it, x up and z forward, in (forward, left, up).
Eigen::Matrix3d NominalBody() {
  Eigen::Matrix3d R;
  R << 0, 0, 1,  //
      0, -1, 0,  //
      1, 0, 0;
  return R;
}

}  // namespace

std::array<double, 3> HarmonicChannel::At(double s) const {
  std::array<double, 3> value = {offset + slope * s + 0.5 * bend * s * s, slope + bend * s, bend};
  for (const Term& term : terms) {
    const double sine = std::sin(term.rate * s + term.phase);
    const double cosine = std::cos(term.rate * s + term.phase);
    value[0] += term.amplitude * sine;
    value[1] += term.amplitude * term.rate * cosine;
    value[2] -= term.amplitude * term.rate * term.rate * sine;
  }
  return value;
}

TimeWarp::TimeWarp(double initial_speed, std::vector<Ramp> ramps)
    : initial_speed_(initial_speed), ramps_(std::move(ramps)) {
  for (std::size_t i = 1; i < ramps_.size(); ++i) {
    CHECK_GE(ramps_[i].start_s, ramps_[i - 1].start_s + ramps_[i - 1].duration_s);
  }
}

std::array<double, 3> TimeWarp::At(double t_s) const {
  double s = 0.0;
  double t = 0.0;
  double speed = initial_speed_;
  for (const Ramp& ramp : ramps_) {
    if (t_s <= ramp.start_s) break;
    s += speed * (ramp.start_s - t);
    const double x = std::min(1.0, (t_s - ramp.start_s) / ramp.duration_s);
    const double change = ramp.speed - speed;
    const double x2 = x * x;
    // The smooth step, its integral and its derivative.
    const double step = x2 * x * (10.0 + x * (-15.0 + 6.0 * x));
    const double integral = x2 * x2 * (2.5 + x * (-3.0 + x));
    s += ramp.duration_s * (speed * x + change * integral);
    if (x < 1.0) {
      const double slope = 30.0 * x2 * (1.0 + x * (-2.0 + x));
      return {s, speed + change * step, change * slope / ramp.duration_s};
    }
    speed = ramp.speed;
    t = ramp.start_s + ramp.duration_s;
  }
  return {s + speed * (t_s - t), speed, 0.0};
}

HarmonicTrajectory::HarmonicTrajectory(Channels channels, TimeWarp warp, double duration_s)
    : channels_(std::move(channels)), warp_(std::move(warp)), duration_s_(duration_s) {}

Kinematics HarmonicTrajectory::At(double t_s) const {
  const std::array<double, 3> s = warp_.At(t_s);
  const auto chained = [&s](const HarmonicChannel& channel) -> std::array<double, 3> {
    const auto [value, d1, d2] = channel.At(s[0]);
    return {value, d1 * s[1], d2 * s[1] * s[1] + d1 * s[2]};
  };
  const auto x = chained(channels_.x);
  const auto y = chained(channels_.y);
  const auto z = chained(channels_.z);
  const auto yaw = chained(channels_.yaw);
  const auto pitch = chained(channels_.pitch);
  const auto roll = chained(channels_.roll);

  using Eigen::Vector3d;
  const Eigen::Matrix3d R_y = Eigen::AngleAxisd(pitch[0], Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Matrix3d R_x = Eigen::AngleAxisd(roll[0], Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d R_z = Eigen::AngleAxisd(yaw[0], Vector3d::UnitZ()).toRotationMatrix();
  // Rates add up in the axes that each angle turns about, seen from behind the last rotation.
  const Vector3d omega_before_R0 =
      roll[1] * Vector3d::UnitX() +
      R_x.transpose() *
          (pitch[1] * Vector3d::UnitY() + R_y.transpose() * (yaw[1] * Vector3d::UnitZ()));
  const Eigen::Matrix3d R_0 = NominalBody();
  Kinematics k;
  k.T_GB.R = Eigen::Quaterniond(R_z * R_y * R_x * R_0).normalized();
  k.T_GB.p = {x[0], y[0], z[0]};
  k.v_GB = {x[1], y[1], z[1]};
  k.a_G = {x[2], y[2], z[2]};
  k.omega_B = R_0.transpose() * omega_before_R0;
  return k;
}

RoadTrajectory::RoadTrajectory(HarmonicChannel across, double x_start_m, double height_m,
                               TimeWarp warp, double duration_s)
    : across_(std::move(across)),
      x_start_m_(x_start_m),
      height_m_(height_m),
      warp_(std::move(warp)),
      duration_s_(duration_s) {}

Kinematics RoadTrajectory::At(double t_s) const {
  const auto [s, s_dot, s_ddot] = warp_.At(t_s);
  const double x = x_start_m_ + s;
  const auto [y, slope, bend] = across_.At(x);
  Kinematics k;
  k.T_GB.p = {x, y, height_m_};
  k.v_GB = {s_dot, slope * s_dot, 0.0};
  k.a_G = {s_ddot, bend * s_dot * s_dot + slope * s_ddot, 0.0};
  const Eigen::AngleAxisd R_z(std::atan(slope), Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d R_0 = NominalBody();
  k.T_GB.R = Eigen::Quaterniond(R_z.toRotationMatrix() * R_0).normalized();
  const double yaw_rate = bend * s_dot / (1.0 + slope * slope);
  k.omega_B = R_0.transpose() * Eigen::Vector3d(0.0, 0.0, yaw_rate);
  return k;
}

PlacedTrajectory::PlacedTrajectory(std::shared_ptr<const Trajectory> trajectory, double yaw_rad,
                                   const Eigen::Vector3d& shift)
    : trajectory_(std::move(trajectory)),
      placement_{Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), shift} {}

Kinematics PlacedTrajectory::At(double t_s) const {
  Kinematics k = trajectory_->At(t_s);
  k.T_GB = placement_ * k.T_GB;
  k.v_GB = placement_.R * k.v_GB;
  k.a_G = placement_.R * k.a_G;
  return k;
}

}  // namespace duet
