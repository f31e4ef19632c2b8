#include "experiments/simulation/trajectory_library.h"

#include <algorithm>
#include <functional>
#include <numbers>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "experiments/simulation/euroc_sequences.h"

namespace duet {
namespace {

using Channels = HarmonicTrajectory::Channels;

Channels CircleChannels() {
  constexpr double kRate = 0.25;  // 2 m at 0.5 m/s
  return {.x = {0.0, 0.0, {{2.0, kRate, std::numbers::pi / 2}}},
          .y = {0.0, 0.0, {{2.0, kRate, 0.0}}},
          .z = {1.5, 0.0, {}},
          .yaw = {std::numbers::pi / 2, kRate, {}},
          .pitch = {},
          .roll = {}};
}

Channels FigureEightChannels() {
  return {.x = {0.0, 0.0, {{2.2, 0.3, 0.0}}},
          .y = {0.0, 0.0, {{1.2, 0.6, 0.0}}},
          .z = {1.5, 0.0, {{0.3, 0.7, 0.4}}},
          .yaw = {0.0, 0.0, {{1.0, 0.3, 0.3}, {0.2, 0.9, 1.1}}},
          .pitch = {0.0, 0.0, {{0.12, 0.8, 0.2}}},
          .roll = {0.0, 0.0, {{0.15, 0.65, 1.3}}}};
}

Channels LissajousChannels() {
  return {.x = {0.0, 0.0, {{1.6, 0.45, 0.0}, {0.15, 2.3, 0.5}}},
          .y = {0.0, 0.0, {{1.3, 0.61, 0.7}, {0.15, 2.0, 1.9}}},
          .z = {1.5, 0.0, {{0.45, 0.83, 1.1}, {0.08, 2.6, 0.2}}},
          .yaw = {0.0, 0.15, {{0.7, 0.71, 0.3}, {0.15, 1.9, 0.0}}},
          .pitch = {0.0, 0.0, {{0.35, 0.97, 0.9}, {0.06, 2.2, 1.4}}},
          .roll = {0.0, 0.0, {{0.40, 0.79, 2.1}, {0.06, 2.4, 0.6}}}};
}

Channels RoomWalkChannels() {
  return {.x = {0.0, 0.0, {{2.0, 0.17, 0.0}, {0.35, 0.71, 0.4}, {0.12, 2.1, 1.0}}},
          .y = {0.0, 0.0, {{1.6, 0.23, 1.2}, {0.30, 0.63, 2.0}, {0.13, 1.9, 0.1}}},
          .z = {1.4, 0.0, {{0.35, 0.41, 0.3}, {0.07, 2.5, 0.8}}},
          .yaw = {0.0, 0.18, {{0.55, 0.47, 0.2}, {0.06, 1.6, 1.7}}},
          .pitch = {0.0, 0.0, {{0.12, 0.83, 0.5}, {0.03, 1.9, 0.9}}},
          .roll = {0.0, 0.0, {{0.12, 0.67, 1.4}, {0.03, 2.2, 0.3}}}};
}

// Fast flight: up to 3.3 m/s, 3.2 rad/s and 1 g.
Channels AggressiveChannels() {
  return {.x = {0.0, 0.0, {{6.0, 0.34, 0.4}, {0.30, 1.9, 1.2}, {0.05, 4.1, 0.3}}},
          .y = {0.0, 0.0, {{3.4, 0.48, 1.7}, {0.30, 2.1, 0.2}, {0.05, 3.7, 2.0}}},
          .z = {2.4, 0.0, {{0.9, 0.67, 0.9}, {0.15, 2.4, 1.1}}},
          .yaw = {0.0, 0.2, {{1.4, 0.95, 0.2}, {0.45, 2.6, 0.9}}},
          .pitch = {0.0, 0.0, {{0.30, 1.3, 0.5}, {0.15, 3.4, 1.6}}},
          .roll = {0.0, 0.0, {{0.35, 1.1, 1.4}, {0.15, 3.8, 0.1}}}};
}

Channels PureRotationChannels() {
  return {.x = {0.3, 0.0, {}},
          .y = {-0.2, 0.0, {}},
          .z = {1.5, 0.0, {}},
          .yaw = {0.0, 0.12, {{0.8, 0.53, 0.2}, {0.12, 1.7, 0.4}}},
          .pitch = {0.0, 0.0, {{0.25, 0.71, 0.9}}},
          .roll = {0.0, 0.0, {{0.25, 0.61, 2.1}}}};
}

// The positions of room_walk, turning about G's z axis (the body's x axis) alone.
Channels OneAxisChannels(HarmonicChannel yaw) {
  Channels channels = RoomWalkChannels();
  channels.yaw = std::move(yaw);
  channels.pitch = {};
  channels.roll = {};
  return channels;
}

// From one end of the street to the other, 1 m/s, looking along it.
Channels StraightLineChannels() {
  return {.x = {-65.0, 1.0, {}},
          .y = {0.4, 0.0, {}},
          .z = {1.5, 0.0, {}},
          .yaw = {},
          .pitch = {},
          .roll = {}};
}

// From standing to 7.2 m/s along the optical axis, rolling about it: the specific force along that
// axis of the body is constant, gravity goes round in the other two.
Channels ConstantAccelerationChannels() {
  return {.x = {.offset = -65.0, .bend = 0.2},
          .y = {-0.4, 0.0, {}},
          .z = {1.5, 0.0, {}},
          .yaw = {},
          .pitch = {},
          .roll = {0.0, 0.0, {{0.45, 0.7, 0.0}, {0.1, 1.9, 0.6}}}};
}

Channels StandstillChannels() {
  return {.x = {-1.0, 0.0, {}},
          .y = {0.5, 0.0, {}},
          .z = {1.2, 0.0, {}},
          .yaw = {0.4, 0.0, {}},
          .pitch = {0.05, 0.0, {}},
          .roll = {-0.03, 0.0, {}}};
}

constexpr double kRamp_s = 1.0;  // from rest to full speed and back

// Sets off after `rest_s`, stands still after `moving_s` of motion for `standing_s`, and so on.
std::vector<TimeWarp::Ramp> StopAndGo(double duration_s, double rest_s, double moving_s,
                                      double standing_s, double period_s) {
  std::vector<TimeWarp::Ramp> ramps;
  if (rest_s > 0.0) ramps.push_back({rest_s, kRamp_s, 1.0});
  for (double stop = rest_s + moving_s; stop < duration_s; stop += period_s) {
    ramps.push_back({stop - kRamp_s, kRamp_s, 0.0});
    ramps.push_back({stop + standing_s, kRamp_s, 1.0});
  }
  return ramps;
}

// Through town: off, a stop of 4 s at a light, on, and to the end of the street, where it stands.
std::shared_ptr<const Trajectory> Driving(double duration_s, double rest_s) {
  const HarmonicChannel across = {0.0, 0.0, {{1.3, 0.16, 0.4}, {0.5, 0.29, 1.0}}};
  TimeWarp warp(0.0, {{rest_s, 4.0, 4.0},
                      {rest_s + 14.0, 3.0, 0.0},
                      {rest_s + 21.0, 4.0, 5.0},
                      {rest_s + 34.0, 4.0, 0.0}});
  return std::make_shared<RoadTrajectory>(across, -60.0, 1.5, std::move(warp), duration_s);
}

std::shared_ptr<const Trajectory> Harmonic(Channels channels, double duration_s, double rest_s) {
  return std::make_shared<HarmonicTrajectory>(
      std::move(channels),
      TimeWarp(rest_s > 0.0 ? 0.0 : 1.0, rest_s > 0.0
                                             ? std::vector<TimeWarp::Ramp>{{rest_s, kRamp_s, 1.0}}
                                             : std::vector<TimeWarp::Ramp>{}),
      duration_s);
}

std::shared_ptr<const Trajectory> Hovering(double duration_s, double rest_s, double moving_s,
                                           double standing_s, double period_s) {
  return std::make_shared<HarmonicTrajectory>(
      RoomWalkChannels(),
      TimeWarp(rest_s > 0.0 ? 0.0 : 1.0,
               StopAndGo(duration_s, rest_s, moving_s, standing_s, period_s)),
      duration_s);
}

using Maker = std::function<std::shared_ptr<const Trajectory>(double duration_s, double rest_s)>;

struct Entry {
  NamedMotion motion;
  Maker make;
};

Entry HarmonicEntry(NamedMotion motion, Channels channels) {
  return {std::move(motion), [channels = std::move(channels)](double duration_s, double rest_s) {
            return Harmonic(channels, duration_s, rest_s);
          }};
}

std::vector<Entry> MakeEntries() {
  std::vector<Entry> entries = {
      HarmonicEntry({"circle", "room", "2 m around, 0.5 m/s, looking ahead: weakly excited"},
                    CircleChannels()),
      HarmonicEntry({"figure_eight", "room", "a lying eight, looking about"},
                    FigureEightChannels()),
      HarmonicEntry({"lissajous", "room", "all six degrees of freedom, strong"},
                    LissajousChannels()),
      HarmonicEntry({"room_walk", "room", "as EuRoC's easy flights: 0.5 m/s, 0.4 rad/s"},
                    RoomWalkChannels()),
      {{"hover", "room", "room_walk that stands still from 8 to 14 s and 6 s of every further 20"},
       [](double duration_s, double rest_s) {
         return Hovering(duration_s, rest_s, 8.0, 6.0, 20.0);
       }},
      {{"hover_long", "room", "room_walk that stands still for 22 of every 30 s"},
       [](double duration_s, double rest_s) {
         return Hovering(duration_s, rest_s, 8.0, 22.0, 30.0);
       }},
      HarmonicEntry({"aggressive", "hall", "fast flight: up to 3.3 m/s, 3.2 rad/s"},
                    AggressiveChannels()),
      {{"planar_driving", "street", "a car: level, along its path, up to 5 m/s; stops and ends"},
       Driving},
      HarmonicEntry({"standstill", "room", "nothing moves"}, StandstillChannels()),
      HarmonicEntry({"pure_rotation", "room", "turns about all axes on the spot"},
                    PureRotationChannels()),
      HarmonicEntry({"one_axis_rotation", "room", "moves about, turning about the vertical alone"},
                    OneAxisChannels({0.0, 0.1, {{0.7, 0.47, 0.2}, {0.15, 1.6, 1.7}}})),
      HarmonicEntry({"constant_rate", "room", "moves about, turning at 0.4 rad/s about one axis"},
                    OneAxisChannels({0.3, 0.4, {}})),
      HarmonicEntry({"straight_line", "street", "1 m/s straight ahead", 130.0},
                    StraightLineChannels()),
      HarmonicEntry({"constant_acceleration", "street",
                     "0.2 m/s^2 along the optical axis, rolling about it", 36.0},
                    ConstantAccelerationChannels())};
  for (const EurocSequence& sequence : EurocSequences()) {
    entries.push_back({{sequence.name, sequence.world, "like EuRoC's " + sequence.name},
                       [&sequence](double duration_s, double rest_s) {
                         return Harmonic(EurocLikeChannels(sequence), duration_s, rest_s);
                       }});
  }
  return entries;
}

const std::vector<Entry>& Entries() {
  static const std::vector<Entry> entries = MakeEntries();
  return entries;
}

const Entry& FindEntry(const std::string& name) {
  for (const Entry& entry : Entries()) {
    if (entry.motion.name == name) return entry;
  }
  std::string known;
  for (const Entry& entry : Entries()) known += (known.empty() ? "" : ", ") + entry.motion.name;
  throw InputError("", 0, "trajectory", "unknown trajectory '" + name + "'; expected " + known);
}

}  // namespace

const std::vector<NamedMotion>& NamedMotions() {
  static const std::vector<NamedMotion> motions = [] {
    std::vector<NamedMotion> all;
    for (const Entry& entry : Entries()) all.push_back(entry.motion);
    return all;
  }();
  return motions;
}

std::vector<std::string> TrajectoryNames() {
  std::vector<std::string> names;
  for (const NamedMotion& motion : NamedMotions()) names.push_back(motion.name);
  return names;
}

std::string NamedMotionsText() {
  std::string text;
  for (const NamedMotion& motion : NamedMotions()) {
    std::string line = motion.name;
    line.resize(std::max<std::size_t>(line.size() + 1, 23), ' ');
    line += motion.world;
    line.resize(31, ' ');
    line += motion.summary;
    if (motion.longest_s > 0.0) line += "; at most " + FormatNumber(motion.longest_s) + " s";
    text += line + "\n";
  }
  return text;
}

const NamedMotion& FindMotion(const std::string& name) { return FindEntry(name).motion; }

std::shared_ptr<const Trajectory> MakeTrajectory(const std::string& name, double duration_s,
                                                 double rest_s) {
  const Entry& entry = FindEntry(name);
  const double longest_s = entry.motion.longest_s;
  if (longest_s > 0.0 && duration_s > longest_s + rest_s) {
    throw InputError("", 0, "duration_s",
                     "'" + name + "' leaves its space after " + FormatNumber(longest_s) +
                         " s of motion; expected a shorter duration");
  }
  return entry.make(duration_s, rest_s);
}

}  // namespace duet
