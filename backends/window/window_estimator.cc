#include "backends/window/window_estimator.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/support/logging.h"

namespace duet {
namespace {

ReprojectionSetup MakeReprojectionSetup(const EstimatorSetup& setup) {
  ReprojectionSetup reprojection;
  reprojection.g_G = setup.g_G;
  reprojection.pixel_noise_px = setup.shared.pixel_noise_px;
  reprojection.off_instant = PixelsLeaveTheInstant(setup.shared.calibration, setup.rig);
  return reprojection;
}

}  // namespace

WindowEstimator::WindowEstimator(const EstimatorSetup& setup, const WindowOptions& options)
    : setup_(setup),
      options_(options),
      layout_(setup.shared.calibration, setup.rig),
      reprojection_(MakeReprojectionSetup(setup)),
      rig_(setup.rig),
      longest_rate_reach_s_(2.0 * setup.shared.max_abs_t_d_s + 0.5 * setup.shared.max_abs_t_r_s),
      standstill_(setup.shared.standstill),
      linearizer_(options_, reprojection_, setup_.shared.standstill, layout_),
      problem_(options_, reprojection_, setup_.shared.standstill, layout_) {
  CHECK_LE(layout_.size(), ReprojectionJacobians::kMaxCalibration);
  CHECK_GE(options_.max_frames, 3);
  frames_.reserve(options_.max_frames + 1);
}

void WindowEstimator::Initialize(const InitialCondition& initial) {
  CHECK(frames_.empty()) << "Initialize is called once";
  initial_ = initial;
  WindowFrame frame;
  frame.state = initial.state;
  frame.timestamp = initial.state.instant - ToNanoseconds(rig_.t_d_s);
  frame.t_d_at_instant_s = rig_.t_d_s;
  frame.origin = frame.state;
  frame.pose_in_prior = frame.velocity_in_prior = frame.biases_in_prior = true;
  frames_.push_back(std::move(frame));
  last_aided_ = initial.state.instant;
  prior_ = StartPrior(initial, rig_, layout_);
}

void WindowEstimator::AddImu(const ImuSample& sample) { imu_.Add(sample); }

/// One frame, one screen.
const EstimatorOutput& WindowEstimator::ProcessFrame(const TrackFrameSet& frames) {
  if (!Accept(frames)) return output_;
  Preintegrate();
  AppendFrame(frames);
  TriangulateNew();
  BuildProblem();
  Solve();
  RejectOutliers();
  DecideKeyframe();
  Report();
  Marginalize();
  Slide();
  return output_;
}

bool WindowEstimator::Accept(const TrackFrameSet& frames) {
  output_.frame_timestamp = frames.timestamp;
  output_.features = {};
  output_.iterations = 0;
  output_.standstill = false;
  if (output_.status == EstimatorStatus::kFailed) return false;
  output_.rig = rig_;
  instant_ = frames.timestamp + ToNanoseconds(rig_.t_d_s);
  if (!initial_ || instant_ < initial_->state.instant) {
    (void)standstill_.Update(frames, instant_, imu_);  // rest may have begun before the start
    return false;
  }

  const Timestamp last = frames_.back().state.instant;
  const bool first = newest() == 0 && table_.landmarks().empty() && instant_ == last;
  if (!first && instant_ <= last) {
    Skip("the frame is not after the last one");
    return false;
  }
  if (!imu_.Covers(last, instant_)) {
    Skip("the IMU does not cover the frame's interval");
    return false;
  }
  if (imu_.LongestGap(last, instant_) > setup_.shared.max_imu_gap_s) {
    if (SecondsBetween(last, instant_) > setup_.shared.failure.max_imu_outage_s) {
      Fail("the IMU has a gap that no frame reaches over");
      return false;
    }
    Skip("the IMU has a gap in the frame's interval");
    return false;
  }
  return true;
}

void WindowEstimator::Skip(const std::string& reason) {
  ++skipped_frames_;
  output_.status = EstimatorStatus::kDeadReckoning;
  output_.reason = "skipped: " + reason;
}

void WindowEstimator::Fail(const std::string& reason) {
  if (output_.status == EstimatorStatus::kFailed) return;
  output_.status = EstimatorStatus::kFailed;
  output_.reason = reason;
}

ImuLink WindowEstimator::Integrate(Timestamp from, Timestamp to, const ImuBiases& biases,
                                   const ImuCalibration& calibration) {
  imu_.Extract(from, to, &readings_);
  ImuDeltaOptions delta_options;
  delta_options.calibration_jacobians = layout_.EstimatesImu();
  ImuLink link;
  link.delta = IntegrateImu(readings_, biases, calibration, setup_.imu_noise, delta_options);
  link.sqrt_information = SquareRootInformation(link.delta.covariance);
  return link;
}

void WindowEstimator::Preintegrate() {
  const StageTimer::Scope scope(timer_, "preintegrate");
  new_link_.reset();
  const WindowFrame& last = frames_.back();
  if (instant_ == last.state.instant) return;  // the first image at the first state's instant
  new_link_ = Integrate(last.state.instant, instant_, last.state.biases, rig_.imu);
}

void WindowEstimator::AppendFrame(const TrackFrameSet& frames) {
  const StageTimer::Scope scope(timer_, "append");
  if (new_link_) {
    const WindowFrame& last = frames_.back();
    WindowFrame frame;
    frame.timestamp = frames.timestamp;
    frame.t_d_at_instant_s = rig_.t_d_s;
    frame.state.instant = instant_;
    frame.state.nav = Predict(last.state.nav, new_link_->delta, setup_.g_G);
    frame.state.biases = last.state.biases;
    frame.link = std::move(new_link_);
    frames_.push_back(std::move(frame));
  }
  WindowFrame& frame = frames_.back();
  frame.at_rest_since_before = standstill_.Update(frames, instant_, imu_) && newest() > 0;

  for (const Landmark& landmark : table_.landmarks()) {
    output_.features.lost += landmark.seen_newest ? 1 : 0;
  }
  output_.features.observed = table_.AddFrame(frames, newest(), rig_);
  for (const Landmark& landmark : table_.landmarks()) {
    const auto& o = landmark.observations;
    if (landmark.seen_newest && o.front().frame < newest()) --output_.features.lost;
  }
  output_.features.lost = std::max(output_.features.lost, 0);
}

// How far from the frame's instant a pixel may have been taken, s: as the times stand, and as far
// as the coming solve may move them (beyond, the outermost rates go on).
double WindowEstimator::RateReach(const WindowFrame& frame) const {
  constexpr double kMarginSigmas = 4.0;
  constexpr double kLeastMarginSeconds = 1e-3;
  const auto sigma = [&](CalibrationBlock block) {
    const int offset = layout_.OffsetOf(block);
    if (offset < 0) return 0.0;
    const Eigen::Index i = kFrameSize + offset;
    return output_.covariance.rows() > i ? std::sqrt(output_.covariance(i, i))
                                         : layout_.PriorSigmas()[offset];
  };
  const double now_s = std::abs(rig_.t_d_s - frame.t_d_at_instant_s) + 0.5 * std::abs(rig_.t_r_s);
  const double margin_s = kMarginSigmas * (sigma(CalibrationBlock::kTimeOffset) +
                                           0.5 * sigma(CalibrationBlock::kReadoutTime));
  return std::min(now_s + margin_s + kLeastMarginSeconds, longest_rate_reach_s_);
}

void WindowEstimator::TriangulateNew() {
  const StageTimer::Scope scope(timer_, "triangulate");
  linearizer_.SetWindow(frames_, rig_);
  if (reprojection_.off_instant) {
    for (WindowFrame& frame : frames_) {
      frame.rates.Assign(imu_, frame.state.instant, RateReach(frame), frame.state.biases, rig_.imu);
    }
    for (const Landmark& landmark : table_.landmarks()) {
      for (const LandmarkObservation& o : landmark.observations) o.motion.Clear();
    }
  }
  TriangulationOptions triangulation;
  triangulation.min_parallax_rad = options_.min_parallax_rad;
  for (Landmark& landmark : table_.landmarks()) {
    if (landmark.has_value || landmark.observations.size() < 2) continue;
    if (!landmark.seen_newest && options_.tracks == WindowOptions::Tracks::kLive) continue;
    triangulation_.clear();
    for (const LandmarkObservation& o : landmark.observations) {
      const WindowFrame& frame = frames_[o.frame];
      triangulation_.push_back({{frame.state.nav, frame.t_d_at_instant_s,
                                 reprojection_.off_instant ? &frame.rates : nullptr},
                                o.pixel});
    }
    const TriangulationStatus status =
        Triangulate(rig_, triangulation_, frames_[landmark.anchor()].state.nav.pose(), setup_.g_G,
                    triangulation, &landmark.value);
    landmark.has_value = status == TriangulationStatus::kOk;
    if (!landmark.has_value) ++output_.features.not_triangulated;
    if (landmark.has_value &&
        options_.landmark_parameters == WindowOptions::LandmarkParameters::kInverseDepthOnly) {
      landmark.has_value = FixByAnchorPixel(rig_, &landmark);
    }
  }
}

void WindowEstimator::Reintegrate() {
  for (int i = 1; i <= newest(); ++i) {
    WindowFrame& frame = frames_[i];
    const WindowFrame& before = frames_[i - 1];
    if (!frame.link) continue;
    if (DistanceFromLinearization(frame.link->delta, before.state.biases, rig_.imu) >
        options_.reintegration_threshold) {
      frame.link =
          Integrate(before.state.instant, frame.state.instant, before.state.biases, rig_.imu);
    }
  }
}

void WindowEstimator::SelectLandmarks() {
  std::vector<Landmark>& landmarks = table_.landmarks();
  selection_.clear();
  for (int l = 0; l < static_cast<int>(landmarks.size()); ++l) {
    Landmark& landmark = landmarks[l];
    landmark.in_problem = false;
    if (!landmark.has_value || landmark.observations.size() < 2) continue;
    if (!HasParallax(landmark, linearizer_.now(), options_.min_parallax_rad)) continue;
    Eigen::Vector2d r;
    for (const LandmarkObservation& o : landmark.observations) {
      landmark.has_value =
          landmark.has_value && EvaluateReprojection(reprojection_, linearizer_.now(), frames_,
                                                     landmark.anchor(), o, landmark.value, &r);
    }
    const bool finished =
        !landmark.seen_newest || (landmark.anchor() == 0 && newest() + 1 >= options_.max_frames);
    if (landmark.has_value && (finished || options_.tracks == WindowOptions::Tracks::kLive)) {
      selection_.push_back(l);
    }
  }
  if (static_cast<int>(selection_.size()) > options_.max_landmarks) {
    std::stable_sort(selection_.begin(), selection_.end(), [&](int a, int b) {
      return landmarks[a].observations.size() > landmarks[b].observations.size();
    });
    selection_.resize(options_.max_landmarks);
  }
  for (const int l : selection_) {
    landmarks[l].in_problem = true;
    const bool counts =
        landmarks[l].seen_newest || options_.tracks == WindowOptions::Tracks::kFinished;
    output_.features.used += counts ? 1 : 0;
  }
}

void WindowEstimator::BuildProblem() {
  const StageTimer::Scope scope(timer_, "build");
  Reintegrate();
  SelectLandmarks();
  problem_.Build(frames_, rig_, table_.landmarks(), prior_);
}

void WindowEstimator::Solve() {
  const StageTimer::Scope scope(timer_, "solve");
  summary_ = problem_.Solve();
  if (!summary_.usable) {
    Fail("the solver found no solution: " + summary_.message);
    return;
  }
  problem_.Store(&frames_, &rig_, &table_.landmarks());
  HoldTimes(layout_, setup_.shared.time_bounds(), &rig_);
  linearizer_.SetWindow(frames_, rig_);
}

void WindowEstimator::RejectOutliers() {
  const StageTimer::Scope scope(timer_, "reject");
  const double bound = options_.max_reprojection_sigmas;
  for (Landmark& landmark : table_.landmarks()) {
    if (!landmark.in_problem) continue;
    bool good = landmark.value.allFinite();
    Eigen::Vector2d r;
    for (const LandmarkObservation& o : landmark.observations) {
      if (!good) break;
      good = EvaluateReprojection(reprojection_, linearizer_.now(), frames_, landmark.anchor(), o,
                                  landmark.value, &r) &&
             (bound == 0.0 || r.squaredNorm() <= bound * bound);
    }
    if (good) continue;
    landmark.observations.clear();
    ++output_.features.gated;
  }
  table_.RemoveEmpty();
}

void WindowEstimator::DecideKeyframe() {
  keyframe_ = true;
  if (newest() < 2 || options_.keyframes == WindowOptions::Keyframes::kEveryFrame) return;
  const int second = newest() - 1;
  const int before = newest() - 2;
  const bool at_rest = frames_[newest()].at_rest_since_before;
  const double interval_s =
      SecondsBetween(frames_[before].state.instant, frames_[newest()].state.instant);
  if (!at_rest && interval_s > options_.max_keyframe_interval_s) return;
  const MeanMotion motion = MeanPixelMotion(table_.landmarks(), before, second);
  keyframe_ =
      motion.tracks < options_.min_common_tracks || motion.mean_px >= options_.min_parallax_px;
}

// Which landmarks may tell of the poses. A wrong depth is a wrong scale of all that its pixels say
// of the way between frames: where nothing moved but the rig's errors, that is made of them. `H`:
// what is known without the landmarks at hand (upper triangle).
void WindowEstimator::JudgeDepths(const Eigen::MatrixXd& H) {
  const bool all =
      options_.min_depth_sigmas == 0.0 ||
      options_.landmark_parameters == WindowOptions::LandmarkParameters::kInverseDepthOnly;
  std::optional<Eigen::LLT<Eigen::MatrixXd, Eigen::Upper>> llt;
  Eigen::VectorXd scale;
  for (Landmark& landmark : table_.landmarks()) {
    if (!landmark.in_problem || landmark.depth_known) continue;
    landmark.depth_known = all;
    if (all) continue;
    if (!llt) {
      scale = H.diagonal().cwiseSqrt().cwiseInverse();
      llt.emplace(scale.asDiagonal() * H * scale.asDiagonal());
      if (llt->info() != Eigen::Success) return;
    }
    linearizer_.LinearizeDepth(landmark, &depth_);
    depth_.row.array() *= scale.array();
    llt->matrixL().solveInPlace(depth_.row);
    const double rho = landmark.value.z() * depth_.diagonal;
    landmark.depth_known = rho > 0.0 && rho * rho > options_.min_depth_sigmas *
                                                        options_.min_depth_sigmas *
                                                        (1.0 + depth_.row.squaredNorm());
  }
}

void WindowEstimator::CheckHealth() {
  const std::string failure = FailureOf(frames_.back().state, setup_.shared.failure);
  if (!failure.empty()) Fail(failure);
}

void WindowEstimator::Report() {
  const StageTimer::Scope scope(timer_, "covariance");
  CheckHealth();
  output_.iterations = summary_.iterations;
  output_.keyframe = keyframe_;
  output_.standstill = frames_.back().at_rest_since_before;
  if (output_.status == EstimatorStatus::kFailed) return;
  output_.state = frames_.back().state;
  output_.rig = rig_;

  NormalEquations equations(newest() + 1, layout_);
  equations.AddPrior(prior_);
  for (int i = 1; i <= newest(); ++i) linearizer_.AddLink(i, &equations);
  JudgeDepths(equations.H());
  int known = 0;
  for (const Landmark& landmark : table_.landmarks()) {
    if (!landmark.in_problem || !landmark.depth_known) continue;
    linearizer_.AddLandmark(landmark, newest(), &equations);
    known += landmark.seen_newest || options_.tracks == WindowOptions::Tracks::kFinished ? 1 : 0;
  }
  if (known >= options_.min_landmarks || output_.standstill) {
    last_aided_ = output_.state.instant;
  }
  const double unaided_s = SecondsBetween(last_aided_, output_.state.instant);
  Eigen::MatrixXd covariance = NewestCovariance(equations.Take().H, layout_.size());
  if (covariance.size() == 0) {
    // Positions that are known to micrometres against one another and to tens of metres together
    // are beyond an information matrix in doubles.
    return Fail(unaided_s > options_.max_unaided_s
                    ? "no landmark of known depth for " + std::to_string(unaided_s) +
                          " s: the position is lost"
                    : "the information matrix is not positive definite");
  }
  output_.covariance = std::move(covariance);

  const bool seen = output_.features.observed >= options_.min_landmarks || output_.standstill;
  const bool aided = unaided_s <= options_.max_unaided_s;
  output_.status = seen && aided ? EstimatorStatus::kTracking : EstimatorStatus::kDeadReckoning;
  output_.reason = !seen ? "too few tracks" : !aided ? "too few landmarks of known depth" : "";
}

void WindowEstimator::Slide() {
  const StageTimer::Scope scope(timer_, "slide");
  if (output_.status == EstimatorStatus::kFailed) return;
  if (dropped_frame_ >= 0) {
    table_.DropFrame(dropped_frame_, linearizer_.now());
    frames_.erase(frames_.begin() + dropped_frame_);
  }
  // Behind every frame as far as its rates may reach, and as far as rest is judged.
  const Timestamp judged = instant_ - ToNanoseconds(setup_.shared.standstill.window_s);
  imu_.DropBefore(std::min(frames_.front().state.instant, judged) -
                  ToNanoseconds(longest_rate_reach_s_));
}

std::optional<NavState> WindowEstimator::PredictAt(Timestamp t) const {
  if (frames_.empty() || output_.status == EstimatorStatus::kFailed) return std::nullopt;
  const InertialState& state = frames_.back().state;
  if (t == state.instant) return state.nav;
  if (imu_.empty() || !imu_.Covers(state.instant, t)) return std::nullopt;
  std::vector<ImuSample> readings;
  imu_.Extract(state.instant, t, &readings);
  const ImuDeltaOptions motion_only{
      .covariance = false, .bias_jacobians = false, .calibration_jacobians = false};
  return Predict(state.nav,
                 IntegrateImu(readings, state.biases, rig_.imu, setup_.imu_noise, motion_only),
                 setup_.g_G);
}

}  // namespace duet
