#include "backends/msckf/msckf.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "backends/msckf/transition.h"
#include "backends/msckf/trapezoid_delta.h"
#include "common/support/logging.h"

namespace duet {
namespace {

/// Share of true standstills that the test lets pass. Rest has been judged on images and IMU
/// before; the test only guards against a verdict that contradicts the filter grossly.
constexpr double kStandstillGateProbability = 0.9999;
constexpr int kStandstillRows = 6;

}  // namespace

Msckf::Msckf(const EstimatorSetup& setup, const MsckfOptions& options)
    : setup_(setup),
      options_(options),
      state_(setup.rig, setup.shared.calibration, options.max_clones),
      feature_update_(setup, options),
      standstill_detector_(setup.shared.standstill),
      standstill_gate_(kStandstillGateProbability, kStandstillRows) {
  CHECK_GE(options.max_clones, 3);
}

void Msckf::Initialize(const InitialCondition& initial) {
  CHECK(!initialized_) << "Initialize may be called once";
  state_.Start(initial);
  start_ = initial.state.instant;
  initialized_ = true;
}

const EstimatorOutput& Msckf::ProcessFrame(const TrackFrameSet& frames) {
  const Timestamp instant = frames.timestamp + ToNanoseconds(state_.rig().t_d_s);
  if (!BeginFrame(frames, instant)) return output_;
  Propagate(instant);        // 6.3, appendix B
  Augment(frames);           // 6.4
  UpdateStandstill(frames);  // 7.3.3
  SelectFinishedTracks();    // 6.5.1, 6.6
  Triangulate();             // 5.1, 5.4
  Linearize();               // 6.5.1
  ProjectNullspace();        // 6.5.2
  Gate();                    // 6.5.3
  Compress();                // 6.30 to 6.32
  Update();                  // 6.33 to 6.35
  Prune();                   // 6.6
  return Report();
}

bool Msckf::BeginFrame(const TrackFrameSet& frames, Timestamp instant) {
  output_.frame_timestamp = frames.timestamp;
  output_.features = FeatureCounts();
  output_.keyframe = true;
  output_.standstill = false;
  if (output_.status == EstimatorStatus::kFailed) return false;
  if (!initialized_ || instant < start_) {
    (void)standstill_detector_.Update(frames, instant, imu_);  // rest may begin before the start
    return false;
  }

  const Timestamp previous = state_.inertial().instant;
  const bool is_first = state_.clones().empty() && instant == previous;
  if (instant <= previous && !is_first) {
    Skip("the frame is not after the last one");
  } else if (imu_.empty() || !imu_.Covers(previous, instant)) {
    Skip("the IMU does not cover the frame's interval");
  } else if (imu_.LongestGap(previous, instant) > setup_.shared.max_imu_gap_s) {
    // Every later interval holds the gap too.
    if (SecondsBetween(previous, instant) > setup_.shared.failure.max_imu_outage_s) {
      Fail("the IMU has a gap that no frame reaches over");
    } else {
      Skip("the IMU has a gap in the frame's interval");
    }
  } else {
    return true;
  }
  return false;
}

void Msckf::Skip(const std::string& reason) {
  ++skipped_frames_;
  output_.status = EstimatorStatus::kDeadReckoning;
  output_.reason = reason;
}

void Msckf::Propagate(Timestamp instant) {
  const StageTimer::Scope scope(timer_, "propagate");
  const InertialState& inertial = state_.inertial();
  if (instant == inertial.instant) return;
  imu_.Extract(inertial.instant, instant, &readings_);
  const bool trapezoids = options_.transition == MsckfOptions::TransitionRule::kThesisTrapezoid;
  const auto& integrate = trapezoids ? IntegrateImuByTrapezoids : IntegrateImu;
  const ImuDelta delta = integrate(readings_, inertial.biases, state_.rig().imu, setup_.imu_noise,
                                   {.calibration_jacobians = state_.layout().EstimatesImu()});
  const NavState next = Predict(inertial.nav, delta, setup_.g_G);
  const NavState& linearized_at = options_.first_estimates ? state_.nav_fej() : inertial.nav;
  const Transition transition = MakeTransition(delta, linearized_at, next, setup_.g_G);
  PropagateCovariance(transition, state_.layout(), state_.P(), &propagation_workspace_);
  state_.SetPropagated(next, instant);
}

void Msckf::Augment(const TrackFrameSet& frames) {
  const StageTimer::Scope scope(timer_, "augment");
  state_.Augment(state_.rig().t_d_s);
  output_.features.observed = tracks_.Add(frames, state_.clones().back().id);
  if (state_.time_matters()) RefreshRates();
}

void Msckf::RefreshRates() {
  constexpr double kMarginSeconds = 1e-3;
  const RigCalibration& rig = state_.rig();
  for (Clone& clone : state_.clones()) {
    const double reach_s =
        std::abs(rig.t_d_s - clone.t_d_at_instant_s) + 0.5 * std::abs(rig.t_r_s) + kMarginSeconds;
    clone.rates.Assign(imu_, clone.instant, reach_s, state_.inertial().biases, rig.imu);
  }
}

void Msckf::UpdateStandstill(const TrackFrameSet& frames) {
  if (!setup_.shared.standstill.enabled) return;
  const StageTimer::Scope scope(timer_, "standstill");
  const Timestamp instant = state_.inertial().instant;
  const bool at_rest = standstill_detector_.Update(frames, instant, imu_);
  const int clone_count = static_cast<int>(state_.clones().size());
  if (!at_rest || clone_count < 2) return;

  const int previous = clone_count - 2;
  const Clone& before = state_.clones()[previous];
  StandstillResidual standstill =
      EvaluateStandstill(before.nav, state_.inertial().nav, setup_.shared.standstill);
  if (options_.first_estimates) {
    const Eigen::Matrix<double, kStandstillRows, 1> r = standstill.r;
    standstill = EvaluateStandstill(before.nav_fej, state_.nav_fej(), setup_.shared.standstill);
    standstill.r = r;
  }
  // The previous clone takes part with (theta, p): its velocity is not measured.
  constexpr int kPrevious = 6;
  constexpr int kNewest = 9;
  Eigen::Matrix<double, kStandstillRows, kPrevious + kNewest + 1> H_r;
  H_r << standstill.J_i.leftCols<kPrevious>(), standstill.J_j, standstill.r;
  H_r.array().colwise() /= standstill.sigma.array();
  std::array<int, kPrevious + kNewest> components;
  std::iota(components.begin(), components.begin() + kPrevious, state_.CloneOffset(previous));
  std::iota(components.begin() + kPrevious, components.end(), 0);
  const Eigen::MatrixXd P = Eigen::MatrixXd(state_.P())(components, components);
  if (!standstill_gate_.Passes(H_r.leftCols(H_r.cols() - 1), H_r.rightCols<1>(), P)) return;
  ApplyUpdate(H_r, components, MeasurementShape::kFull, false);
  output_.standstill = true;
}

void Msckf::SelectFinishedTracks() {
  const StageTimer::Scope scope(timer_, "select");
  // At rest the oldest clone stays (Prune), and with it what it saw.
  const bool oldest_goes =
      !output_.standstill && static_cast<int>(state_.clones().size()) == options_.max_clones;
  feature_update_.SelectFinishedTracks(state_, oldest_goes, &tracks_, &output_.features);
}

void Msckf::Triangulate() {
  const StageTimer::Scope scope(timer_, "triangulate");
  feature_update_.Triangulate(state_, &tracks_, &output_.features);
}

void Msckf::Linearize() {
  const StageTimer::Scope scope(timer_, "linearize");
  feature_update_.Linearize(state_, &tracks_, &output_.features);
}

void Msckf::ProjectNullspace() {
  const StageTimer::Scope scope(timer_, "nullspace");
  feature_update_.ProjectNullspace(state_);
}

void Msckf::Gate() {
  const StageTimer::Scope scope(timer_, "gate");
  feature_update_.Gate(state_, &tracks_, &output_.features);
}

void Msckf::Compress() {
  const StageTimer::Scope scope(timer_, "compress");
  stack_.emplace(feature_update_.Compress());
}

void Msckf::Update() {
  const StageTimer::Scope scope(timer_, "update");
  if (stack_->rows() == 0) return;
  ApplyUpdate(*stack_, feature_update_.columns().components(), feature_update_.shape(),
              feature_update_.TakeProduct(&kalman_workspace_.P_H));
}

void Msckf::ApplyUpdate(const Eigen::Ref<const Eigen::MatrixXd>& H_r,
                        std::span<const int> components, MeasurementShape shape,
                        bool product_known) {
  dx_.resize(state_.size());
  const auto& update = product_known ? KalmanUpdateOfKnownProduct : KalmanUpdate;
  if (!update(H_r, components, state_.P(), dx_, &kalman_workspace_, shape)) {
    Fail("the covariance is not positive definite");
    return;
  }
  state_.Correct(dx_, setup_.shared.time_bounds());
  if (options_.first_estimates && options_.rebase_first_estimates) state_.Rebase();
}

void Msckf::Prune() {
  const StageTimer::Scope scope(timer_, "prune");
  tracks_.RemoveEnded();
  const auto remove = [&](int clone) {
    tracks_.RemoveClone(state_.clones()[clone].id);
    state_.RemoveClone(clone);
  };
  const int count = static_cast<int>(state_.clones().size());
  if (output_.standstill) {
    // At rest the frame before the newest adds nothing; the older ones keep the parallax.
    remove(count - 2);
    output_.keyframe = false;
  } else if (count == options_.max_clones) {
    remove(0);
  }
  for (int i = static_cast<int>(state_.clones().size()) - 2; i >= 0; --i) {
    if (!tracks_.Sees(state_.clones()[i].id)) state_.RemoveClone(i);
  }
}

const EstimatorOutput& Msckf::Report() {
  CheckHealth();
  ForgetOldImu();
  if (output_.status == EstimatorStatus::kFailed) return output_;
  output_.state = state_.inertial();
  output_.rig = state_.rig();
  const int reported = FilterState::kNavSize + state_.layout().size();
  output_.covariance = state_.P().topLeftCorner(reported, reported);

  const bool updated = output_.features.used > 0 || output_.standstill;
  frames_without_update_ = updated ? 0 : frames_without_update_ + 1;
  const bool lost = frames_without_update_ >= options_.dead_reckoning_after_frames;
  output_.status = lost ? EstimatorStatus::kDeadReckoning : EstimatorStatus::kTracking;
  output_.reason =
      lost ? "no update for " + std::to_string(frames_without_update_) + " frames" : "";
  return output_;
}

void Msckf::CheckHealth() {
  const Eigen::Ref<const Eigen::MatrixXd> P = state_.P();
  std::string failure = FailureOf(state_.inertial(), setup_.shared.failure);
  if (failure.empty() && !P.diagonal().allFinite()) failure = "the covariance is not finite";
  if (failure.empty() && (P.diagonal().array() < 0.0).any()) {
    failure = "the covariance is not positive semidefinite";
  }
  if (!failure.empty()) Fail(failure);
}

void Msckf::Fail(const std::string& reason) {
  if (output_.status == EstimatorStatus::kFailed) return;
  output_.status = EstimatorStatus::kFailed;
  output_.reason = reason;
}

void Msckf::ForgetOldImu() {
  constexpr double kMarginSeconds = 0.1;
  const SharedOptions& shared = setup_.shared;
  // A t_d may move by twice its bound, a row lies half a readout from the middle.
  const double reach_s = 2.0 * shared.max_abs_t_d_s + shared.max_abs_t_r_s + kMarginSeconds;
  Timestamp keep = state_.inertial().instant - ToNanoseconds(shared.standstill.window_s);
  if (!state_.clones().empty()) keep = std::min(keep, state_.clones().front().instant);
  imu_.DropBefore(keep - ToNanoseconds(reach_s));
}

std::optional<NavState> Msckf::PredictAt(Timestamp t) const {
  if (!initialized_ || output_.status == EstimatorStatus::kFailed) return std::nullopt;
  const InertialState& inertial = state_.inertial();
  if (t < start_ || imu_.empty() || !imu_.Covers(inertial.instant, t)) return std::nullopt;
  if (t == inertial.instant) return inertial.nav;
  std::vector<ImuSample> readings;
  imu_.Extract(inertial.instant, t, &readings);
  const ImuDelta delta =
      IntegrateImu(readings, inertial.biases, state_.rig().imu, setup_.imu_noise,
                   {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false});
  return Predict(inertial.nav, delta, setup_.g_G);
}

}  // namespace duet
