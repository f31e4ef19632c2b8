#pragma once

#include <vector>

#include "common/dataset/track_stream.h"
#include "common/measurement/calibration.h"
#include "experiments/check/finding.h"

namespace duet {

/// Calibration that can't be right: field of view, principal point, distortion that folds over,
/// where the cameras sit on the IMU and against one another, time offset and readout.
[[nodiscard]] Findings CheckCalibration(const RigCalibration& rig,
                                        const std::vector<int>& camera_numbers);

/// Tracks: number, length, pixels far outside the image, ids that came again.
[[nodiscard]] Findings CheckTracks(const std::vector<TrackFrameSet>& frames,
                                   const RigCalibration& rig, long renamed_ids);

}  // namespace duet
