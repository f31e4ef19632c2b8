#include "experiments/simulation/trajectory.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "common/support/input_error.h"

namespace duet {
namespace {

constexpr double kPi = 3.14159265358979323846;

HarmonicTrajectory::Channels CircleChannels() {
  constexpr double kRate = 0.25;  // 2 m at 0.5 m/s
  return {.x = {0.0, 0.0, {{2.0, kRate, kPi / 2}}},
          .y = {0.0, 0.0, {{2.0, kRate, 0.0}}},
          .z = {1.5, 0.0, {}},
          .yaw = {kPi / 2, kRate, {}},
          .pitch = {},
          .roll = {}};
}

HarmonicTrajectory::Channels FigureEightChannels() {
  return {.x = {0.0, 0.0, {{2.2, 0.3, 0.0}}},
          .y = {0.0, 0.0, {{1.2, 0.6, 0.0}}},
          .z = {1.5, 0.0, {{0.3, 0.7, 0.4}}},
          .yaw = {0.0, 0.0, {{1.0, 0.3, 0.3}, {0.2, 0.9, 1.1}}},
          .pitch = {0.0, 0.0, {{0.12, 0.8, 0.2}}},
          .roll = {0.0, 0.0, {{0.15, 0.65, 1.3}}}};
}

HarmonicTrajectory::Channels LissajousChannels() {
  return {.x = {0.0, 0.0, {{1.6, 0.45, 0.0}, {0.15, 2.3, 0.5}}},
          .y = {0.0, 0.0, {{1.3, 0.61, 0.7}, {0.15, 2.0, 1.9}}},
          .z = {1.5, 0.0, {{0.45, 0.83, 1.1}, {0.08, 2.6, 0.2}}},
          .yaw = {0.0, 0.15, {{0.7, 0.71, 0.3}, {0.15, 1.9, 0.0}}},
          .pitch = {0.0, 0.0, {{0.35, 0.97, 0.9}, {0.06, 2.2, 1.4}}},
          .roll = {0.0, 0.0, {{0.40, 0.79, 2.1}, {0.06, 2.4, 0.6}}}};
}

HarmonicTrajectory::Channels RoomWalkChannels() {
  return {.x = {0.0, 0.0, {{2.0, 0.17, 0.0}, {0.35, 0.71, 0.4}, {0.12, 2.1, 1.0}}},
          .y = {0.0, 0.0, {{1.6, 0.23, 1.2}, {0.30, 0.63, 2.0}, {0.13, 1.9, 0.1}}},
          .z = {1.4, 0.0, {{0.35, 0.41, 0.3}, {0.07, 2.5, 0.8}}},
          .yaw = {0.0, 0.18, {{0.55, 0.47, 0.2}, {0.06, 1.6, 1.7}}},
          .pitch = {0.0, 0.0, {{0.12, 0.83, 0.5}, {0.03, 1.9, 0.9}}},
          .roll = {0.0, 0.0, {{0.12, 0.67, 1.4}, {0.03, 2.2, 0.3}}}};
}

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
  std::array<double, 3> value = {offset + slope * s, slope, 0.0};
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
  const auto [s, s_dot, s_ddot] = warp_.At(t_s);
  const auto chained = [&](const HarmonicChannel& channel) -> std::array<double, 3> {
    const auto [value, d1, d2] = channel.At(s);
    return {value, d1 * s_dot, d2 * s_dot * s_dot + d1 * s_ddot};
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

const std::vector<std::string>& TrajectoryNames() {
  static const std::vector<std::string> names = {"circle", "figure_eight", "lissajous", "room_walk",
                                                 "hover"};
  return names;
}

std::shared_ptr<const Trajectory> MakeTrajectory(const std::string& name, double duration_s,
                                                 double rest_s) {
  HarmonicTrajectory::Channels channels;
  if (name == "circle") {
    channels = CircleChannels();
  } else if (name == "figure_eight") {
    channels = FigureEightChannels();
  } else if (name == "lissajous") {
    channels = LissajousChannels();
  } else if (name == "room_walk" || name == "hover") {
    channels = RoomWalkChannels();
  } else {
    std::string known;
    for (const std::string& each : TrajectoryNames()) known += (known.empty() ? "" : ", ") + each;
    throw InputError("", 0, "trajectory", "unknown trajectory '" + name + "'; expected " + known);
  }
  constexpr double kRampDuration = 1.0;
  std::vector<TimeWarp::Ramp> ramps;
  if (rest_s > 0.0) ramps.push_back({rest_s, kRampDuration, 1.0});
  if (name == "hover") {
    for (double stop = rest_s + 8.0; stop < duration_s; stop += 20.0) {
      ramps.push_back({stop - kRampDuration, kRampDuration, 0.0});
      ramps.push_back({stop + 6.0, kRampDuration, 1.0});
    }
  }
  return std::make_shared<HarmonicTrajectory>(
      std::move(channels), TimeWarp(rest_s > 0.0 ? 0.0 : 1.0, std::move(ramps)), duration_s);
}

}  // namespace duet
