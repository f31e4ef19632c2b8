#include "common/measurement/standstill.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/so3.h"

namespace duet {
namespace {

// Fewer common tracks than this say nothing about motion.
constexpr std::size_t kMinCommonTracks = 8;
constexpr double kMotionQuantile = 0.75;

// Distances in px between the tracks that both frames hold (both sorted by id).
void CommonTrackMotions(const TrackFrame& a, const TrackFrame& b, std::vector<float>* motions) {
  motions->clear();
  auto it = a.observations.begin();
  for (const TrackObservation& o : b.observations) {
    while (it != a.observations.end() && it->track_id < o.track_id) ++it;
    if (it == a.observations.end()) break;
    if (it->track_id != o.track_id) continue;
    motions->push_back(std::hypot(it->u - o.u, it->v - o.v));
  }
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
  bool at_rest = spans && imu.Covers(instant - window, instant);
  for (auto it = history_.begin(); at_rest && it != history_.end(); ++it) {
    CommonTrackMotions(*it, newest, &motions_);
    if (motions_.size() < kMinCommonTracks) {
      at_rest = false;
      break;
    }
    const auto nth = motions_.begin() + static_cast<std::ptrdiff_t>(
                                            kMotionQuantile * static_cast<double>(motions_.size()));
    std::nth_element(motions_.begin(), nth, motions_.end());
    at_rest = *nth <= options_.max_image_motion_px;
  }
  history_.push_back(newest);
  if (!at_rest) return false;

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

StandstillResidual EvaluateStandstill(const NavState& state_i, const NavState& state_j,
                                      const StandstillOptions& options) {
  StandstillResidual result;
  result.r.head<3>() = -state_j.v_GB;
  result.r.tail<3>() = -BoxMinus(state_j.R_GB, state_i.R_GB);
  // Linearized at the measured value, no rotation, where the left Jacobian is the identity: a turn
  // of both states about gravity then changes nothing, exactly, whatever their estimates.
  result.J_i.setZero();
  result.J_j.setZero();
  result.J_i.block<3, 3>(3, 0) = -Eigen::Matrix3d::Identity();
  result.J_j.block<3, 3>(3, 0).setIdentity();
  result.J_j.block<3, 3>(0, 6).setIdentity();
  result.sigma.head<3>().setConstant(options.velocity_sigma_m_per_s);
  result.sigma.tail<3>().setConstant(options.rotation_sigma_rad);
  return result;
}

}  // namespace duet
