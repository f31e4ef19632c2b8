#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "backends/estimator.h"
#include "backends/window/keyframe.h"
#include "backends/window/landmark_table.h"
#include "backends/window/prior.h"
#include "backends/window/window_linearizer.h"
#include "backends/window/window_options.h"
#include "backends/window/window_problem.h"
#include "common/imu/imu_buffer.h"
#include "common/measurement/triangulation.h"

namespace duet {

/// VINS-Fusion's estimator in our own code: nonlinear least squares over a window of keyframes and
/// the newest frame, with everything older summed up in a square-root prior.
///
///   [ prior ]-- x_0 --IMU-- x_1 --IMU-- ... --IMU-- x_k --IMU-- x_n      x = (theta p v b_g b_a)
///                 \         / \                     /          /
///                  landmark (alpha beta rho): pixels         calibration in every pixel (and IMU)
///
/// What differs from VINS-Fusion, and why: all three numbers of a landmark are free and the
/// anchor's pixel is a measurement (theirs exists as landmark_parameters: inverse_depth_only);
/// no pixel counts twice (a landmark that went into the prior ends; its track goes on as a new
/// one); the prior is linearized at first estimates; the error is global and full-angle; bounds are
/// iterations, not the clock.
class WindowEstimator final : public Estimator {
 public:
  WindowEstimator(const EstimatorSetup& setup, const WindowOptions& options);

  void Initialize(const InitialCondition& initial) override;
  void AddImu(const ImuSample& sample) override;
  const EstimatorOutput& ProcessFrame(const TrackFrameSet& frames) override;
  [[nodiscard]] std::optional<NavState> PredictAt(Timestamp t) const override;
  [[nodiscard]] const CalibrationLayout& layout() const override { return layout_; }

  /// For tests and tools: the window as it stands after a frame.
  [[nodiscard]] const std::vector<WindowFrame>& frames() const { return frames_; }
  [[nodiscard]] const std::vector<Landmark>& landmarks() const { return table_.landmarks(); }
  [[nodiscard]] const WindowPrior& prior() const { return prior_; }
  [[nodiscard]] int skipped_frames() const { return skipped_frames_; }

 private:
  // ProcessFrame's column.
  bool Accept(const TrackFrameSet& frames);
  void Preintegrate();
  void AppendFrame(const TrackFrameSet& frames);
  void TriangulateNew();
  void BuildProblem();
  void Solve();
  void RejectOutliers();
  void Report();
  void DecideKeyframe();
  void Marginalize();
  void Slide();

  ImuLink Integrate(Timestamp from, Timestamp to, const ImuBiases& biases,
                    const ImuCalibration& calibration);
  void Reintegrate();
  void SelectLandmarks();
  [[nodiscard]] double RateReach(const WindowFrame& frame) const;
  void MarginalizeOldest();
  void MarginalizeSecondNewest();
  void ComposeOverSecondNewest();
  void AddLandmarksOfOldest(NormalEquations* equations);
  void TakePrior(const InformationForm& form, int dropped_frame);
  void JudgeDepths(const Eigen::MatrixXd& H);
  void CheckHealth();
  void Fail(const std::string& reason);
  void Skip(const std::string& reason);
  [[nodiscard]] int newest() const { return static_cast<int>(frames_.size()) - 1; }

  EstimatorSetup setup_;
  WindowOptions options_;
  CalibrationLayout layout_;
  ReprojectionSetup reprojection_;
  RigCalibration rig_;  // the current estimate
  double longest_rate_reach_s_;

  std::optional<InitialCondition> initial_;
  ImuBuffer imu_;
  StandstillDetector standstill_;
  std::vector<WindowFrame> frames_;
  LandmarkTable table_;
  WindowPrior prior_;
  WindowLinearizer linearizer_;
  WindowProblem problem_;

  // Of the frame at hand.
  Timestamp instant_ = 0;
  Timestamp last_aided_ = 0;  // by landmarks or by the standstill measurement
  std::optional<ImuLink> new_link_;
  bool keyframe_ = true;    // the second newest frame stays
  int dropped_frame_ = -1;  // leaves the window in Slide
  SolveSummary summary_;
  EstimatorOutput output_;
  int skipped_frames_ = 0;

  std::vector<ImuSample> readings_;                     // scratch
  std::vector<TrackObservationInState> triangulation_;  // scratch
  std::vector<int> selection_;                          // scratch
  DepthRow depth_;                                      // scratch
};

}  // namespace duet
