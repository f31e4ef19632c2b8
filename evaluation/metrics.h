#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace duet {

/// Which values of a metric are the better ones.
enum class Better {
  kLower,
  kHigher,
  kNearZero,      ///< a signed error: its magnitude counts
  kNearExpected,  ///< NEES: as far below its expectation is as wrong as above
  kNeither        ///< tells something, but not who is better
};

/// A number that is reported of a run: what it is called in a record, and how a person reads it.
struct Metric {
  std::string key;    ///< in evaluation.json, runs.csv and StudyRun::metrics: "ate.position_m"
  std::string words;  ///< "position error (ATE)"
  std::string unit;   ///< "m"; empty for a pure number
  int decimals = 3;   ///< that a table shows
  Better better = Better::kLower;
  /// Of a NEES: its degrees of freedom; 0 where they depend on what was estimated (then they stand
  /// beside it under KEY + ".dof").
  double expected = 0.0;
  /// The same bytes on every run of the same input; times and memory are not.
  bool canonical = true;

  /// Smaller is better, for every `better` but kNeither (there it is the value).
  [[nodiscard]] double Score(double value) const;
  [[nodiscard]] bool is_nees() const { return better == Better::kNearExpected; }
  /// "position error (ATE) [m]"
  [[nodiscard]] std::string Title() const;
};

/// The metric of that key; nothing where there is none. Keys with a parameter:
///   ate.position_m.A, ate.orientation_deg.A   A: posyaw, se3, sim3, first, none; an alignment
///   other
///                                             than the configured one
///   relative.position_m.L, relative.orientation_deg.L   L: length in metres, "5", "0.5"
///   calibration.NAME.error, calibration.NAME.sigma      NAME: of the calibration's components,
///                                                       "t_d", "T_g.xy", "cam0.p_CB.x"
[[nodiscard]] std::optional<Metric> FindMetric(std::string_view key);

/// FindMetric, or an InputError that names the nearest key.
[[nodiscard]] Metric MetricOf(std::string_view key);

/// Keys without parameters, in the order in which a record lists them.
[[nodiscard]] std::vector<std::string> MetricKeys();

}  // namespace duet
