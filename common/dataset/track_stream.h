#pragma once

#include <cstdint>
#include <vector>

#include "common/support/timestamp.h"

namespace duet {

/// A point in one image: raw, distorted pixels, as written to disk.
struct TrackObservation {
  std::uint64_t track_id = 0;  ///< never reused
  float u = 0.0F;
  float v = 0.0F;
};

/// What one camera saw at one stamp (DESIGN.md section 4), sorted by track id.
struct TrackFrame {
  Timestamp timestamp = 0;
  int camera = 0;
  std::vector<TrackObservation> observations;
};

/// The frames of all cameras at one stamp, in ascending order of camera.
struct TrackFrameSet {
  Timestamp timestamp = 0;
  std::vector<TrackFrame> frames;
};

}  // namespace duet
