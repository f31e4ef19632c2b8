#pragma once

#include <cstdint>
#include <vector>

#include "common/support/random.h"
#include "experiments/simulation/render/render_options.h"
#include "experiments/simulation/render/true_camera.h"

namespace duet {

/// The share of the light that reaches each pixel, by rows: 1 - vignetting (r / r_max)^2, r from
/// the principal point, r_max that of the farthest corner.
[[nodiscard]] std::vector<float> VignettingTable(const CameraModel& model, double vignetting);

/// The gain of a camera over time; depends on nothing but its arguments, so that images can be made
/// in any order. With auto_exposure: the wanted grey over the mean light of what the camera saw
/// within the lag before (a few rays on the textures' means, weights falling by time), within 1 /
/// auto_exposure_max_gain to auto_exposure_max_gain. On top, where asked for, the seeded change:
/// exp(gain_change s(t)) with a sum s of three sines of amplitude about 1.
class GainControl {
 public:
  GainControl(const PhotometryOptions& options, const TrueCamera* camera, int seed);

  [[nodiscard]] double GainAt(int camera, Timestamp stamp) const;

 private:
  [[nodiscard]] double MeanLight(int camera, Timestamp stamp) const;

  PhotometryOptions options_;
  const TrueCamera* camera_;
  int seed_;
  std::vector<double> surface_light_;  ///< mean grey level of each surface
};

/// One row of light to grey levels: rounded(gain light + noise), the noise Gaussian with the
/// variance gain a s + gain^2 b (s: the signal, gain times light), clipped to 0 ... 255. `random`
/// is the row's own.
void QuantizeRow(const PhotometryOptions& options, double gain, const float* light, int count,
                 Random* random, std::uint8_t* grey);

}  // namespace duet
