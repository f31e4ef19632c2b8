#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/imu/nav_state.h"
#include "common/support/timestamp.h"
#include "evaluation/chi_squared.h"

namespace duet {

/// The parts of an estimator's state whose normalized estimation error squared (NEES) is reported.
enum class NeesBlock {
  kPose,         ///< theta, p: 6
  kOrientation,  ///< theta: 3
  kPosition,     ///< p: 3
  kVelocity,     ///< v: 3
  kGyroBias,     ///< b_g: 3
  kAccelBias,    ///< b_a: 3
  kState,        ///< theta, p, v, b_g, b_a: 15
};
inline constexpr int kNeesBlockCount = 7;
inline constexpr std::array<NeesBlock, kNeesBlockCount> kNeesBlocks = {
    NeesBlock::kPose,     NeesBlock::kOrientation, NeesBlock::kPosition, NeesBlock::kVelocity,
    NeesBlock::kGyroBias, NeesBlock::kAccelBias,   NeesBlock::kState};
/// "pose", "orientation", ...
[[nodiscard]] const char* NeesBlockName(NeesBlock block);
[[nodiscard]] int NeesBlockSize(NeesBlock block);

/// error^T covariance^-1 error; nothing where the covariance is not positive definite or a number
/// is not finite. Rows are scaled to unit variance first, so that units do not matter to the test.
[[nodiscard]] std::optional<double> Nees(const Eigen::Ref<const Eigen::VectorXd>& error,
                                         const Eigen::Ref<const Eigen::MatrixXd>& covariance);

/// NEES of one instant, by block; nothing where it cannot be computed or the block's truth is
/// unknown.
struct NeesSample {
  Timestamp timestamp = 0;
  std::array<std::optional<double>, kNeesBlockCount> value;
};

/// `covariance` has theta, p, v, b_g, b_a in its first 15 rows and columns (global errors,
/// DESIGN.md section 3: R_true = Exp(theta) R_est, everything else true minus estimate); what
/// follows is left out. The estimate is not aligned: claim NEES from simulation only.
/// `velocity_known` and `biases_known` say whether the truth holds them (a column of zeros in a
/// data set can mean "unknown").
[[nodiscard]] NeesSample ComputeNees(Timestamp timestamp, const InertialState& truth,
                                     const InertialState& estimate,
                                     const Eigen::Ref<const Eigen::MatrixXd>& covariance,
                                     bool velocity_known = true, bool biases_known = true);

/// One seed: the samples of one run, ascending in time.
struct NeesRun {
  Timestamp start = 0;  ///< of the estimate; samples of the first `settle_s` after it are not used
  bool failed = false;  ///< the estimator failed: counted, and in no mean
  std::vector<NeesSample> samples;
};

struct ConsistencyOptions {
  double settle_s = 2.0;
  double confidence = 0.95;
};

struct BlockConsistency {
  NeesBlock block = NeesBlock::kPose;
  int dof = 0;
  int runs = 0;      ///< that have this block
  int instants = 0;  ///< that all of these have
  /// Over runs, of each run's mean over time: for one number that uses everything. Instants depend
  /// on one another, so that no chi-squared band belongs to it; `standard_error` comes from the
  /// runs, which do not.
  double mean = 0.0;
  double standard_error = 0.0;
  /// The median, over instants, of the mean over runs at that instant: `band` belongs to it.
  double median_instant = 0.0;
  Band band;
  double instants_in_band = 0.0;  ///< share; about `confidence` where the estimator is consistent
  double p_value = 0.0;           ///< of median_instant, by MeanChiSquaredPValue
  /// Rejected as inconsistent at 1 - confidence over all blocks together (Holm).
  bool rejected = false;
};

struct ConsistencyReport {
  int runs = 0;
  int failed = 0;
  int not_computed = 0;  ///< values missing in runs that have the block: covariance not definite
  std::vector<BlockConsistency> blocks;  ///< those that any run has
};

/// Runs with the same instants (matched by stamp; an instant that one run lacks is left out).
[[nodiscard]] ConsistencyReport SummarizeConsistency(std::span<const NeesRun> runs,
                                                     const ConsistencyOptions& options = {});

/// NEES of one run over time, for showing: a single run proves nothing.
struct NeesOfRun {
  NeesBlock block = NeesBlock::kPose;
  int instants = 0;
  double mean = 0.0;
  double median = 0.0;
};
/// By block, after the first `settle_s`; only blocks with a value.
[[nodiscard]] std::vector<NeesOfRun> SummarizeNees(const NeesRun& run, double settle_s = 2.0);

/// A table of the report for the terminal.
[[nodiscard]] std::string ConsistencyText(const ConsistencyReport& report);

}  // namespace duet
