#pragma once

#include <string>
#include <vector>

#include "common/support/timestamp.h"
#include "experiments/check/finding.h"

namespace duet {

/// How evenly something was sampled.
struct StampStatistics {
  int count = 0;
  double span_s = 0.0;
  double rate_hz = 0.0;      ///< of the median step
  double jitter_s = 0.0;     ///< 95th percentile of |step - median|, gaps left out
  double longest_s = 0.0;    ///< longest step
  Timestamp longest_at = 0;  ///< its start
  int gaps = 0;              ///< steps longer than 1.5 medians
  int missing = 0;           ///< samples that the gaps swallow
};
[[nodiscard]] StampStatistics MeasureStamps(const std::vector<Timestamp>& stamps);

/// Rate, jitter and gaps of `what` ("imu", "cam0", "truth"); `told_rate_hz` 0: not told.
/// `usable_gap_s`: a longer gap is an error, shorter ones warnings.
[[nodiscard]] Findings CheckStamps(const std::string& what, const std::vector<Timestamp>& stamps,
                                   double told_rate_hz, double usable_gap_s, Timestamp origin);

/// The stamps of two cameras against one another: pairs, constant and varying offset, spans.
[[nodiscard]] Findings CheckSynchrony(const std::vector<Timestamp>& first,
                                      const std::vector<Timestamp>& second);

/// Seconds after `origin`, for sentences: "12.345 s".
[[nodiscard]] std::string SinceOrigin(Timestamp t, Timestamp origin);

/// printf into a string.
[[nodiscard]] std::string Sentence(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace duet
