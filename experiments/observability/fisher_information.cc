#include "experiments/observability/fisher_information.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "backends/window/prior.h"
#include "backends/window/reprojection_factor.h"
#include "backends/window/window_state.h"
#include "common/imu/imu_delta.h"
#include "common/measurement/standstill.h"
#include "common/measurement/triangulation.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "experiments/observability/information_filter.h"

namespace duet {
namespace {

// A piece of a track on its way through the filter.
struct OpenPiece {
  int piece = -1;  // number of the piece within its track
  int landmark = -1;
  int last_frame = -1;
};

}  // namespace

FisherInformation::FisherInformation(const ObservedMotion& motion)
    : motion_(motion),
      layout_(motion.setup.shared.calibration, motion.setup.rig),
      off_instant_(PixelsLeaveTheInstant(motion.setup.shared.calibration, motion.setup.rig)),
      frames_(motion.states.size()) {
  CHECK_EQ(motion.frames.size(), motion.states.size());
  CHECK(!motion.states.empty());
  CHECK_LE(layout_.size(), ReprojectionJacobians::kMaxCalibration);
  for (const ImuSample& sample : motion.imu) imu_.Add(sample);
  for (const ImuSample& sample : motion.readings.empty() ? motion.imu : motion.readings) {
    readings_.Add(sample);
  }
  CHECK(imu_.Covers(motion.states.front().instant, motion.states.back().instant));
  CHECK(readings_.Covers(motion.states.front().instant, motion.states.back().instant));
  IntegrateLinks();
  Collect();
  TriangulateTracks();
}

double FisherInformation::duration_s() const {
  return SecondsBetween(motion_.states.front().instant, motion_.states.back().instant);
}

int FisherInformation::frames_at_rest() const {
  return static_cast<int>(std::count_if(frames_.begin(), frames_.end(),
                                        [](const Frame& f) { return f.at_rest_since_before; }));
}

void FisherInformation::IntegrateLinks() {
  constexpr double kRateMargin_s = 1e-3;
  const EstimatorSetup& setup = motion_.setup;
  const double reach_s = 0.5 * std::abs(setup.rig.t_r_s) + kRateMargin_s;
  ImuDeltaOptions options;
  options.calibration_jacobians = layout_.EstimatesImu();
  StandstillDetector standstill(setup.shared.standstill);
  std::vector<ImuSample> readings;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    Frame& frame = frames_[k];
    const InertialState& state = motion_.states[k];
    if (off_instant_) {
      frame.rates.Assign(readings_, state.instant, reach_s, state.biases, setup.rig.imu);
    }
    const bool at_rest = standstill.Update(motion_.frames[k], state.instant, imu_);
    if (k == 0) continue;
    frame.at_rest_since_before = at_rest;
    const InertialState& before = motion_.states[k - 1];
    CHECK_GT(state.instant, before.instant);
    readings_.Extract(before.instant, state.instant, &readings);
    const ImuDelta delta =
        IntegrateImu(readings, before.biases, setup.rig.imu, setup.imu_noise, options);
    const Matrix15d W = SquareRootInformation(delta.covariance);
    Vector15d r;
    EvaluateImuFactor(delta, before.nav, before.biases, state.nav, state.biases, setup.rig.imu,
                      setup.g_G, &r, &frame.link);
    frame.link.J_i = (W * frame.link.J_i).eval();
    frame.link.J_j = (W * frame.link.J_j).eval();
    frame.link.J_T = (W * frame.link.J_T).eval();
  }
}

void FisherInformation::Collect() {
  std::unordered_map<std::uint64_t, int> index;  // looked up only; order comes from the frames
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    // Ascending in (camera, track id), as the stream is.
    for (const TrackFrame& camera : motion_.frames[k].frames) {
      for (const TrackObservation& o : camera.observations) {
        const auto [found, inserted] = index.try_emplace(o.track_id, tracks());
        if (inserted) tracks_.push_back({.first_frame = static_cast<int>(k)});
        frames_[k].pixels.push_back({.track = found->second,
                                     .piece_frame = 0,
                                     .observation = {.camera = camera.camera, .uv = {o.u, o.v}}});
      }
    }
    std::vector<int> seen;
    for (Pixel& pixel : frames_[k].pixels) {
      pixel.piece_frame = tracks_[pixel.track].frames;
      seen.push_back(pixel.track);
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (const int track : seen) ++tracks_[track].frames;
  }
}

ObservingState FisherInformation::StateOf(int frame) const {
  return {motion_.states[frame].nav, motion_.setup.rig.t_d_s,
          off_instant_ ? &frames_[frame].rates : nullptr};
}

void FisherInformation::TriangulateTracks() {
  std::vector<std::vector<TrackObservationInState>> observations(tracks_.size());
  for (int k = 0; k < frames(); ++k) {
    for (const Pixel& pixel : frames_[k].pixels) {
      observations[pixel.track].push_back({StateOf(k), pixel.observation});
    }
  }
  const EstimatorSetup& setup = motion_.setup;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (observations[i].size() < 2) continue;
    Track& track = tracks_[i];
    track.has_point =
        Triangulate(setup.rig, observations[i], motion_.states[track.first_frame].nav.pose(),
                    setup.g_G, {}, &track.point) == TriangulationStatus::kOk;
    not_triangulated_ += track.has_point ? 0 : 1;
  }
}

