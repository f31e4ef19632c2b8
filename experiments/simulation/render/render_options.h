#pragma once

#include "common/config/options.h"

namespace duet {

/// How carefully an image is sampled; RenderSamplingOf gives the numbers.
enum class RenderQuality { kFast, kAccurate };

/// Numbers behind a quality. Geometry is equally exact in both.
struct RenderSampling {
  int edge_samples;            ///< in a pixel in which surfaces meet
  bool four_samples;           ///< of a texture a pixel (TextureSampler::OverByFour), else one
  int max_probes;              ///< along a stretched footprint in a texture, a sample
  double blur_samples_per_px;  ///< instants within the exposure, per pixel of motion
  int max_blur_samples;
};

[[nodiscard]] inline RenderSampling RenderSamplingOf(RenderQuality quality) {
  if (quality == RenderQuality::kFast) {
    return {.edge_samples = 13,
            .four_samples = false,
            .max_probes = 2,
            .blur_samples_per_px = 0.75,
            .max_blur_samples = 8};
  }
  return {.edge_samples = 55,
          .four_samples = true,
          .max_probes = 8,
          .blur_samples_per_px = 1.5,
          .max_blur_samples = 48};
}

/// From the light of a surface to a grey level (Photometry).
struct PhotometryOptions {
  double light = 1.0;
  double gain = 1.0;
  double gain_change = 0.0;
  double gain_period_s = 6.0;
  bool auto_exposure = false;
  double auto_exposure_grey = 110.0;
  double auto_exposure_lag_s = 0.3;
  double auto_exposure_max_gain = 8.0;
  double vignetting = 0.15;
  double noise_per_grey = 0.01;
  double noise_floor = 0.5;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("light", &light,
            {.doc = "Multiplies the light of the whole scene: 1 by day, 0.1 in the dark.",
             .unit = "1",
             .min = 0,
             .max = 10});
    v.Field("gain", &gain,
            {.doc = "Grey levels per unit of light, the noise's too.",
             .unit = "1",
             .min = 1e-3,
             .max = 100});
    v.Field("gain_change", &gain_change,
            {.doc = "The gain goes smoothly up and down by about this share, by the seed.",
             .unit = "1",
             .min = 0,
             .max = 2});
    v.Field("gain_period_s", &gain_period_s,
            {.doc = "Period of the slowest of the gain's changes; the fastest has a third of it.",
             .unit = "s",
             .min = 0.1,
             .max = 1000});
    v.Field("auto_exposure", &auto_exposure,
            {.doc = "The gain follows the light of what was seen shortly before, in place of "
                    "`gain`."});
    v.Field("auto_exposure_grey", &auto_exposure_grey,
            {.doc = "Mean grey level that auto_exposure aims at.",
             .unit = "grey levels",
             .min = 1,
             .max = 255});
    v.Field("auto_exposure_lag_s", &auto_exposure_lag_s,
            {.doc = "Time within which auto_exposure comes after a change of the light.",
             .unit = "s",
             .min = 0,
             .max = 10});
    v.Field("auto_exposure_max_gain", &auto_exposure_max_gain,
            {.doc = "auto_exposure stays between 1 over this and this.",
             .unit = "1",
             .min = 1,
             .max = 100});
    v.Field("vignetting", &vignetting,
            {.doc = "Share of the light that is missing in the corner farthest from the principal "
                    "point; grows with the square of the distance from it.",
             .unit = "1",
             .min = 0,
             .max = 1});
    v.Field("noise_per_grey", &noise_per_grey,
            {.doc = "Shot noise: variance per grey level of signal, at gain 1.",
             .unit = "grey levels",
             .min = 0,
             .max = 100});
    v.Field("noise_floor", &noise_floor,
            {.doc = "Read noise: variance in the dark, at gain 1.",
             .unit = "grey levels^2",
             .min = 0,
             .max = 10000});
  }
};

/// How the images of a simulation are made.
struct RenderOptions {
  RenderQuality quality = RenderQuality::kFast;
  double exposure_s = 0.004;
  int seed = 1;
  int threads = 1;
  PhotometryOptions photometry;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Choice("quality", &quality,
             {{"fast", RenderQuality::kFast}, {"accurate", RenderQuality::kAccurate}},
             {.doc = "fast: for many images; accurate: many more samples in edges, stretched "
                     "textures and motion blur, for measuring."});
    v.Field("exposure_s", &exposure_s,
            {.doc = "Exposure of a row, centred on its instant; 0: no motion blur.",
             .unit = "s",
             .min = 0,
             .max = 0.1});
    v.Field("seed", &seed, {.doc = "Seed of noise and gain.", .min = 0, .max = 2e9});
    v.Field("threads", &threads,
            {.doc = "Threads that render an image; any number gives the same image.",
             .min = 1,
             .max = 64});
    v.Group("photometry", &photometry, "From light to grey levels.");
  }
};

}  // namespace duet
