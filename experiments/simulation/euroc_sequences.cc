#include "experiments/simulation/euroc_sequences.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/support/logging.h"
#include "common/support/random.h"
#include "experiments/simulation/world/world_library.h"

namespace duet {
namespace {

constexpr double kRamp_s = 1.0;
constexpr double kSampling_s = 0.02;
constexpr double kFitSampling_s = 0.1;

// What is drawn for one sequence; rates of loops and gaze are relative.
struct Shape {
  HarmonicTrajectory::Channels loops;   // positions; their rates are scaled
  HarmonicTrajectory::Channels wobble;  // positions and angles with rates of their own
  HarmonicTrajectory::Channels gaze;    // angles; their rates are scaled
};

HarmonicChannel::Term DrawTerm(double amplitude, double low_rate, double high_rate,
                               Random* random) {
  const double rate = random->Uniform(low_rate, high_rate);
  return {amplitude, rate, random->Uniform(0.0, 2.0 * 3.14159265358979323846)};
}

// A main loop and a faster one, 0.87 of the half width together.
HarmonicChannel DrawLoop(double middle, double half_width, double rate, Random* random) {
  HarmonicChannel channel{.offset = middle};
  channel.terms.push_back(DrawTerm(0.64 * half_width, 0.92 * rate, 1.08 * rate, random));
  channel.terms.push_back(DrawTerm(0.23 * half_width, 2.2 * rate, 2.9 * rate, random));
  return channel;
}

struct WobbleRange {
  double low_rate, high_rate;  // rad/s
  double largest;              // amplitude
};

// A term whose derivative has the amplitude `speed`.
HarmonicChannel::Term DrawWobble(double speed, const WobbleRange& range, Random* random) {
  HarmonicChannel::Term term = DrawTerm(1.0, range.low_rate, range.high_rate, random);
  term.amplitude = std::min(range.largest, speed / term.rate);
  return term;
}

// Shares of the average speed and rate that are the control loop's, not the path's; with them the
// accelerations and tilt rates are about those of EuRoC's own truth (MH_03: 1.3 m/s^2 and 0.23
// rad/s root mean square).
constexpr double kSlowWobble = 0.35;
constexpr double kFastWobble = 0.12;
constexpr double kTiltWobble = 0.35;

Shape DrawShape(const EurocSequence& sequence, Random* random) {
  const FlightSpace space = FlightSpaceOf(sequence.world);
  const Eigen::Vector3d middle = 0.5 * (space.low + space.high);
  const Eigen::Vector3d half = 0.5 * (space.high - space.low);
  const double speed = sequence.thesis.average_speed_m_per_s;
  const double rate = sequence.thesis.average_rate_rad_per_s;
  const auto wobble = [&](double half_width) {
    HarmonicChannel channel;
    channel.terms.push_back(DrawWobble(kSlowWobble * speed, {1.8, 2.8, 0.1 * half_width}, random));
    channel.terms.push_back(DrawWobble(kFastWobble * speed, {4.5, 6.0, 0.03 * half_width}, random));
    return channel;
  };
  Shape shape;
  shape.loops.x = DrawLoop(middle.x(), half.x(), 1.0, random);
  shape.loops.y = DrawLoop(middle.y(), half.y(), 1.37, random);
  shape.loops.z = DrawLoop(middle.z(), half.z(), 1.83, random);
  shape.wobble.x = wobble(half.x());
  shape.wobble.y = wobble(half.y());
  shape.wobble.z = wobble(half.z());
  const double turn = random->Uniform() < 0.5 ? -0.12 : 0.12;
  shape.gaze.yaw = {.slope = turn,
                    .terms = {DrawTerm(0.8, 0.3, 0.4, random), DrawTerm(0.2, 0.7, 1.1, random)}};
  shape.gaze.pitch = {.terms = {DrawTerm(0.2, 0.7, 1.1, random)}};
  shape.gaze.roll = {.terms = {DrawTerm(0.2, 0.7, 1.1, random)}};
  shape.wobble.yaw = {.terms = {DrawWobble(0.2 * rate, {2.0, 3.0, 0.1}, random)}};
  shape.wobble.pitch = {.terms = {DrawWobble(kTiltWobble * rate, {3.5, 5.0, 0.06}, random)}};
  shape.wobble.roll = {.terms = {DrawWobble(kTiltWobble * rate, {3.5, 5.0, 0.06}, random)}};
  return shape;
}

HarmonicChannel Sum(const HarmonicChannel& scaled, double rate_scale,
                    const HarmonicChannel& unscaled) {
  HarmonicChannel sum = scaled;
  sum.slope *= rate_scale;
  for (HarmonicChannel::Term& term : sum.terms) term.rate *= rate_scale;
  sum.terms.insert(sum.terms.end(), unscaled.terms.begin(), unscaled.terms.end());
  return sum;
}

HarmonicTrajectory::Channels Scaled(const Shape& shape, double loop_rate, double gaze_rate) {
  return {.x = Sum(shape.loops.x, loop_rate, shape.wobble.x),
          .y = Sum(shape.loops.y, loop_rate, shape.wobble.y),
          .z = Sum(shape.loops.z, loop_rate, shape.wobble.z),
          .yaw = Sum(shape.gaze.yaw, gaze_rate, shape.wobble.yaw),
          .pitch = Sum(shape.gaze.pitch, gaze_rate, shape.wobble.pitch),
          .roll = Sum(shape.gaze.roll, gaze_rate, shape.wobble.roll)};
}

HarmonicTrajectory AfterRest(HarmonicTrajectory::Channels channels, double duration_s) {
  return {std::move(channels), TimeWarp(0.0, {{kEurocRest_s, kRamp_s, 1.0}}), duration_s};
}

SequenceRow MeasureEvery(double step_s, const Trajectory& trajectory, double duration_s) {
  CHECK_GT(duration_s, 0.0);
  CHECK_LE(duration_s, trajectory.duration_s());
  const int count = std::max(1, static_cast<int>(std::lround(duration_s / step_s)));
  double speed = 0.0;
  double rate = 0.0;
  for (int i = 0; i < count; ++i) {
    const Kinematics k = trajectory.At(duration_s * (i + 0.5) / count);
    speed += k.v_GB.norm() / count;
    rate += k.omega_B.norm() / count;
  }
  return {.length_m = speed * duration_s,
          .duration_s = duration_s,
          .average_speed_m_per_s = speed,
          .average_rate_rad_per_s = rate};
}

}  // namespace

const std::vector<EurocSequence>& EurocSequences() {
  static const std::vector<EurocSequence> sequences = {
      {"MH_01_easy", "hall", {80.6, 182.0, 0.44, 0.22}},
      {"MH_02_easy", "hall", {73.5, 150.0, 0.49, 0.21}},
      {"MH_03_medium", "hall", {130.9, 132.0, 0.99, 0.29}},
      {"MH_04_difficult", "hall", {91.7, 99.0, 0.93, 0.24}},
      {"MH_05_difficult", "hall", {97.6, 111.0, 0.88, 0.21}},
      {"V1_01_easy", "room", {58.6, 144.0, 0.41, 0.28}},
      {"V1_02_medium", "room", {75.9, 83.5, 0.91, 0.56}},
      {"V1_03_difficult", "room", {79.0, 105.0, 0.75, 0.62}},
      {"V2_01_easy", "room", {36.5, 112.0, 0.33, 0.28}},
      {"V2_02_medium", "room", {83.2, 115.0, 0.72, 0.59}},
      {"V2_03_difficult", "room", {86.1, 115.0, 0.75, 0.66}}};
  return sequences;
}

HarmonicTrajectory::Channels EurocLikeChannels(const EurocSequence& sequence) {
  const std::vector<EurocSequence>& all = EurocSequences();
  const auto place = std::find_if(all.begin(), all.end(), [&](const EurocSequence& other) {
    return other.name == sequence.name;
  });
  CHECK(place != all.end());
  Random random(2014, static_cast<std::uint64_t>(place - all.begin()) + 1);
  const Shape shape = DrawShape(sequence, &random);
  // Length goes about with the loops' rate and the mean rate with the gaze's, but not steadily: the
  // last loop is cut off elsewhere. Half steps in the logarithm go past such places.
  double loop_rate = 0.15;
  double gaze_rate = 1.0;
  constexpr int kRounds = 40;
  constexpr double kClose = 3e-4;
  for (int round = 0; round < kRounds; ++round) {
    const double duration_s = sequence.thesis.duration_s;
    const SequenceRow row = MeasureEvery(
        kFitSampling_s, AfterRest(Scaled(shape, loop_rate, gaze_rate), duration_s), duration_s);
    const double length = sequence.thesis.length_m / row.length_m;
    const double rate = sequence.thesis.average_rate_rad_per_s / row.average_rate_rad_per_s;
    if (std::abs(length - 1.0) < kClose && std::abs(rate - 1.0) < kClose) break;
    loop_rate *= std::sqrt(length);
    gaze_rate *= std::sqrt(rate);
  }
  return Scaled(shape, loop_rate, gaze_rate);
}

SequenceRow MeasureMotion(const Trajectory& trajectory, double duration_s) {
  return MeasureEvery(kSampling_s, trajectory, duration_s);
}

std::string EurocSequencesText() {
  std::string text =
      "                          length [m]   duration [s]  speed [m/s]   rate [rad/s]\n"
      "flight like      world  thesis  made  thesis   made  thesis  made  thesis  made\n";
  for (const EurocSequence& sequence : EurocSequences()) {
    const SequenceRow& told = sequence.thesis;
    const SequenceRow made =
        MeasureMotion(AfterRest(EurocLikeChannels(sequence), told.duration_s), told.duration_s);
    char line[160];
    std::snprintf(
        line, sizeof(line), "%-15s  %-5s  %6.1f %5.1f  %6.1f %6.1f  %6.2f %5.2f  %6.2f %5.2f\n",
        sequence.name.c_str(), sequence.world.c_str(), told.length_m, made.length_m,
        told.duration_s, made.duration_s, told.average_speed_m_per_s, made.average_speed_m_per_s,
        told.average_rate_rad_per_s, made.average_rate_rad_per_s);
    text += line;
  }
  return text;
}

}  // namespace duet
