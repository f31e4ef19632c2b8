#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "backends/estimator.h"
#include "backends/initialization/initialization.h"
#include "evaluation/alignment.h"
#include "evaluation/calibration_errors.h"
#include "evaluation/consistency.h"
#include "experiments/simulation/simulator.h"

namespace duet {

/// A new estimator for a setup; called from several threads at once.
using EstimatorMaker = std::function<std::unique_ptr<Estimator>(const EstimatorSetup&)>;

/// Many simulated recordings through one estimator, in memory. The start error is drawn from the
/// start covariance, the told calibration from the priors of what is estimated: without that NEES
/// means nothing (DESIGN.md section 5).
struct MonteCarloOptions {
  SimulationOptions simulation;  ///< `seed` is the first run's; told_errors are not read
  SharedOptions shared;          ///< with pixel noise from the simulation
  InitializationOptions start;   ///< 1 sigma of the first state
  /// The told calibration's errors are drawn from the priors of what is estimated; false: as
  /// shared.calibration.told_errors says.
  bool told_from_priors = true;
  int runs = 20;
  int threads = 2;
  double settle_s = 2.0;  ///< evaluation.nees_settle_s
  /// evaluation.alignment and min_spread_m, of ate_*. (The truth is known at every instant: there
  /// is nothing to associate.)
  AlignmentMode alignment = AlignmentMode::kPositionYaw;
  AlignmentOptions alignment_options = {};
  /// Start errors, IMU and pixel noise and the priors of the calibration all multiplied by it.
  double noise_scale = 1.0;
};

/// One run. All errors are over the states from settle_s after the first one on, as NEES is; NaN
/// where a run has none. A run with fewer than three of them has failed: two poses always align.
struct MonteCarloRun {
  int seed = 0;
  bool failed = false;
  std::string reason;
  NeesRun nees;             ///< stamps are the frames'
  int frames = 0;           ///< given to the estimator
  int dead_reckoned = 0;    ///< of these; skipped ones too
  double coverage_s = 0.0;  ///< from the first to the last frame with a state of its own
  /// Root mean square, without alignment: the start error is part of it.
  double position_rms_m = std::numeric_limits<double>::quiet_NaN();
  double orientation_rms_deg = std::numeric_limits<double>::quiet_NaN();
  double velocity_rms_m_per_s = std::numeric_limits<double>::quiet_NaN();
  double b_g_rms_rad_per_s = std::numeric_limits<double>::quiet_NaN();
  double b_a_rms_m_per_s2 = std::numeric_limits<double>::quiet_NaN();
  /// After the alignment asked for, positions and orientations apart (evaluation/errors.h); NaN
  /// where it is refused, as of a truth that stands still.
  double ate_position_m = std::numeric_limits<double>::quiet_NaN();
  double ate_orientation_deg = std::numeric_limits<double>::quiet_NaN();
  long used = 0;  ///< sums of FeatureCounts
  long gated = 0;
  CalibrationErrors calibration;  ///< of what is estimated; empty where nothing is
  RigCalibration told_rig;
  /// Thread CPU time of the estimator a frame; influences nothing and is not the same twice.
  double frame_ms_median = 0.0;
  double frame_ms_p99 = 0.0;
};

struct MonteCarloResult {
  std::vector<MonteCarloRun> runs;  ///< in order of seed
  ConsistencyReport consistency;

  [[nodiscard]] const BlockConsistency& Block(NeesBlock block) const;  ///< CHECKs that it is there
};

/// Collects what a run's outputs say of themselves, in order: counts, coverage, the calibration.
class OutputCollector {
 public:
  explicit OutputCollector(MonteCarloRun* run) : run_(*run) {}

  /// True where the output holds a state that is newer than the last one. A frame that the IMU does
  /// not cover leaves the state where it was; before the first that it covers there is none. Fails
  /// the run where the estimator did.
  [[nodiscard]] bool Add(const EstimatorOutput& output);
  /// Fails a run that never had a state.
  void Finish();

  [[nodiscard]] Timestamp first_frame() const { return first_frame_; }  ///< with a state

 private:
  MonteCarloRun& run_;
  bool has_state_ = false;
  Timestamp first_frame_ = 0;
  Timestamp newest_ = 0;
  std::string why_none_ = "there was no frame";
};

/// The same result for any number of threads.
[[nodiscard]] MonteCarloResult RunMonteCarlo(const MonteCarloOptions& options,
                                             const EstimatorMaker& make_estimator);

/// NEES over runs with the same instants.
[[nodiscard]] ConsistencyReport SummarizeRuns(std::span<const MonteCarloRun> runs, double settle_s);

/// SummarizeCalibration of the runs that did not fail.
[[nodiscard]] std::vector<CalibrationBlockSummary> SummarizeCalibrationOfRuns(
    std::span<const MonteCarloRun> runs, const Eigen::VectorXd& predicted_sigma = {},
    const std::vector<double>& further_p_values = {});

/// One seed of it. Throws InputError for a told calibration that no estimator can start from.
[[nodiscard]] MonteCarloRun RunOnce(const MonteCarloOptions& options, int seed,
                                    const EstimatorMaker& make_estimator);

/// The first state's covariance: order theta, p, v, b_g, b_a; theta in G, so that its z is yaw.
[[nodiscard]] Matrix15d StartCovariance(const InitializationOptions& start, double scale);

/// The start of a run: the truth, off by an error that is drawn from StartCovariance(start, scale)
/// by a random sequence of its own, times start.drawn_error_scale.
[[nodiscard]] InitialCondition DrawStart(const InertialState& truth,
                                         const InitializationOptions& start, double scale,
                                         std::uint64_t seed);

/// The table of a study for the terminal.
[[nodiscard]] std::string MonteCarloText(const std::string& title, const MonteCarloResult& result);

/// How an error follows the noise: least-squares slope of log(error) against log(scale).
[[nodiscard]] double LogLogSlope(const std::vector<double>& scales,
                                 const std::vector<double>& errors);

}  // namespace duet
