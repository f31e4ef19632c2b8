#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.h"
#include "evaluation/association.h"

namespace duet {

/// Which transformations of the estimate's global frame E into the truth's G are free. A
/// visual-inertial estimator cannot know four: position and yaw.
enum class AlignmentMode {
  kNone,
  kFirstPose,    ///< all six, from the first pair alone
  kPositionYaw,  ///< p_GE and a rotation about the vertical, least squares over all pairs
  kSe3,          ///< R_GE, p_GE, least squares over all pairs
  kSim3,         ///< with a scale besides: a diagnostic, since scale is observable with an IMU
};
/// "none", "first", "posyaw", "se3", "sim3": what --alignment takes.
[[nodiscard]] const char* AlignmentModeName(AlignmentMode mode);
/// Throws InputError that names the five.
[[nodiscard]] AlignmentMode ParseAlignmentMode(const std::string& name);

/// x_G = scale * R_GE x_E + p_GE.
struct Alignment {
  AlignmentMode mode = AlignmentMode::kNone;
  Eigen::Quaterniond R_GE = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_GE = Eigen::Vector3d::Zero();
  double scale = 1.0;

  [[nodiscard]] Eigen::Vector3d Apply(const Eigen::Vector3d& x_E) const {
    return scale * (R_GE * x_E) + p_GE;
  }
};

/// Why an alignment is not determined by the pairs.
enum class AlignmentRefusal {
  kNone,
  kNoPairs,
  kTooFewPoses,           ///< fewer than three
  kCoincidentTruth,       ///< the truth stands still: look at the drift from the first pose
  kCoincidentEstimate,    ///< the estimate stands still where the truth does not
  kRotationUndetermined,  ///< positions on a line (for position + yaw: on a vertical one)
};
/// A sentence for tables.
[[nodiscard]] const char* AlignmentRefusalText(AlignmentRefusal refusal);

struct AlignmentOptions {
  /// A truth whose positions have a smaller root mean square distance from their mean (position +
  /// yaw: in the horizontal plane) counts as standing still: its rotation would be fitted to noise.
  double min_spread_m = 0.01;
};

struct AlignmentResult {
  std::optional<Alignment> alignment;  ///< nothing where refused
  AlignmentRefusal refusal = AlignmentRefusal::kNone;
};

/// The transformation of `mode` that brings the estimated positions nearest to the true ones: the
/// minimum of sum |p_GB_true - (scale R_GE p_EB + p_GE)|^2 over all pairs. SE(3) and Sim(3) are
/// Umeyama's closed form ("Least-squares estimation of transformation parameters between two point
/// patterns", PAMI 1991, equations 39 to 42; a reflection is never returned); with the rotation
/// held to the vertical axis the sum is A + B cos(yaw) + C sin(yaw), whose minimum is closed too.
[[nodiscard]] AlignmentResult Align(const std::vector<PosePair>& pairs, AlignmentMode mode,
                                    const AlignmentOptions& options = {});

/// The rotation about the vertical that brings the estimated *orientations* nearest to the true
/// ones: the minimum of sum ||R_GB_true - Rz(yaw) R_EB||_F^2. No angle is ever unwrapped, none is
/// singular. Nothing for no pairs, or where every yaw is as good as another (a mean error of half
/// a turn). A path one metre wide gives yaw from positions a degree of its own; this has none.
[[nodiscard]] std::optional<Eigen::Quaterniond> FitYawToOrientations(
    const std::vector<PosePair>& pairs);

/// The same over all rotations.
[[nodiscard]] std::optional<Eigen::Quaterniond> FitRotationToOrientations(
    const std::vector<PosePair>& pairs);

/// Rotation about z by `yaw` [rad].
[[nodiscard]] Eigen::Quaterniond YawRotation(double yaw);
/// The rotation about z nearest to R, its angle [rad].
[[nodiscard]] double YawOf(const Eigen::Quaterniond& R);
/// The angle by which R tips the vertical [rad], 0 to pi; no rotation about z, before or after,
/// changes it.
[[nodiscard]] double TiltOf(const Eigen::Quaterniond& R);

}  // namespace duet
