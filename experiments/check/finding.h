#pragma once

#include <string>
#include <vector>

namespace duet {

enum class Severity {
  kInfo,     ///< how the recording is
  kWarning,  ///< estimators will run, but read this first
  kError,    ///< can't be right, or can't be used as it is
};
[[nodiscard]] const char* SeverityName(Severity severity);

/// A number that a check measured.
struct Measurement {
  std::string name;  ///< with its unit: "rate_hz"
  double value;
};

/// One thing that the doctor says of a recording.
struct Finding {
  Severity severity = Severity::kInfo;
  std::string code;    ///< stable, for programs: "imu.gap"
  std::string text;    ///< what was found, with numbers
  std::string advice;  ///< what to do; empty where there is nothing
  std::vector<Measurement> measured = {};
};
using Findings = std::vector<Finding>;

}  // namespace duet
