#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/metrics.h"
#include "evaluation/study_result.h"

namespace duet {

/// What is run on every stream: a point of the grid without its stream and seed.
struct StudyArm {
  std::string estimator;
  std::string setting;
  std::string perturbation;
  /// What of the three differs in the study: "window", "window (short)", "short; t_d off".
  std::string name;
};

/// The runs of one arm on one stream, in the order of the study.
struct StudyCell {
  std::vector<const StudyRun*> runs;

  [[nodiscard]] int failed() const;
  /// "1/20"
  [[nodiscard]] std::string FailedText() const;
  /// Of the runs that did not fail and have the metric.
  [[nodiscard]] std::vector<double> Values(std::string_view metric) const;
  /// Of an error with a sign its magnitudes: errors that cancel are not small. Else Values.
  [[nodiscard]] std::vector<double> Magnitudes(const Metric& metric) const;
  /// Values with one value an input (StudyRun::stream_id): the mean of its runs. Runs on one
  /// recording share its noise and are no independent draws of it.
  [[nodiscard]] std::vector<double> MeansByInput(std::string_view metric) const;
};

/// A study's runs by stream and arm, both in the order in which the study has them first. A record
/// that stands in a cell more than once (the same input gives the same record) counts once: a run
/// that is repeated is no second observation. `study` must outlive the grid.
class StudyGrid {
 public:
  explicit StudyGrid(const StudyResult& study);

  [[nodiscard]] const StudyResult& study() const { return study_; }
  [[nodiscard]] const std::vector<std::string>& streams() const { return streams_; }
  [[nodiscard]] const std::vector<StudyArm>& arms() const { return arms_; }
  [[nodiscard]] const StudyCell& cell(std::size_t stream, std::size_t arm) const {
    return cells_[stream * arms_.size() + arm];
  }

 private:
  const StudyResult& study_;
  std::vector<std::string> streams_;
  std::vector<StudyArm> arms_;
  std::vector<StudyCell> cells_;
};

/// What a run ran on: equal for runs on identical input, whose noise is the same draw. Where that
/// is not known each stream and seed is its own.
[[nodiscard]] std::string InputOf(const StudyRun& run);

/// NaN where the run has none.
[[nodiscard]] double MetricValue(const StudyRun& run, std::string_view metric);

}  // namespace duet
