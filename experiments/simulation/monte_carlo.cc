#include "experiments/simulation/monte_carlo.h"

#include <glog/logging.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "common/geometry/angle.h"
#include "common/geometry/so3.h"
#include "common/measurement/gauge.h"
#include "common/measurement/told_checks.h"
#include "common/measurement/told_errors.h"
#include "common/support/numeric_text.h"
#include "common/support/stage_timer.h"
#include "evaluation/errors.h"
#include "evaluation/statistics.h"
#include "experiments/imu_feed.h"
#include "experiments/parallel_for.h"

namespace duet {
namespace {

// Apart from the recording's own random sequences (simulator.cc).
constexpr std::uint64_t kStartStream = 11;

// Collects what one run's outputs say against the truth.
class RunStatistics {
 public:
  // The truth is taken in the axes that the estimator's gauge ties the body to.
  RunStatistics(const SimulatedRecording& recording, const Eigen::Quaterniond& gauge,
                const MonteCarloOptions& options, MonteCarloRun* run)
      : recording_(recording), gauge_(gauge), options_(options), run_(*run), collector_(run) {}

  void Add(const EstimatorOutput& output) {
    if (!collector_.Add(output)) return;
    const InertialState truth = Reoriented(recording_.TruthAt(output.state.instant), gauge_);
    run_.nees.samples.push_back(
        ComputeNees(output.frame_timestamp, truth, output.state, output.covariance));
    if (run_.coverage_s < options_.settle_s) return;
    const Vector15d error = BoxMinus(truth, output.state);
    squares_ += error.cwiseAbs2();
    pairs_.push_back({.timestamp = output.frame_timestamp,
                      .T_GB_true = truth.nav.pose(),
                      .T_EB = output.state.nav.pose()});
  }

  void Finish() {
    collector_.Finish();
    if (!run_.failed && pairs_.size() < 3) {
      run_.failed = true;
      run_.reason = "fewer than three of its states come " + FormatNumber(options_.settle_s) +
                    " s after the first or later (evaluation.nees_settle_s)";
    }
    run_.nees.start = collector_.first_frame();
    run_.nees.failed = run_.failed;
    if (run_.failed) return;
    const double count = static_cast<double>(pairs_.size());
    const auto rms = [&](int block) {
      return std::sqrt(squares_.segment<3>(3 * block).sum() / count);
    };
    run_.orientation_rms_deg = rms(0) * kDegreesPerRadian;
    run_.position_rms_m = rms(1);
    run_.velocity_rms_m_per_s = rms(2);
    run_.b_g_rms_rad_per_s = rms(3);
    run_.b_a_rms_m_per_s2 = rms(4);
    const AbsoluteErrors ate =
        ComputeAbsoluteErrors(pairs_, options_.alignment, options_.alignment_options);
    run_.ate_position_m = ate.position_m.rmse;
    run_.ate_orientation_deg = ate.orientation_deg.rmse;
  }

