#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "backends/estimator.h"

namespace duet {

/// What one run says of each number of the estimated calibration, in plain words: what it was told,
/// what it found, how well, and whether the recording said anything about it at all.
class CalibrationWatch {
 public:
  /// An estimate further from its told value than this many of its prior's standard deviations has
  /// left it: the prior, the model or the recording is wrong.
  static constexpr double kPriorSigmas = 5.0;
  /// One that was not observed, and lies so far from its told value all the same, was pushed there.
  static constexpr double kOddSigmas = 3.0;

  struct Number {
    std::string name;  ///< "cam0.p_CB.x"
    double told = 0.0;
    double value = 0.0;
    double prior_sigma = 0.0;
    double sigma = 0.0;
    bool observed = false;
    double left_prior_after_s = -1.0;  ///< first time beyond kPriorSigmas; negative: never
    double largest_sigmas = 0.0;       ///< largest distance from the told value, in prior sigmas
    double at_bound_after_s = -1.0;  ///< first time that it was held at its bound; negative: never
  };

  /// `told`: the rig that the estimator was told.
  CalibrationWatch(CalibrationLayout layout, RigCalibration told, const TimeBounds& bounds = {});

  /// An output with a state and a covariance.
  void Add(const EstimatorOutput& output);

  /// Empty where nothing is estimated, or before the first output.
  [[nodiscard]] std::vector<Number> Numbers() const;

 private:
  CalibrationLayout layout_;
  RigCalibration told_;
  Eigen::VectorXd prior_sigma_;
  Eigen::VectorXd value_;
  Eigen::VectorXd sigma_;
  Eigen::VectorXd largest_sigmas_;
  Eigen::VectorXd left_after_s_;
  Eigen::VectorXd bound_;  // infinite where there is none
  Eigen::VectorXd at_bound_after_s_;
  Timestamp first_ = 0;
};

/// The numbers as a table for the terminal.
[[nodiscard]] std::string CalibrationWatchText(
    const std::vector<CalibrationWatch::Number>& numbers);

/// The numbers as calibration.csv of a run record (docs/formats.md), and back. Throws InputError.
[[nodiscard]] std::string CalibrationCsv(const std::vector<CalibrationWatch::Number>& numbers);
[[nodiscard]] std::vector<CalibrationWatch::Number> ReadCalibrationCsv(std::string_view csv,
                                                                       const std::string& file);

/// A sentence for each number that left its prior or was held at its bound.
[[nodiscard]] std::vector<std::string> CalibrationWarnings(
    const std::vector<CalibrationWatch::Number>& numbers);

}  // namespace duet
