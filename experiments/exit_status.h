#pragma once

namespace duet {

/// What the program returns (DESIGN.md section 6).
enum ExitStatus : int {
  kDone = 0,             ///< also a comparison in which one estimator failed
  kBoundNotMet = 1,      ///< of --require; or duet verify has found something wrong
  kBadInput = 2,         ///< usage, a file, a key
  kEstimatorFailed = 3,  ///< a single run's estimator failed
  kWritingFailed = 4,
  kInternalError = 70,  ///< a bug of ours (EX_SOFTWARE)
  kInterrupted = 130,
};

}  // namespace duet
