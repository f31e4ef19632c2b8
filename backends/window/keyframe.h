#pragma once

#include <vector>

#include "backends/window/window_state.h"

namespace duet {

/// How far tracks moved in the images between two frames of the window.
struct MeanMotion {
  int tracks = 0;        ///< seen in both frames by the same camera; each camera counts
  double mean_px = 0.0;  ///< 0 without tracks
};

/// VINS-Fusion's measure of parallax: the mean distance of a track's pixels in the two frames,
/// rotation included (turning away loses tracks too).
[[nodiscard]] MeanMotion MeanPixelMotion(const std::vector<Landmark>& landmarks, int frame_a,
                                         int frame_b);

}  // namespace duet
