#pragma once

#include "common/measurement/calibration.h"

namespace duet {

/// Refuses what no estimator can do anything with: cameras in `priors.cameras` that the rig does
/// not have (nothing of them would be estimated), and, as the reader of a recording does, told
/// focal lengths that are not above 0 px and told T_g or T_a without an inverse. `told` is the rig
/// with errors drawn and offsets added. Throws InputError that names the key below
/// `shared.calibration` that made it so.
void CheckTold(const RigCalibration& told, const CalibrationPriors& priors);

}  // namespace duet
