#include "experiments/ablation/recorded_run.h"

#include <algorithm>

#include "common/measurement/gauge.h"
#include "common/measurement/told_errors.h"
#include "common/support/stage_timer.h"
#include "evaluation/evaluate.h"
#include "evaluation/statistics.h"
#include "experiments/imu_feed.h"

namespace duet {
namespace {

// As duet compare: poses within the frames' span, jumps of the truth left out.
void AddAccuracy(const Session& session, const EstimatorSetup& setup,
                 const std::vector<StampedPose>& estimate, MonteCarloRun* run) {
  const std::vector<StampedPose> truth = session.TruthFor(setup);
  const std::vector<Timestamp> stamps = session.recording.FrameStamps();
  EvaluationOptions options = session.configuration.evaluation.Options();
  options.start = std::max(stamps.front(), truth.front().timestamp);
  options.end = std::min(stamps.back(), truth.back().timestamp);
  const Evaluation evaluation =
      Evaluate({session.recording.truth_file, truth}, {{"estimate", estimate}}, options);
  const TrajectoryEvaluation& result = evaluation.estimates.front();
  if (result.association.pairs.size() < 3) {
    run->failed = true;
    run->reason = "fewer than three of its poses have a truth";
    return;
  }
  const AbsoluteErrors& errors = result.absolute;
  if (errors.alignment.refusal != AlignmentRefusal::kNone) {
    run->failed = true;
    run->reason = std::string("its poses can't be aligned with the truth: ") +
                  AlignmentRefusalText(errors.alignment.refusal);
    return;
  }
  run->ate_position_m = errors.position_m.rmse;
  run->ate_orientation_deg = errors.orientation_deg.rmse;
  run->coverage_s = result.association.coverage_s;
}

}  // namespace

MonteCarloRun RunRecorded(const Session& session, const std::vector<TrackFrameSet>& frames,
                          const std::string& estimator_name, const CalibrationPriors& priors) {
  Configuration configuration = session.configuration;
  configuration.shared.calibration = priors;
  IncludeTold(ToldRig(session.recording.rig, priors), &configuration.shared);
  const EstimatorSetup setup = session.SetupWith(configuration.shared);
  EstimatorStart start = session.StartWith(setup);
  const std::unique_ptr<Estimator> estimator =
      MakeEstimator(estimator_name, setup, configuration.backends);
  const Eigen::Quaterniond gauge = GaugeRotation(session.recording.rig, setup.rig, priors);

  MonteCarloRun run;
  run.seed = priors.told_errors_seed;
  run.told_rig = setup.rig;
  run.calibration =
      CalibrationErrors(estimator->layout(), Reoriented(session.recording.rig, gauge));
  ImuFeed feed(session.recording.imu);
  const Timestamp horizon = ToNanoseconds(ImuHorizon(configuration.shared));
  std::vector<double> frame_ms;
  std::vector<StampedPose> estimate;
  OutputCollector collector(&run);
  bool started = false;
  for (const TrackFrameSet& frame : frames) {
    feed.Advance(frame.timestamp + horizon, estimator.get());
    if (!started) {
      const std::optional<InitialCondition> initial = start.Try(frame);
      if (!initial) continue;
      estimator->Initialize(*initial);
      started = true;
    }
    const double before_ms = ThreadCpuMs();
    const EstimatorOutput& output = estimator->ProcessFrame(frame);
    frame_ms.push_back(ThreadCpuMs() - before_ms);
    if (collector.Add(output)) {
      estimate.push_back({output.state.instant, output.state.nav.pose()});
    }
    if (run.failed) break;
  }
  const ErrorSummary cost = Summarize(frame_ms);
  run.frame_ms_median = cost.median;
  run.frame_ms_p99 = cost.p99;
  if (!started) {
    run.failed = true;
    run.reason = "did not start: " + start.reason();
  }
  collector.Finish();
  if (!run.failed) AddAccuracy(session, setup, estimate, &run);
  return run;
}

}  // namespace duet
