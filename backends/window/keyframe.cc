#include "backends/window/keyframe.h"

namespace duet {

MeanMotion MeanPixelMotion(const std::vector<Landmark>& landmarks, int frame_a, int frame_b) {
  MeanMotion motion;
  double sum_px = 0.0;
  for (const Landmark& landmark : landmarks) {
    for (const LandmarkObservation& a : landmark.observations) {
      if (a.frame != frame_a) continue;
      for (const LandmarkObservation& b : landmark.observations) {
        if (b.frame != frame_b || b.pixel.camera != a.pixel.camera) continue;
        sum_px += (a.pixel.uv - b.pixel.uv).norm();
        ++motion.tracks;
      }
    }
  }
  if (motion.tracks > 0) motion.mean_px = sum_px / motion.tracks;
  return motion;
}

}  // namespace duet
