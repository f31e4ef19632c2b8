#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "experiments/check/finding.h"

namespace duet {

/// What the doctor says of a recording.
struct Diagnosis {
  std::string dataset;
  Findings findings;

  [[nodiscard]] Severity Worst() const;
};

/// Reads the recording in `folder` (ASL form; any of cam0, cam1, tracks0, tracks1, none) and checks
/// it: rates, gaps, order, synchrony, saturation, rest, calibration, tracks, the truth and the IMU
/// against it. What the readers refuse (stamps out of order, a rotation that is none, ...) becomes
/// a finding that names file and line. Throws InputError where there is no recording at all.
[[nodiscard]] Diagnosis Diagnose(const std::filesystem::path& folder);

[[nodiscard]] std::string DiagnosisText(const Diagnosis& diagnosis);
/// {"dataset", "worst", "findings": [{"severity", "code", "text", "advice", "measured": {...}}]}
[[nodiscard]] nlohmann::ordered_json DiagnosisJson(const Diagnosis& diagnosis);

}  // namespace duet
