#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/dataset/ground_truth.h"
#include "common/support/timestamp.h"

namespace duet {

/// What a report shows of a run over time: column after column, by these names (web/src/data.js).
/// NaN where a record does not have it.
///   t                        s after the origin that runs of one stream share
///   p_*                      estimate of p_GB [m]
///   r_*                      estimate of R_GB, as a rotation vector [rad]
///   e_p_*, e_theta_*         true minus estimate [m]; theta of R_true = Exp(theta) R_estimate
///   [rad] P_*                      covariance of the position [m^2] s_theta_* standard deviations
///   of theta [rad] nees_*                   NEES
inline constexpr std::array<const char*, 25> kCurveColumns = {
    "t",         "p_x",       "p_y",       "p_z",           "r_x",
    "r_y",       "r_z",       "e_p_x",     "e_p_y",         "e_p_z",
    "e_theta_x", "e_theta_y", "e_theta_z", "P_xx",          "P_xy",
    "P_xz",      "P_yy",      "P_yz",      "P_zz",          "s_theta_x",
    "s_theta_y", "s_theta_z", "nees_pose", "nees_position", "nees_orientation"};

struct RunCurves {
  std::vector<Timestamp> instants;
  /// All but t, which the instants are; each as long as `instants`.
  std::array<std::vector<double>, kCurveColumns.size() - 1> columns;
  std::size_t all_instants = 0;  ///< that the record has; more than `instants` where thinned

  /// What lays the estimate onto the truth: position and yaw by the positions, yaw by the
  /// orientations (evaluation/errors.h). Nothing where it is not determined.
  struct Alignment {
    Eigen::Quaterniond R_GE;
    Eigen::Vector3d p_GE;
    Eigen::Quaterniond orientation_R_GE;
  };
  std::optional<Alignment> alignment;
};

/// A run record's curves, nothing where it has no state. `truth`: in the estimator's axes, null
/// where unknown; NEES needs `with_nees` besides (it is claimed of simulations only). Throws
/// InputError.
[[nodiscard]] std::optional<RunCurves> ReadRunCurves(const std::filesystem::path& record,
                                                     const GroundTruth* truth, bool with_nees);

/// At most `most` instants (but at least four for each column that is thinned by): the first and
/// the last, and of each of so many stretches of equal length those at which p, an error, a
/// standard deviation or a NEES is smallest or largest. No extreme is lost.
[[nodiscard]] RunCurves Thinned(const RunCurves& curves, std::size_t most);

/// All columns as little-endian float32, column after column, in base64.
[[nodiscard]] std::string EncodeCurves(const RunCurves& curves, Timestamp origin);

/// Bytes of EncodeCurves for so many instants.
[[nodiscard]] constexpr std::size_t EncodedSize(std::size_t instants) {
  return (instants * kCurveColumns.size() * sizeof(float) + 2) / 3 * 4;
}

}  // namespace duet
