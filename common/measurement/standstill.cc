#include "common/measurement/standstill.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/so3.h"

namespace duet {
namespace {

// Fewer common tracks than this say nothing about motion.
constexpr std::size_t kMinCommonTracks = 8;
constexpr double kMotionQuantile = 0.75;
// Vibration may shake single frames by this multiple of what their means may move.
constexpr double kMaxExcursion = 3.0;

// Calls function(i, observation of `a`) for the tracks that `base` and `a` share (both sorted by
// id), i the index in `base`.
template <class Function>
void ForCommonTracks(const TrackFrame& base, const TrackFrame& a, Function&& function) {
  auto it = a.observations.begin();
  for (std::size_t i = 0; i < base.observations.size(); ++i) {
    const std::uint64_t id = base.observations[i].track_id;
    while (it != a.observations.end() && it->track_id < id) ++it;
    if (it == a.observations.end()) return;
    if (it->track_id == id) function(i, *it);
  }
}

// The kMotionQuantile of the values, which are reordered; nothing where they are too few.
std::optional<float> MotionQuantile(std::vector<float>* values) {
  if (values->size() < kMinCommonTracks) return std::nullopt;
  const auto nth = values->begin() + static_cast<std::ptrdiff_t>(
                                         kMotionQuantile * static_cast<double>(values->size()));
  std::nth_element(values->begin(), nth, values->end());
  return *nth;
}

// Mean and per-axis variance of the mean (readings taken as independent) of one half.
struct MeanOfHalf {
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> variance = Eigen::Matrix<double, 6, 1>::Zero();
};

MeanOfHalf MeanRates(const ImuSample* begin, const ImuSample* end) {
  MeanOfHalf half;
  const double n = static_cast<double>(end - begin);
  const auto stack = [](const ImuSample& s) {
    Eigen::Matrix<double, 6, 1> x;
    x << s.omega_m, s.a_m;
    return x;
  };
  for (const ImuSample* s = begin; s != end; ++s) half.mean += stack(*s) / n;
  for (const ImuSample* s = begin; s != end; ++s) {
    half.variance += (stack(*s) - half.mean).cwiseAbs2() / (n * std::max(n - 1.0, 1.0));
  }
  return half;
}

}  // namespace

bool StandstillDetector::Update(const TrackFrameSet& frames, Timestamp instant,
                                const ImuBuffer& imu) {
  if (!options_.enabled || frames.frames.empty()) return false;
  const TrackFrame& newest = frames.frames.front();
  const Timestamp window = ToNanoseconds(options_.window_s);
  // The oldest frame kept is the last one at or before the window's start, with the tolerance of a
  // tenth of the window for stamps that jitter.
  const Timestamp window_start = newest.timestamp - window;
  while (history_.size() > 1 && history_[1].timestamp <= window_start) {
    history_.erase(history_.begin());
  }
  const bool spans = !history_.empty() && history_.front().timestamp <= window_start + window / 10;
  const bool still = spans && imu.Covers(instant - window, instant) && ImageStands(newest);
  history_.push_back(newest);
  if (!still) return false;

  imu.Extract(instant - window, instant, &readings_);
  if (readings_.size() < 8) return false;
  const ImuSample* const middle = readings_.data() + readings_.size() / 2;
  const MeanOfHalf first = MeanRates(readings_.data(), middle);
  const MeanOfHalf second = MeanRates(middle, readings_.data() + readings_.size());
  const double bound = options_.max_mean_rate_change_sigmas;
  return ((second.mean - first.mean).cwiseAbs2().array() <=
          bound * bound * (first.variance + second.variance).array() + 1e-18)
      .all();
}

bool StandstillDetector::ImageStands(const TrackFrame& newest) {
  for (const TrackFrame& earlier : history_) {
    motions_.clear();
    ForCommonTracks(newest, earlier, [&](std::size_t i, const TrackObservation& o) {
      motions_.push_back(
          std::hypot(o.u - newest.observations[i].u, o.v - newest.observations[i].v));
    });
    const std::optional<float> excursion = MotionQuantile(&motions_);
    if (!excursion || *excursion > kMaxExcursion * options_.max_image_motion_px) return false;
  }
  // Mean over the earlier half against mean over the later one, for tracks seen in all frames.
  const std::size_t frames = history_.size() + 1;
  const std::size_t earlier_half = frames / 2;
  sums_.assign(newest.observations.size(), HalfSums());
  const auto add = [&](const TrackFrame& frame, bool later) {
    ForCommonTracks(newest, frame, [&](std::size_t i, const TrackObservation& o) {
      (later ? sums_[i].later : sums_[i].earlier) += Eigen::Vector2f(o.u, o.v);
      ++sums_[i].frames;
    });
  };
  for (std::size_t f = 0; f < history_.size(); ++f) add(history_[f], f >= earlier_half);
  add(newest, true);
  motions_.clear();
  for (const HalfSums& sum : sums_) {
    if (sum.frames != frames) continue;
    motions_.push_back((sum.later / static_cast<float>(frames - earlier_half) -
                        sum.earlier / static_cast<float>(earlier_half))
                           .norm());
  }
  const std::optional<float> motion = MotionQuantile(&motions_);
  return motion && *motion <= options_.max_image_motion_px;
}

StandstillResidual EvaluateStandstill(const NavState& state_i, const NavState& state_j,
                                      const StandstillOptions& options) {
  StandstillResidual result;
  const Eigen::Matrix3d R_BjG = state_j.R_GB.conjugate().toRotationMatrix();
  result.r.head<3>() = -(R_BjG * state_j.v_GB);
  result.r.tail<3>() = -BoxMinus(state_j.R_GB, state_i.R_GB);
  result.J_i.setZero();
  result.J_j.setZero();
  result.J_j.block<3, 3>(0, 0) = R_BjG * Hat(state_j.v_GB);
  result.J_j.block<3, 3>(0, 6) = R_BjG;
  // Linearized at the measured value, no rotation, where the left Jacobian is the identity: a turn
  // of both states about gravity then changes nothing, exactly, whatever their estimates.
  result.J_i.block<3, 3>(3, 0) = -Eigen::Matrix3d::Identity();
  result.J_j.block<3, 3>(3, 0).setIdentity();
  result.sigma.head<3>().setConstant(options.velocity_sigma_m_per_s);
  result.sigma.tail<3>().setConstant(options.rotation_sigma_rad);
  return result;
}

}  // namespace duet
