#pragma once

#include <string>
#include <vector>

#include "experiments/calibration_watch.h"
#include "experiments/estimation_loop.h"
#include "experiments/record_folder.h"
#include "experiments/run_record.h"
#include "experiments/session.h"

namespace duet {

/// What is run over a session's recording.
struct EstimatorRunChoices {
  std::string backend;
  bool covariance = false;  ///< write covariance.csv too
  bool quiet = false;       ///< no progress
};

struct EstimatorRunResult {
  LoopOutcome outcome = LoopOutcome::kDone;
  std::string reason;  ///< of a failure
  RunSummary summary;
  std::vector<CalibrationWatch::Number> calibration;
};

/// "done", "failed", "interrupted".
[[nodiscard]] const char* OutcomeName(LoopOutcome outcome);

/// Runs one estimator over the session's images or tracks (which it takes out of the session) and
/// writes what `duet run` leaves in a record: its tables, and what the manifest says of the run.
/// The record is left for its owner to commit. Throws InputError and OutputError.
[[nodiscard]] EstimatorRunResult RunEstimator(const EstimatorRunChoices& choices, Session* session,
                                              RecordFolder* record);

}  // namespace duet
