#include "experiments/estimation_loop.h"

#include "common/support/logging.h"
#include "common/support/stage_timer.h"
#include "experiments/imu_feed.h"
#include "experiments/interrupt.h"

namespace duet {
LoopOutcome RunEstimationLoop(const LoopParts& parts) {
  auto& [frames, imu, imu_horizon_s, start, estimator, recorder, timing, progress] = parts;
  StageTimer stages;  // the estimator's own
  StageTimer totals;
  estimator.set_stage_timer(&stages);
  ImuFeed feed(imu);
  bool started = false;

  while (const TrackFrameSet* frame = Interrupted() ? nullptr : frames.Next()) {
    stages.StartFrame();
    totals.StartFrame();
    timing.StartFrame(frame->timestamp);
    frames.AddTiming(&timing);
    {
      const StageTimer::Scope scope(&totals, "estimator");
      feed.Advance(frame->timestamp + ToNanoseconds(imu_horizon_s), &estimator);
    }
    if (!started) {
      const std::optional<InitialCondition> initial = start.Try(*frame);
      if (!initial) {
        recorder.AddWaiting(*frame);
        progress.Update(recorder.summary().frames);
        continue;
      }
      estimator.Initialize(*initial);
      LOG(INFO) << "started at " << initial->state.instant << " ns, after "
                << recorder.summary().waiting << " frames";
      started = true;
    }
    const EstimatorOutput* output = nullptr;
    {
      const StageTimer::Scope scope(&totals, "estimator");
      output = &estimator.ProcessFrame(*frame);
    }
    recorder.Add(*frame, *output);
    timing.Add("estimator", totals.stages().front().cpu_ms);
    timing.Add("estimator", stages.stages());
    progress.Update(recorder.summary().frames);
    if (output->status == EstimatorStatus::kFailed) return LoopOutcome::kFailed;
  }
  estimator.set_stage_timer(nullptr);
  if (Interrupted()) return LoopOutcome::kInterrupted;
  return started ? LoopOutcome::kDone : LoopOutcome::kFailed;
}

}  // namespace duet
