// The part of WindowEstimator that turns what leaves the window into the prior.

#include <algorithm>
#include <numeric>
#include <vector>

#include "backends/window/window_estimator.h"
#include "common/support/logging.h"

namespace duet {

void WindowEstimator::Marginalize() {
  const StageTimer::Scope scope(timer_, "marginalize");
  dropped_frame_ = -1;
  if (output_.status == EstimatorStatus::kFailed) return;
  if (keyframe_) {
    if (newest() + 1 >= options_.max_frames) MarginalizeOldest();
  } else {
    MarginalizeSecondNewest();
  }
}

void WindowEstimator::MarginalizeOldest() {
  dropped_frame_ = 0;
  NormalEquations equations(newest() + 1, layout_);
  linearizer_.AddLink(1, &equations);
  AddLandmarksOfOldest(&equations);
  InformationForm form = equations.Take();
  linearizer_.ShiftToOrigin(prior_.rig_origin, &form);
  AddPrior(prior_, newest() + 1, layout_, &form);
  TakePrior(form, 0);
  // It is in the prior now.
  frames_[1].link.reset();
  frames_[1].at_rest_since_before = false;
}

// Landmarks that the oldest frame saw end here, with all their pixels in the prior. One that is
// still tracked leaves its newest pixels out: with these its track goes on as a new landmark, whose
// first value is a guess and carries no information.
void WindowEstimator::AddLandmarksOfOldest(NormalEquations* equations) {
  const int last_of_live = newest() - options_.frames_kept_from_prior;
  for (Landmark& landmark : table_.landmarks()) {
    if (landmark.anchor() != 0) continue;
    const auto pixels_until = [&](int last) {
      return std::count_if(landmark.observations.begin(), landmark.observations.end(),
                           [&](const LandmarkObservation& o) { return o.frame <= last; });
    };
    const bool ended = !landmark.seen_newest;
    const bool split = options_.live_landmarks == WindowOptions::LiveLandmarks::kSplit;
    const int last = ended ? newest() : last_of_live;
    const bool usable =
        landmark.in_problem && landmark.depth_known && (ended || split) && pixels_until(last) >= 2;
    if (usable) {
      linearizer_.AddLandmark(landmark, last, equations);
      LandmarkTable::KeepFrom(last + 1, linearizer_.now(), &landmark);
    } else if (ended) {
      output_.features.too_short += 1;
      landmark.observations.clear();
    }
  }
  table_.RemoveEmpty();
}

void WindowEstimator::MarginalizeSecondNewest() {
  const int second = newest() - 1;
  dropped_frame_ = second;
  const bool compose = frames_[second].link && frames_[second + 1].link &&
                       !frames_[second].at_rest_since_before &&
                       !frames_[second + 1].at_rest_since_before;
  InformationForm form;
  if (compose) {
    ComposeOverSecondNewest();
    const WindowFrame& frame = frames_[second];
    if (!frame.pose_in_prior && !frame.velocity_in_prior && !frame.biases_in_prior) return;
    // What the prior says of the frame goes on in what it says of the others.
    form = NormalEquations(newest() + 1, layout_).Take();
  } else {
    // Velocities of zero on the way can't be composed: they become part of the prior.
    NormalEquations equations(newest() + 1, layout_);
    linearizer_.AddLink(second, &equations);
    linearizer_.AddLink(second + 1, &equations);
    form = equations.Take();
    linearizer_.ShiftToOrigin(prior_.rig_origin, &form);
    frames_[second + 1].link.reset();
    frames_[second + 1].at_rest_since_before = false;
  }
  AddPrior(prior_, newest() + 1, layout_, &form);
  TakePrior(form, second);
}

void WindowEstimator::ComposeOverSecondNewest() {
  const int second = newest() - 1;
  const ImuLink& first = *frames_[second].link;
  ImuLink& next = *frames_[second + 1].link;
  // Both halves must stand at the same biases and calibration; the newer one is short.
  const ImuDelta& delta = next.delta;
  if (delta.biases.b_g != first.delta.biases.b_g || delta.biases.b_a != first.delta.biases.b_a ||
      ToVector(delta.calibration) != ToVector(first.delta.calibration)) {
    next = Integrate(delta.start, delta.end, first.delta.biases, first.delta.calibration);
  }
  next.delta = Compose(first.delta, next.delta);
  next.sqrt_information = SquareRootInformation(next.delta.covariance);
}

// Takes `dropped_frame` out of the quadratic and makes what is left the prior of the window without
// it; parts of frames that it speaks of for the first time get their first estimates.
void WindowEstimator::TakePrior(const InformationForm& form, int dropped_frame) {
  std::vector<int> keep;
  std::vector<int> drop(kFrameSize);
  std::iota(drop.begin(), drop.end(), kFrameSize * dropped_frame);
  for (int c = 0; c < static_cast<int>(form.b.size()); ++c) {
    if (c < drop.front() || c > drop.back()) keep.push_back(c);
  }
  prior_ =
      PriorFromInformation(SchurComplement(form, keep, drop), newest(), prior_.rig_origin, layout_);
  for (const PriorBlock& block : prior_.blocks) {
    if (block.kind == PriorBlock::Kind::kCalibration) continue;
    WindowFrame& frame = frames_[block.index < dropped_frame ? block.index : block.index + 1];
    InertialState& origin = frame.origin;
    origin.instant = frame.state.instant;
    switch (block.kind) {
      case PriorBlock::Kind::kPose:
        if (!frame.pose_in_prior) {
          origin.nav.R_GB = frame.state.nav.R_GB;
          origin.nav.p_GB = frame.state.nav.p_GB;
        }
        frame.pose_in_prior = true;
        break;
      case PriorBlock::Kind::kVelocity:
        if (!frame.velocity_in_prior) origin.nav.v_GB = frame.state.nav.v_GB;
        frame.velocity_in_prior = true;
        break;
      case PriorBlock::Kind::kBiases:
        if (!frame.biases_in_prior) origin.biases = frame.state.biases;
        frame.biases_in_prior = true;
        break;
      case PriorBlock::Kind::kCalibration:
        break;
    }
  }
}

}  // namespace duet
