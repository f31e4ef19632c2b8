#pragma once

#include <optional>

#include "experiments/study/study_plan.h"

namespace duet {

/// Refuses a cell of the grid that no estimator could start with, whatever its seed: the setting
/// and the perturbation contradict each other in the gauge (GaugeError), or `told_offset` makes of
/// the stream's own calibration (`rig`; nothing: not known, and not looked at) something that
/// CheckTold refuses, a t_d or t_r beyond its bound, or has the wrong length. What is drawn is not
/// looked at. Throws InputError that names the study's file, the setting or perturbation without
/// which it would not be so, and the stream.
void RequireToldIsPossible(const StudyPlan& plan, const PlannedRun& cell,
                           const std::optional<RigCalibration>& rig);

}  // namespace duet