Eigen::MatrixXd FisherInformation::PriorInformation(double scale) const {
  Vector15d widening = Vector15d::Constant(scale);
  widening.segment<4>(2).setOnes();  // yaw, position
  const Matrix15d covariance =
      widening.asDiagonal() * motion_.start_covariance * widening.asDiagonal();
  const Eigen::Index n = kFrameSize + layout_.size();
  InformationForm form{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  AddPrior(StartPrior({.state = {}, .covariance = covariance}, motion_.setup.rig, layout_), 1,
           layout_, &form);
  form.H.bottomRightCorner(layout_.size(), layout_.size()) /= scale * scale;
  return form.H;
}

PredictedCovariance FisherInformation::Predict(const InformationOptions& options,
                                               const Observer& observer) const {
  const EstimatorSetup& setup = motion_.setup;
  RigCalibration rig = setup.rig;
  if (options.at_instants) rig.t_r_s = 0.0;
  const double weight = 1.0 / setup.shared.pixel_noise_px;
  const auto piece_of = [&](const Pixel& pixel) {
    return options.window_frames > 0 ? pixel.piece_frame / options.window_frames : 0;
  };
  // Pixels of each piece of each track.
  std::vector<std::vector<int>> counts(tracks_.size());
  for (const Frame& frame : frames_) {
    for (const Pixel& pixel : frame.pixels) {
      std::vector<int>& pieces = counts[pixel.track];
      const auto piece = static_cast<std::size_t>(piece_of(pixel));
      if (pieces.size() <= piece) pieces.resize(piece + 1);
      ++pieces[piece];
    }
  }

  PredictedCovariance result;
  InformationFilter filter(layout_, PriorInformation(options.prior_scale));
  std::map<int, OpenPiece> open;  // by track
  PixelJacobians J;
  J.calibration.resize(2, layout_.size());
  auto next_time = options.times_s.begin();
  for (int k = 0; k < frames(); ++k) {
    const Frame& frame = frames_[k];
    // Landmarks that this frame does not go on with are done before it comes.
    for (const Pixel& pixel : frame.pixels) {
      const auto found = open.find(pixel.track);
      if (found != open.end() && found->second.piece == piece_of(pixel)) {
        found->second.last_frame = k;
      }
    }
    for (auto it = open.begin(); it != open.end();) {
      if (it->second.last_frame == k) {
        ++it;
        continue;
      }
      filter.CloseLandmark(it->second.landmark);
      it = open.erase(it);
    }
    if (k > 0) {
      StandstillResidual rest;
      if (frame.at_rest_since_before) {
        rest = EvaluateStandstill(motion_.states[k - 1].nav, motion_.states[k].nav,
                                  setup.shared.standstill);
      }
      filter.Propagate(frame.link, frame.at_rest_since_before ? &rest : nullptr);
    }
    for (const Pixel& pixel : frame.pixels) {
      const Track& track = tracks_[pixel.track];
      if (!track.has_point) continue;
      const int piece = piece_of(pixel);
      if (counts[pixel.track][static_cast<std::size_t>(piece)] <
          std::max(2, options.min_observations)) {
        ++result.left_out;
        continue;
      }
      Eigen::Vector2d uv;
      ObservationJacobians model;
      if (!PredictPixel(rig, motion_.states[track.first_frame].nav.pose(), track.point, StateOf(k),
                        pixel.observation, setup.g_G, &uv, &model)) {
        continue;
      }
      auto [entry, is_new] = open.try_emplace(pixel.track);
      if (is_new) {
        entry->second = {.piece = piece, .landmark = filter.OpenLandmark(), .last_frame = k};
        ++result.landmarks;
      }
      // The point is fixed in G: neither the first frame nor its camera is a variable of it.
      model.anchor_extrinsics.setZero();
      J.landmark = weight * model.landmark;
      J.state = weight * model.state;
      CalibrationJacobian(model, layout_, pixel.observation.camera, J.calibration);
      J.calibration *= weight;
      filter.AddPixel(entry->second.landmark, J);
      ++result.pixels;
    }
    const double time_s = SecondsBetween(motion_.states.front().instant, motion_.states[k].instant);
    const bool last = k + 1 == frames();
    const bool asked = next_time != options.times_s.end() && time_s >= *next_time - 1e-6;
    if (asked || last) {
      while (next_time != options.times_s.end() && time_s >= *next_time - 1e-6) ++next_time;
      result.covariance = filter.Covariance();
      if (result.covariance.rows() == 0) {
        throw InputError(
            "shared.calibration: beside these measurements the priors are so wide that the "
            "information is not positive definite in double precision; expected smaller sigmas");
      }
      result.history.push_back(
          {time_s, result.covariance.diagonal().tail(layout_.size()).cwiseSqrt()});
    }
    if (observer) observer(k + 1);
  }
  return result;
}

}  // namespace duet
