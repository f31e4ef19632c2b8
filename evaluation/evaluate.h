#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.h"
#include "common/support/timestamp.h"
#include "evaluation/alignment.h"
#include "evaluation/association.h"
#include "evaluation/errors.h"
#include "evaluation/relative_errors.h"
#include "evaluation/text_table.h"

namespace duet {

struct NamedTrajectory {
  std::string name;
  std::vector<StampedPose> poses;
};

struct EvaluationOptions {
  AlignmentMode alignment = AlignmentMode::kPositionYaw;
  AlignmentOptions alignment_options;
  AssociationOptions association;
  RelativeErrorOptions relative;
  /// Where association.truth_jumps is empty: look for jumps in the truth alone (FindPoseJumps). Who
  /// has the IMU looks with it and gives them.
  bool find_truth_jumps = true;
  /// The span that is to be covered; poses outside are left out. Where not given, the truth's.
  std::optional<Timestamp> start, end;
};

/// What is said of one estimated trajectory.
struct TrajectoryEvaluation {
  std::string name;
  Association association;
  double coverage_share = 0.0;  ///< of the span
  AbsoluteErrors absolute;
  std::vector<RelativeErrors> relative;  ///< one a length
  std::optional<Drift> drift;            ///< of the estimate's poses; nothing where it has none
  std::optional<Drift> drift_true;       ///< of the truth at the pairs
};

struct Evaluation {
  EvaluationOptions options;  ///< with the jumps that were found
  std::string truth_name;
  Timestamp start = 0;  ///< the span
  Timestamp end = 0;
  double truth_way_m = 0.0;  ///< travelled in the span
  int truth_jumps = 0;       ///< of options.association.truth_jumps, those in the span
  /// Spans' intersection and segments left out; `of_estimator` has moved to the estimates.
  RelativeErrorReport relative;
  std::vector<TrajectoryEvaluation> estimates;

  [[nodiscard]] double span_s() const { return SecondsBetween(start, end); }
};

/// Evaluates any trajectories against one truth; pure. Throws InputError where a trajectory is
/// none (CheckTrajectory), names repeat or `options` make no sense; an estimate without poses or
/// without a truth is a result that says so.
[[nodiscard]] Evaluation Evaluate(const NamedTrajectory& truth,
                                  const std::vector<NamedTrajectory>& estimates,
                                  const EvaluationOptions& options);

/// Throws InputError where an estimate has no pose with a truth (other clock, other recording).
void RequireOverlap(const Evaluation& evaluation);

/// The rows of the evaluation, one column an estimate, into `table` (whose header has the names).
void AddAccuracyRows(const Evaluation& evaluation, TextTable* table);
void AddCoverageRows(const Evaluation& evaluation, TextTable* table);
/// What was refused, which gaps there are, and how to read the numbers.
[[nodiscard]] std::string EvaluationNotes(const Evaluation& evaluation);

/// The whole answer of `duet evaluate` on the terminal.
[[nodiscard]] std::string EvaluationText(const Evaluation& evaluation);

/// One estimate: `ate`, `relative`, `coverage_s`, ... Numbers that do not exist are null.
[[nodiscard]] nlohmann::ordered_json TrajectoryJson(const Evaluation& evaluation,
                                                    const TrajectoryEvaluation& estimate);
/// What holds for all: span, alignment, association.
[[nodiscard]] nlohmann::ordered_json SettingsJson(const Evaluation& evaluation);
/// `evaluation` (settings) and one object an estimate, under its name.
[[nodiscard]] nlohmann::ordered_json EvaluationJson(const Evaluation& evaluation);

/// null where `value` is not finite, so that the text is JSON and a requirement on it fails.
[[nodiscard]] nlohmann::ordered_json NumberJson(double value);
/// All of a summary: count, rmse, mean, ...
[[nodiscard]] nlohmann::ordered_json SummaryJson(const ErrorSummary& summary);

}  // namespace duet
