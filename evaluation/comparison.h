#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/consistency.h"
#include "evaluation/evaluate.h"
#include "evaluation/statistics.h"

namespace duet {

/// What a run tells of itself beside its trajectory.
struct EstimatorRun {
  std::string status;  ///< "tracking", "failed", ...: of its last frame
  std::string reason;  ///< of a failure
  /// Seconds from the start of the span to the failure; NaN where there is none.
  double failed_at_s = std::numeric_limits<double>::quiet_NaN();
  int frames = 0;                ///< processed
  int waiting_frames = 0;        ///< before the start: without an estimate
  double waited_s = 0.0;         ///< for the start
  std::string waited_for;        ///< what was missing until then
  int skipped_frames = 0;        ///< not covered by the IMU
  int dead_reckoned_frames = 0;  ///< without a usable observation
  int restarts = 0;
  ErrorSummary estimator_ms;  ///< thread CPU time a frame, covariance in it
  /// Median of each stage [ms], in the order of the stages.
  std::vector<std::pair<std::string, double>> stage_median_ms;
  double peak_memory_mb = std::numeric_limits<double>::quiet_NaN();
  std::vector<NeesOfRun> nees;  ///< empty where the truth does not allow it
  /// Everything that was switched on (DESIGN.md section 5.5), name and value as text: the foot.
  std::vector<std::pair<std::string, std::string>> settings;
};

struct FrontendRun {
  bool replayed = false;  ///< the tracks came from a file: no times
  int frames = 0;
  ErrorSummary tracking_ms = {};  ///< thread CPU time a frame, image decoding apart
  ErrorSummary decoding_ms = {};
  double mean_tracks = std::numeric_limits<double>::quiet_NaN();  ///< a frame of one camera
};

/// Estimators on one track stream. `evaluation.estimates` and `runs` are in the same order.
struct Comparison {
  std::string dataset;
  std::string cameras;  ///< "0", "0,1"
  std::string start;    ///< how the estimators were started
  std::string tracks_sha256;
  std::optional<FrontendRun> frontend;
  Evaluation evaluation;
  std::vector<EstimatorRun> runs;
  std::vector<std::string> warnings;
};

/// The table for the terminal with its foot and how to read it.
[[nodiscard]] std::string ComparisonText(const Comparison& comparison);

/// comparison.json (docs/formats.md): `format`, `dataset`, `cameras`, `start`, `tracks_sha256`,
/// `frontend`, `evaluation`, one object an estimator under its name, `warnings`.
[[nodiscard]] nlohmann::ordered_json ComparisonJson(const Comparison& comparison);

/// ComparisonJson of estimators with these names before any has run, every number null: its paths
/// are those that a requirement may name.
[[nodiscard]] nlohmann::ordered_json ComparisonTemplate(const std::vector<std::string>& names);

}  // namespace duet