 private:
  const SimulatedRecording& recording_;
  Eigen::Quaterniond gauge_;
  const MonteCarloOptions& options_;
  MonteCarloRun& run_;
  OutputCollector collector_;
  Vector15d squares_ = Vector15d::Zero();
  std::vector<PosePair> pairs_;
};

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string Format(const char* format, ...) {
  char buffer[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof(buffer), format, arguments);
  va_end(arguments);
  return buffer;
}

}  // namespace

bool OutputCollector::Add(const EstimatorOutput& output) {
  ++run_.frames;
  run_.used += output.features.used;
  run_.gated += output.features.gated;
  if (output.status == EstimatorStatus::kFailed) {
    run_.failed = true;
    run_.reason = output.reason;
    return false;
  }
  if (output.status == EstimatorStatus::kDeadReckoning) ++run_.dead_reckoned;
  const bool holds_state =
      output.status != EstimatorStatus::kInitializing && output.covariance.size() > 0;
  if (!holds_state) why_none_ = output.reason;
  if (!holds_state || (has_state_ && output.state.instant <= newest_)) return false;
  if (!has_state_) first_frame_ = output.frame_timestamp;
  has_state_ = true;
  newest_ = output.state.instant;
  run_.coverage_s = SecondsBetween(first_frame_, output.frame_timestamp);
  if (const int size = run_.calibration.layout().size(); size > 0) {
    run_.calibration.Add(run_.coverage_s, output.rig, output.covariance.block(15, 15, size, size));
  }
  return true;
}

void OutputCollector::Finish() {
  if (has_state_ || run_.failed) return;
  run_.failed = true;
  run_.reason = "has no state: " + why_none_;
}

Matrix15d StartCovariance(const InitializationOptions& start, double scale) {
  Vector15d sigma;
  sigma << start.sigma_tilt_rad, start.sigma_tilt_rad, start.sigma_yaw_rad,
      Eigen::Vector3d::Constant(start.sigma_position_m),
      Eigen::Vector3d::Constant(start.sigma_velocity_m_per_s),
      Eigen::Vector3d::Constant(start.sigma_b_g_rad_per_s),
      Eigen::Vector3d::Constant(start.sigma_b_a_m_per_s2);
  return (scale * sigma).cwiseAbs2().asDiagonal();
}

InitialCondition DrawStart(const InertialState& truth, const InitializationOptions& start,
                           double scale, std::uint64_t seed) {
  Random random(seed, kStartStream);
  InitialCondition drawn =
      DrawInitialCondition(truth, StartCovariance(start, scale * start.drawn_error_scale), &random);
  drawn.covariance = StartCovariance(start, scale);
  return drawn;
}

MonteCarloRun RunOnce(const MonteCarloOptions& options, int seed,
                      const EstimatorMaker& make_estimator) {
  SimulationOptions simulation = options.simulation;
  simulation.seed = seed;
  simulation.noise_scale *= options.noise_scale;
  const CalibrationPriors& priors = options.shared.calibration;
  simulation.told_errors =
      options.told_from_priors ? ToldErrorsOfPriors(priors) : priors.told_errors;
  simulation.told_imu_frame = priors.imu_frame;
  simulation.told_cameras = priors.cameras;
  SimulatedRecording recording = Simulate(simulation);
  recording.told_rig = AddToldOffset(recording.told_rig, priors.told_offset);
  CheckTold(recording.told_rig, priors);
  SharedOptions shared = options.shared;
  shared.calibration = ScaledPriors(shared.calibration, simulation.noise_scale);
  IncludeTold(recording.told_rig, &shared);
  const EstimatorSetup setup = MakeSetup(recording, shared);
  const std::unique_ptr<Estimator> estimator = make_estimator(setup);

  MonteCarloRun run;
  run.seed = seed;
  run.told_rig = recording.told_rig;
  const Timestamp first_instant =
      recording.frames.front().timestamp + ToNanoseconds(recording.told_rig.t_d_s);
  if (first_instant < recording.truth.front().instant ||
      first_instant > recording.truth.back().instant) {
    run.failed = run.nees.failed = true;
    run.reason = "did not start: its told t_d, " + FormatNumber(recording.told_rig.t_d_s) +
                 " s, puts the first frame where there is no IMU";
    return run;
  }
  const Eigen::Quaterniond gauge =
      GaugeRotation(recording.true_rig, recording.told_rig, shared.calibration);
  estimator->Initialize(DrawStart(Reoriented(recording.TruthAt(first_instant), gauge),
                                  options.start, options.noise_scale,
                                  static_cast<std::uint64_t>(seed)));

  run.calibration = CalibrationErrors(estimator->layout(), Reoriented(recording.true_rig, gauge));
  std::vector<double> frame_ms;
  RunStatistics statistics(recording, gauge, options, &run);
  const Timestamp horizon = ToNanoseconds(ImuHorizon(shared));
  ImuFeed feed(recording.imu);
  for (const TrackFrameSet& frames : recording.frames) {
    feed.Advance(frames.timestamp + horizon, estimator.get());
    const double before_ms = ThreadCpuMs();
    const EstimatorOutput& output = estimator->ProcessFrame(frames);
    frame_ms.push_back(ThreadCpuMs() - before_ms);
    statistics.Add(output);
    if (run.failed) break;
  }
  statistics.Finish();
  const ErrorSummary cost = Summarize(frame_ms);
  run.frame_ms_median = cost.median;
  run.frame_ms_p99 = cost.p99;
  return run;
}

MonteCarloResult RunMonteCarlo(const MonteCarloOptions& options,
                               const EstimatorMaker& make_estimator) {
  MonteCarloResult result;
  result.runs.resize(static_cast<std::size_t>(options.runs));
  ParallelFor(options.runs, options.threads, [&](int i) {
    result.runs[static_cast<std::size_t>(i)] =
        RunOnce(options, options.simulation.seed + i, make_estimator);
  });
  result.consistency = SummarizeRuns(result.runs, options.settle_s);
  return result;
}

ConsistencyReport SummarizeRuns(std::span<const MonteCarloRun> runs, double settle_s) {
  std::vector<NeesRun> nees;
  for (const MonteCarloRun& run : runs) nees.push_back(run.nees);
  return SummarizeConsistency(nees, {.settle_s = settle_s});
}

std::vector<CalibrationBlockSummary> SummarizeCalibrationOfRuns(
    std::span<const MonteCarloRun> runs, const Eigen::VectorXd& predicted_sigma,
    const std::vector<double>& further_p_values) {
  std::vector<const CalibrationErrors*> calibration;
  for (const MonteCarloRun& run : runs) {
    if (!run.failed) calibration.push_back(&run.calibration);
  }
  return SummarizeCalibration(calibration, predicted_sigma, further_p_values);
}

const BlockConsistency& MonteCarloResult::Block(NeesBlock block) const {
  for (const BlockConsistency& each : consistency.blocks) {
    if (each.block == block) return each;
  }
  LOG(FATAL) << "no NEES of " << NeesBlockName(block);
}

std::string MonteCarloText(const std::string& title, const MonteCarloResult& result) {
  std::string text = title + "\n" + ConsistencyText(result.consistency);
  const auto row = [&](const char* name, double MonteCarloRun::*member) {
    std::vector<double> values;
    for (const MonteCarloRun& run : result.runs) {
      if (!run.failed && std::isfinite(run.*member)) values.push_back(run.*member);
    }
    const ErrorSummary summary = Summarize(values);
    text +=
        Format("  %-28s %10.4g %10.4g %10.4g\n", name, summary.median, summary.p95, summary.max);
  };
  text += "  over runs                        median        p95        max\n";
  row("ATE position [m]", &MonteCarloRun::ate_position_m);
  row("ATE orientation [deg]", &MonteCarloRun::ate_orientation_deg);
  row("position, unaligned [m]", &MonteCarloRun::position_rms_m);
  row("orientation, unaligned [deg]", &MonteCarloRun::orientation_rms_deg);
  row("velocity [m/s]", &MonteCarloRun::velocity_rms_m_per_s);
  row("gyro bias [rad/s]", &MonteCarloRun::b_g_rms_rad_per_s);
  row("accel bias [m/s^2]", &MonteCarloRun::b_a_rms_m_per_s2);
  long used = 0;
  long gated = 0;
  for (const MonteCarloRun& run : result.runs) {
    used += run.used;
    gated += run.gated;
    if (run.failed) {
      text +=
          Format("  seed %d FAILED after %.1f s: ", run.seed, run.coverage_s) + run.reason + "\n";
      continue;
    }
  }
  text +=
      Format("  landmarks used %ld, gated %ld (%.1f %%)\n", used, gated,
             100.0 * static_cast<double>(gated) / static_cast<double>(std::max(1L, used + gated)));
  const std::vector<CalibrationBlockSummary> calibration = SummarizeCalibrationOfRuns(result.runs);
  if (!calibration.empty()) text += CalibrationText(calibration);
  return text;
}

double LogLogSlope(const std::vector<double>& scales, const std::vector<double>& errors) {
  CHECK_EQ(scales.size(), errors.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  const double count = static_cast<double>(scales.size());
  for (std::size_t i = 0; i < scales.size(); ++i) {
    mean_x += std::log(scales[i]) / count;
    mean_y += std::log(errors[i]) / count;
  }
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const double x = std::log(scales[i]) - mean_x;
    xx += x * x;
    xy += x * (std::log(errors[i]) - mean_y);
  }
  return xy / xx;
}

}  // namespace duet
