#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/estimator.h"
#include "backends/msckf/feature_tracks.h"
#include "backends/msckf/feature_update.h"
#include "backends/msckf/filter_state.h"
#include "backends/msckf/kalman_update.h"
#include "backends/msckf/msckf_options.h"
#include "backends/msckf/propagation.h"
#include "common/imu/imu_buffer.h"

namespace duet {

/// The multi-state constraint Kalman filter of thesis chapter 6 (after Mourikis and Roumeliotis
/// 2007, Li and Mourikis 2013): an extended Kalman filter over the newest state, the calibration
/// and a window of past poses (FilterState), into which landmarks enter only as constraints between
/// the poses that saw them: they are triangulated, linearized and projected out (FeatureUpdate).
///
/// One frame is ProcessFrame, a column of the thesis's steps. Physics (IMU delta, measurement
/// model, triangulation, standstill) is shared with the window estimator.
class Msckf final : public Estimator {
 public:
  Msckf(const EstimatorSetup& setup, const MsckfOptions& options);

  void Initialize(const InitialCondition& initial) override;
  void AddImu(const ImuSample& sample) override { imu_.Add(sample); }
  const EstimatorOutput& ProcessFrame(const TrackFrameSet& frames) override;
  [[nodiscard]] std::optional<NavState> PredictAt(Timestamp t) const override;
  [[nodiscard]] const CalibrationLayout& layout() const override { return state_.layout(); }

  /// State and covariance, for tests and diagnosis.
  [[nodiscard]] const FilterState& state() const { return state_; }
  /// Frames that were left out because the IMU did not cover their interval.
  [[nodiscard]] int skipped_frames() const { return skipped_frames_; }

 private:
  /// Where the frame's instant is processed: fills the output's head; false where the frame is left
  /// out (before the start, not covered by the IMU, after a failure).
  bool BeginFrame(const TrackFrameSet& frames, Timestamp instant);
  void Skip(const std::string& reason);
  void Propagate(Timestamp instant);
  void Augment(const TrackFrameSet& frames);
  void UpdateStandstill(const TrackFrameSet& frames);
  void SelectFinishedTracks();
  void Triangulate();
  void Linearize();
  void ProjectNullspace();
  void Gate();
  void Compress();
  void Update();
  void Prune();
  const EstimatorOutput& Report();

  /// The Kalman update and the correction of the state; fails the filter where it can't.
  /// `product_known`: P H' is in the workspace.
  void ApplyUpdate(const Eigen::Ref<const Eigen::MatrixXd>& H_r, std::span<const int> components,
                   MeasurementShape shape, bool product_known);
  void RefreshRates();
  void CheckHealth();
  void Fail(const std::string& reason);
  void ForgetOldImu();

  EstimatorSetup setup_;
  MsckfOptions options_;
  FilterState state_;
  ImuBuffer imu_;
  FeatureTracks tracks_;
  FeatureUpdate feature_update_;
  StandstillDetector standstill_detector_;
  ChiSquaredGate standstill_gate_;

  bool initialized_ = false;
  Timestamp start_ = 0;
  int skipped_frames_ = 0;
  int frames_without_update_ = 0;
  EstimatorOutput output_;

  // Memory that is kept from frame to frame.
  std::vector<ImuSample> readings_;
  PropagationWorkspace propagation_workspace_;
  KalmanWorkspace kalman_workspace_;
  Eigen::VectorXd dx_;
  std::optional<Eigen::Ref<const Eigen::MatrixXd>> stack_;
};

}  // namespace duet
