#pragma once

#include <opencv2/core/mat.hpp>

#include "experiments/simulation/render/true_camera.h"

namespace duet {

/// Two images of one camera against each other through the true geometry.
struct WarpDifference {
  int compared = 0;       ///< pixels whose point is seen in both, 3 px away from depth edges
  double share = 0.0;     ///< of the pixels looked at
  double rms_grey = 0.0;  ///< of `to` minus `from` at the same points
  double mean_grey = 0.0;
};

/// Where each point of the world is seen in both images they show the same grey level, noise and
/// what filtering differs apart: nothing else is left where the images agree with the geometry.
/// `from` is looked up by cubic interpolation (Catmull-Rom); every `step`-th pixel of every
/// `step`-th row of `to` is looked at. Gain and vignetting have to be the same in both.
[[nodiscard]] WarpDifference CompareByWarp(const TrueCamera& truth, int camera, Timestamp from,
                                           const cv::Mat& from_image, Timestamp to,
                                           const cv::Mat& to_image, int step);

}  // namespace duet
