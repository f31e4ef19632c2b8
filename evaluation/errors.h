#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/se3.h"
#include "evaluation/alignment.h"
#include "evaluation/association.h"
#include "evaluation/statistics.h"

namespace duet {

/// Absolute trajectory error: how far the aligned estimate is from the truth, pair by pair.
///
/// Positions and orientations are aligned apart, each by its own fit over the *same* class of
/// transformations, so that neither spoils the other: `posyaw` fits a yaw to the positions for the
/// positions and a yaw to the orientations for the orientations; `se3` and `sim3` fit a rotation to
/// each; `first` and `none` leave nothing to fit. Every number is unchanged when the estimate is
/// moved by a transformation of the class.
struct AbsoluteErrors {
  AlignmentResult alignment;  ///< to the positions
  /// |p_GB_true - (scale R_GE p_EB + p_GE)|; count 0 where the alignment is refused.
  ErrorSummary position_m;
  Eigen::Vector3d position_rmse_xyz_m;  ///< in G; NaN where refused

  /// R_GE for the orientations; nothing where it is not determined (the summaries are then empty).
  std::optional<Eigen::Quaterniond> orientation_R_GE;
  ErrorSummary orientation_deg;  ///< angle of E = R_GB_true (R_GE R_EB)^T
  ErrorSummary yaw_deg;          ///< absolute angle of the rotation about z nearest to E
  ErrorSummary tilt_deg;         ///< angle by which E tips the vertical: roll and pitch together
  /// The angle with the R_GE of the positions instead: what other programs print.
  ErrorSummary orientation_by_positions_deg;

  /// One number a pair, for figures; empty where the summary is.
  std::vector<double> position_series_m, orientation_series_deg, yaw_series_deg, tilt_series_deg;
};

[[nodiscard]] AbsoluteErrors ComputeAbsoluteErrors(const std::vector<PosePair>& pairs,
                                                   AlignmentMode mode,
                                                   const AlignmentOptions& options = {});

/// How far a trajectory goes from its own first pose: the error of an estimator at standstill,
/// where an alignment is not determined and would hide the drift anyway.
struct Drift {
  double position_max_m = 0.0;
  double position_end_m = 0.0;
  double orientation_max_deg = 0.0;
  double orientation_end_deg = 0.0;
};

/// Nothing for no poses.
[[nodiscard]] std::optional<Drift> DriftFromFirstPose(const std::vector<Pose>& poses);

}  // namespace duet
