#pragma once

#include <string>
#include <utility>
#include <vector>

namespace duet {

/// One run of a study, as its record tells: where it stands in the study's grid, and what came of
/// it.
struct StudyRun {
  std::string id;  ///< of the record: runs/<id>
  /// The grid's coordinates, by the names that the study's file gives them.
  std::string stream;
  std::string estimator;
  std::string setting;
  std::string perturbation;
  int seed = 0;
  std::string stream_id;  ///< of what it ran on: streams/<id>; equal where the input was identical
  std::string tracks_sha256;
  bool failed = false;
  std::string reason;  ///< of a failure
  /// By the keys of evaluation/metrics.h, in their order; what does not exist is left out. A failed
  /// run has the metrics of what it did before it failed.
  std::vector<std::pair<std::string, double>> metrics;
};

/// What a study's tables, figures and report are made of.
struct StudyResult {
  std::string name;
  std::string question;
  std::vector<StudyRun> runs;  ///< in the order of the grid
  /// What was switched on, one line each: the foot of every table (DESIGN.md section 5.5).
  std::vector<std::string> foot;
};

}  // namespace duet
