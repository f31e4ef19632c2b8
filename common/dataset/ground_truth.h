#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/se3.h"
#include "common/imu/nav_state.h"

namespace duet {

/// A trajectory as a file tells it: poses always, velocities and biases where they are known.
/// Quaternions are normalized; their signs are the file's.
struct GroundTruth {
  std::vector<StampedPose> poses;           ///< strictly increasing stamps
  std::vector<Eigen::Vector3d> velocities;  ///< v_GB, one a pose; empty where unknown
  std::vector<ImuBiases> biases;            ///< one a pose; empty where unknown

  [[nodiscard]] bool has_velocities() const { return !velocities.empty(); }
  [[nodiscard]] bool has_biases() const { return !biases.empty(); }
};

/// ASL's tables: 17 columns (stamp [ns], p, q in the order w x y z, v, b_g, b_a: EuRoC's
/// state_groundtruth_estimate0) or 8 (stamp, p, q: vicon0, mocap0). Columns of velocities or of
/// biases that are zero in every row mean "unknown". InputError for quaternions whose length is off
/// by more than 1e-3.
[[nodiscard]] GroundTruth ReadGroundTruthTable(std::string_view csv, const std::string& file);

/// TUM's text: "t x y z qx qy qz qw", t in decimal seconds, read to the nanosecond exactly.
[[nodiscard]] GroundTruth ReadTumTrajectory(std::string_view text, const std::string& file);

/// Either, by what the first row looks like: commas are ASL's.
[[nodiscard]] GroundTruth ReadTrajectory(std::string_view text, const std::string& file);
[[nodiscard]] GroundTruth ReadTrajectoryFile(const std::filesystem::path& path);

/// 17 columns; velocities or biases that are unknown are written as zeros (which mean that).
[[nodiscard]] std::string WriteGroundTruthTable(const GroundTruth& truth);
/// Stamps printed from integers (nine decimals), numbers by their shortest exact text.
[[nodiscard]] std::string WriteTumTrajectory(const std::vector<StampedPose>& poses);

/// The truth of inertial states, e.g. a simulation's.
[[nodiscard]] GroundTruth GroundTruthOf(const std::vector<InertialState>& states);

}  // namespace duet
