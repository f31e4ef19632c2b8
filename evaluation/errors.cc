#include "evaluation/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.h"
#include "common/geometry/so3.h"

namespace duet {
namespace {

std::optional<Eigen::Quaterniond> FitOrientations(const std::vector<PosePair>& pairs,
                                                  AlignmentMode mode,
                                                  const AlignmentResult& alignment) {
  switch (mode) {
    case AlignmentMode::kNone:
    case AlignmentMode::kFirstPose:
      if (!alignment.alignment) return std::nullopt;
      return alignment.alignment->R_GE;
    case AlignmentMode::kPositionYaw:
      return FitYawToOrientations(pairs);
    case AlignmentMode::kSe3:
    case AlignmentMode::kSim3:
      return FitRotationToOrientations(pairs);
  }
  return std::nullopt;
}

void ComputePositionErrors(const std::vector<PosePair>& pairs, AbsoluteErrors* errors) {
  errors->position_rmse_xyz_m.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (!errors->alignment.alignment) return;
  Eigen::Vector3d sum_of_squares = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d e_G = pair.T_GB_true.p - errors->alignment.alignment->Apply(pair.T_EB.p);
    sum_of_squares += e_G.cwiseAbs2();
    errors->position_series_m.push_back(e_G.norm());
  }
  errors->position_rmse_xyz_m = (sum_of_squares / static_cast<double>(pairs.size())).cwiseSqrt();
  errors->position_m = Summarize(errors->position_series_m);
}

void ComputeOrientationErrors(const std::vector<PosePair>& pairs, AbsoluteErrors* errors) {
  if (errors->orientation_R_GE) {
    for (const PosePair& pair : pairs) {
      const Eigen::Quaterniond E =
          pair.T_GB_true.R * (*errors->orientation_R_GE * pair.T_EB.R).conjugate();
      errors->orientation_series_deg.push_back(Log(E).norm() * kDegreesPerRadian);
      errors->yaw_series_deg.push_back(std::abs(YawOf(E)) * kDegreesPerRadian);
      errors->tilt_series_deg.push_back(TiltOf(E) * kDegreesPerRadian);
    }
    errors->orientation_deg = Summarize(errors->orientation_series_deg);
    errors->yaw_deg = Summarize(errors->yaw_series_deg);
    errors->tilt_deg = Summarize(errors->tilt_series_deg);
  }
  if (errors->alignment.alignment) {
    std::vector<double> angles_deg;
    for (const PosePair& pair : pairs) {
      const Eigen::Quaterniond R_GB = errors->alignment.alignment->R_GE * pair.T_EB.R;
      angles_deg.push_back(BoxMinus(pair.T_GB_true.R, R_GB).norm() * kDegreesPerRadian);
    }
    errors->orientation_by_positions_deg = Summarize(std::move(angles_deg));
  }
}

}  // namespace

AbsoluteErrors ComputeAbsoluteErrors(const std::vector<PosePair>& pairs, AlignmentMode mode,
                                     const AlignmentOptions& options) {
  AbsoluteErrors errors;
  errors.alignment = Align(pairs, mode, options);
  errors.orientation_R_GE = FitOrientations(pairs, mode, errors.alignment);
  ComputePositionErrors(pairs, &errors);
  ComputeOrientationErrors(pairs, &errors);
  return errors;
}

std::optional<Drift> DriftFromFirstPose(const std::vector<Pose>& poses) {
  if (poses.empty()) return std::nullopt;
  Drift drift;
  for (const Pose& pose : poses) {
    drift.position_end_m = (pose.p - poses.front().p).norm();
    drift.orientation_end_deg = BoxMinus(pose.R, poses.front().R).norm() * kDegreesPerRadian;
    drift.position_max_m = std::max(drift.position_max_m, drift.position_end_m);
    drift.orientation_max_deg = std::max(drift.orientation_max_deg, drift.orientation_end_deg);
  }
  return drift;
}

}  // namespace duet
