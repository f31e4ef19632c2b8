#include "evaluation/metrics.h"

#include <array>
#include <cctype>
#include <cmath>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"
#include "evaluation/alignment.h"

namespace duet {
namespace {

struct MetricEntry {
  const char* key;
  const char* words;
  const char* unit;
  int decimals;
  Better better;
  double expected;
  bool canonical;
};

constexpr std::array kMetrics = {
    MetricEntry{"ate.position_m", "position error (ATE)", "m", 4, Better::kLower, 0, true},
    MetricEntry{"ate.orientation_deg", "orientation error (ATE)", "deg", 3, Better::kLower, 0,
                true},
    MetricEntry{"ate.tilt_deg", "tilt error (ATE)", "deg", 3, Better::kLower, 0, true},
    MetricEntry{"rms.position_m", "position error without alignment", "m", 4, Better::kLower, 0,
                true},
    MetricEntry{"rms.orientation_deg", "orientation error without alignment", "deg", 3,
                Better::kLower, 0, true},
    MetricEntry{"coverage_share", "share of the span covered", "", 3, Better::kHigher, 0, true},
    MetricEntry{"drift_m", "largest drift from the first pose", "m", 4, Better::kLower, 0, true},
    MetricEntry{"nees.pose", "NEES of the pose", "", 2, Better::kNearExpected, 6, true},
    MetricEntry{"nees.position", "NEES of the position", "", 2, Better::kNearExpected, 3, true},
    MetricEntry{"nees.orientation", "NEES of the orientation", "", 2, Better::kNearExpected, 3,
                true},
    MetricEntry{"nees.velocity", "NEES of the velocity", "", 2, Better::kNearExpected, 3, true},
    MetricEntry{"nees.b_g", "NEES of the gyro bias", "", 2, Better::kNearExpected, 3, true},
    MetricEntry{"nees.b_a", "NEES of the accelerometer bias", "", 2, Better::kNearExpected, 3,
                true},
    MetricEntry{"nees.calibration", "NEES of the calibration at the end", "", 2,
                Better::kNearExpected, 0, true},
    MetricEntry{"nees.calibration.dof", "numbers of the calibration that are estimated", "", 0,
                Better::kNeither, 0, true},
    MetricEntry{"truth.way_m", "way of the truth", "m", 1, Better::kNeither, 0, true},
    MetricEntry{"truth.duration_s", "duration of the truth", "s", 1, Better::kNeither, 0, true},
    MetricEntry{"truth.speed_m_per_s", "mean speed of the truth", "m/s", 2, Better::kNeither, 0,
                true},
    MetricEntry{"truth.rate_rad_per_s", "mean rate of the truth", "rad/s", 2, Better::kNeither, 0,
                true},
    MetricEntry{"frame_ms.median", "time a frame, median", "ms", 2, Better::kLower, 0, false},
    MetricEntry{"frame_ms.p99", "time a frame, p99", "ms", 2, Better::kLower, 0, false},
    MetricEntry{"peak_memory_mb", "peak memory", "MB", 1, Better::kLower, 0, false},
};

Metric MetricOfEntry(const MetricEntry& entry) {
  return {entry.key,    entry.words,    entry.unit,     entry.decimals,
          entry.better, entry.expected, entry.canonical};
}

/// What follows `prefix` in `key`; nothing where it does not begin so.
std::optional<std::string_view> After(std::string_view key, std::string_view prefix) {
  if (!key.starts_with(prefix) || key.size() == prefix.size()) return std::nullopt;
  return key.substr(prefix.size());
}

bool IsAlignmentName(std::string_view name) {
  for (const AlignmentMode mode :
       {AlignmentMode::kNone, AlignmentMode::kFirstPose, AlignmentMode::kPositionYaw,
        AlignmentMode::kSe3, AlignmentMode::kSim3}) {
    if (name == AlignmentModeName(mode)) return true;
  }
  return false;
}

std::optional<Metric> AlignedMetric(std::string_view key) {
  for (const char* base : {"ate.position_m", "ate.orientation_deg"}) {
    const auto alignment = After(key, std::string(base) + ".");
    if (!alignment || !IsAlignmentName(*alignment)) continue;
    Metric metric = *FindMetric(base);
    metric.key = key;
    metric.words += ", alignment " + std::string(*alignment);
    return metric;
  }
  return std::nullopt;
}

std::optional<Metric> RelativeMetric(std::string_view key) {
  const auto position = After(key, "relative.position_m.");
  const auto orientation = After(key, "relative.orientation_deg.");
  if (!position && !orientation) return std::nullopt;
  const std::string_view length = position ? *position : *orientation;
  const std::optional<double> metres = ParseDouble(length);
  if (!metres || !std::isfinite(*metres) || !(*metres > 0.0)) return std::nullopt;
  const std::string over = " error over " + std::string(length) + " m, median";
  return position
             ? Metric{std::string(key), "position" + over, "m", 4, Better::kLower, 0, true}
             : Metric{std::string(key), "orientation" + over, "deg", 3, Better::kLower, 0, true};
}

struct CalibrationUnit {
  const char* name;
  const char* unit;
  int decimals;
};
/// By the first part of a component's name, without its camera.
constexpr std::array kCalibrationUnits = {
    CalibrationUnit{"T_g", "", 6},        CalibrationUnit{"T_s", "rad s/m", 6},
    CalibrationUnit{"T_a", "", 6},        CalibrationUnit{"p_CB", "m", 5},
    CalibrationUnit{"R_CB", "rad", 6},    CalibrationUnit{"intrinsics", "px", 3},
    CalibrationUnit{"fx", "px", 3},       CalibrationUnit{"fy", "px", 3},
    CalibrationUnit{"ox", "px", 3},       CalibrationUnit{"oy", "px", 3},
    CalibrationUnit{"k1", "", 6},         CalibrationUnit{"k2", "", 6},
    CalibrationUnit{"k3", "", 6},         CalibrationUnit{"k4", "", 6},
    CalibrationUnit{"t1", "", 6},         CalibrationUnit{"t2", "", 6},
    CalibrationUnit{"t_d", "s", 6},       CalibrationUnit{"t_r", "s", 6},
    CalibrationUnit{"distortion", "", 6},
};

std::optional<Metric> CalibrationMetric(std::string_view key) {
  const auto rest = After(key, "calibration.");
  if (!rest) return std::nullopt;
  const bool error = rest->ends_with(".error");
  if (!error && !rest->ends_with(".sigma")) return std::nullopt;
  const std::string_view name = rest->substr(0, rest->size() - std::string_view(".error").size());
  std::string_view block = name;
  if (block.starts_with("cam")) {
    std::size_t digits = 3;
    while (digits < block.size() && std::isdigit(static_cast<unsigned char>(block[digits]))) {
      ++digits;
    }
    if (digits == 3 || digits >= block.size() || block[digits] != '.') return std::nullopt;
    block.remove_prefix(digits + 1);
  }
  block = block.substr(0, block.find('.'));
  for (const CalibrationUnit& unit : kCalibrationUnits) {
    if (block != unit.name) continue;
    return Metric{std::string(key),
                  (error ? "error of " : "reported sigma of ") + std::string(name) + " at the end",
                  unit.unit,
                  unit.decimals,
                  error ? Better::kNearZero : Better::kNeither,
                  0,
                  true};
  }
  return std::nullopt;
}

}  // namespace

double Metric::Score(double value) const {
  switch (better) {
    case Better::kLower:
    case Better::kNeither:
      return value;
    case Better::kHigher:
      return -value;
    case Better::kNearZero:
      return std::abs(value);
    case Better::kNearExpected:
      return std::abs(std::log(value / expected));
  }
  return value;
}

std::string Metric::Title() const { return unit.empty() ? words : words + " [" + unit + "]"; }

std::optional<Metric> FindMetric(std::string_view key) {
  for (const MetricEntry& entry : kMetrics) {
    if (key == entry.key) return MetricOfEntry(entry);
  }
  if (auto metric = AlignedMetric(key)) return metric;
  if (auto metric = RelativeMetric(key)) return metric;
  return CalibrationMetric(key);
}

Metric MetricOf(std::string_view key) {
  std::optional<Metric> metric = FindMetric(key);
  if (metric) return *metric;
  std::vector<std::string> keys = MetricKeys();
  // With a parameter as it is usually given, so that a misspelt one is near.
  for (const char* example : {"relative.position_m.5", "relative.orientation_deg.5",
                              "calibration.t_d.error", "calibration.t_d.sigma"}) {
    keys.emplace_back(example);
  }
  throw InputError("no metric is called \"" + std::string(key) + "\"" + DidYouMean(key, keys));
}

std::vector<std::string> MetricKeys() {
  std::vector<std::string> keys;
  for (const MetricEntry& entry : kMetrics) keys.emplace_back(entry.key);
  return keys;
}

}  // namespace duet
