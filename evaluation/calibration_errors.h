#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/measurement/calibration.h"
#include "evaluation/chi_squared.h"

namespace duet {

/// The estimated calibration at one instant of a run.
struct CalibrationSample {
  double t_s = 0.0;       ///< after the first sample
  Eigen::VectorXd error;  ///< true minus estimate, over CalibrationLayout's components
  Eigen::VectorXd sigma;  ///< as the estimator reports it
};

/// What a run's calibration estimates were against the truth.
class CalibrationErrors {
 public:
  CalibrationErrors() = default;
  /// `true_rig` in the estimator's gauge (common/measurement/gauge.h). A sample is kept every
  /// `interval_s`; the last one is always the newest.
  CalibrationErrors(CalibrationLayout layout, RigCalibration true_rig, double interval_s = 0.5);

  /// The estimate of an instant and its covariance over the layout's components.
  void Add(double t_s, const RigCalibration& estimate,
           const Eigen::Ref<const Eigen::MatrixXd>& covariance);

  [[nodiscard]] const CalibrationLayout& layout() const { return layout_; }
  [[nodiscard]] const std::vector<CalibrationSample>& samples() const { return samples_; }
  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] const Eigen::VectorXd& error() const { return samples_.back().error; }
  [[nodiscard]] const Eigen::VectorXd& sigma() const { return samples_.back().sigma; }
  /// error' covariance^-1 error at the end; nothing where it cannot be computed.
  [[nodiscard]] std::optional<double> Nees() const;
  [[nodiscard]] std::optional<double> BlockNees(const CalibrationLayout::Entry& entry) const;
  /// The time from which on the block's error stays within a fifth of its prior's standard
  /// deviations, or within three of the reported ones at the end where those are larger (root mean
  /// square over its components); nothing where it does not.
  [[nodiscard]] std::optional<double> ConvergenceTime(const CalibrationLayout::Entry& entry) const;
  /// Samples in which a component is further from the told value than so many of its prior's
  /// standard deviations, as a share of all components and samples.
  [[nodiscard]] double ShareOutsidePrior(const RigCalibration& told, double sigmas) const;
  /// Components of the last sample (not empty) that are that far off.
  [[nodiscard]] int CountOutsidePriorAtEnd(const RigCalibration& told, double sigmas) const;

 private:
  CalibrationLayout layout_;
  RigCalibration true_rig_;
  double interval_s_ = 0.0;
  bool last_is_extra_ = false;
  std::vector<CalibrationSample> samples_;
  std::vector<RigCalibration> estimates_;  // of the samples
  Eigen::MatrixXd covariance_;             // of the last one
};

/// A block over many runs with independent seeds, at their ends.
struct CalibrationBlockSummary {
  std::string name;
  int dof = 0;
  int runs = 0;  ///< whose covariance is positive definite; the others count nowhere below
  double rms_error = 0.0;  ///< over runs and components; in the block's unit
  double rms_sigma = 0.0;  ///< reported
  double prior_sigma = 0.0;
  /// Root mean square of error / reported sigma and, where a prediction is given, of error /
  /// predicted sigma, over runs and components.
  double error_over_sigma = 0.0;
  std::optional<double> error_over_predicted = {};
  double mean_nees = 0.0;
  Band band = {};  ///< of mean_nees, 99 %, for this block alone
  double p_value = 1.0;
  /// Outside its band after Holm's correction over all blocks and further from `dof` than a quarter
  /// of it.
  bool rejected = false;
  double convergence_s = 0.0;  ///< median over runs; infinite where half of them do not converge
};

/// By block, then "calibration": all of it. Runs without samples are left out; all must have the
/// same layout. `predicted_sigma`: over the components, or empty. `further_p_values`: of other
/// tests that Holm's correction covers (the pose's).
[[nodiscard]] std::vector<CalibrationBlockSummary> SummarizeCalibration(
    std::span<const CalibrationErrors* const> runs, const Eigen::VectorXd& predicted_sigma = {},
    const std::vector<double>& further_p_values = {});

/// The summary as a table for the terminal.
[[nodiscard]] std::string CalibrationText(const std::vector<CalibrationBlockSummary>& blocks);

}  // namespace duet
