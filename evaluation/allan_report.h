#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/imu/imu_model.h"
#include "common/imu/imu_sample.h"
#include "evaluation/allan.h"

namespace duet {

/// One axis of one sensor.
struct AxisAllan {
  std::vector<AllanPoint> curve;
  AllanFit fit;
};

/// The Allan deviations of an IMU at rest.
struct ImuAllan {
  Timestamp start = 0;                     ///< first sample used
  Timestamp end = 0;                       ///< last one
  int samples = 0;                         ///< used: the longest stretch without a gap
  int left_out = 0;                        ///< outside of it
  double rate_hz = 0.0;                    ///< of the stretch
  std::array<AxisAllan, 3> gyroscope;      ///< rad/s
  std::array<AxisAllan, 3> accelerometer;  ///< m/s^2
  /// Neighbouring seconds differ by more than any IMU's noise: the rig moves, and what follows is
  /// the motion's.
  bool moves = false;

  /// The mean of the axes' squares, as its root: what sensor.yaml holds one number for.
  [[nodiscard]] ImuNoise Noise() const;
};

/// A gap is more than 1.5 times the median interval; the deviations need even samples. Throws
/// InputError that names `file` for fewer than 1000 samples in the longest stretch, of whose
/// stamps' jitter nothing is taken out.
[[nodiscard]] ImuAllan AnalyzeImu(const std::vector<ImuSample>& imu, const std::string& file);

/// One row a tau: tau, clusters, the six deviations and the six fits (docs/formats.md).
[[nodiscard]] std::string AllanCsv(const ImuAllan& allan);
/// The fits by sensor and axis, and `told` beside them.
[[nodiscard]] nlohmann::ordered_json AllanJson(const ImuAllan& allan, const ImuNoise& told);
/// For the terminal.
[[nodiscard]] std::string AllanText(const ImuAllan& allan, const ImuNoise& told);
/// A gnuplot script that draws allan.csv, in whose folder it runs, as allan.svg, .pdf and .png:
/// curves, fits, and the lines of the densities `told`.
[[nodiscard]] std::string AllanScript(const ImuAllan& allan, const ImuNoise& told,
                                      const std::string& title);

}  // namespace duet
