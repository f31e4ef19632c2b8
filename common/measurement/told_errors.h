#pragma once

#include <cstdint>
#include <vector>

#include "common/measurement/calibration.h"

namespace duet {

/// The rig that an estimator is told where its calibration is to be wrong: told = true (-) e with
/// e drawn from `errors`. A block's errors depend on the seed and on its own numbers only, so that
/// studies with different blocks share them. Numbers that `imu_frame` ties the body's axes to are
/// left as they are (R_CB of the first camera under `camera`; above the diagonal of T_g or T_a
/// under `gyroscope` and `accelerometer`), and so are cameras that are not among `cameras` (empty:
/// all).
[[nodiscard]] RigCalibration DrawToldRig(const RigCalibration& true_rig, const ToldErrors& errors,
                                         ImuFrame imu_frame, const std::vector<int>& cameras,
                                         std::uint64_t seed);

/// The told rig with the offset added. Throws InputError where a list has a wrong length, naming
/// `shared.calibration.told_offset` and its key.
[[nodiscard]] RigCalibration AddToldOffset(const RigCalibration& told_rig,
                                           const ToldOffset& offset);

/// What an estimator is told of a recording with this calibration: with errors drawn and offsets
/// added as `priors` say.
[[nodiscard]] RigCalibration ToldRig(const RigCalibration& rig, const CalibrationPriors& priors);

/// What the priors say of the estimated blocks, as errors to draw; the others as in
/// `priors.told_errors`. For studies in which the told calibration is drawn from the priors.
[[nodiscard]] ToldErrors ToldErrorsOfPriors(const CalibrationPriors& priors);

/// All standard deviations of the priors and of the told errors multiplied by a factor.
[[nodiscard]] CalibrationPriors ScaledPriors(CalibrationPriors priors, double factor);
[[nodiscard]] ToldErrors Scaled(ToldErrors errors, double factor);

}  // namespace duet
