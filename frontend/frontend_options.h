#pragma once

#include "common/config/options.h"

namespace duet {

/// Settings of the front end (configuration `frontend:`). How many tracks a frame holds comes from
/// the caller (SharedOptions::max_tracks): it concerns the estimators too.
struct FrontendOptions {
  // Detection (thesis 5.3.1).
  int features_per_cell = 3;
  int fast_threshold_min = 7;
  int fast_threshold_max = 80;
  double min_corner_quality = 12.0;
  double min_distance_px = 20.0;
  int border_px = 8;
  int subpixel_half_window_px = 4;
  bool clahe = false;
  double clahe_clip_limit = 3.0;

  // Tracking.
  int klt_half_window_px = 6;
  int klt_levels = 4;
  int klt_iterations = 8;
  double klt_epsilon_px = 0.05;
  double forward_backward_px = 0.5;
  bool gyro_prediction = true;
  bool anchor = true;
  int anchor_half_window_px = 8;
  double anchor_max_shift_px = 1.5;
  double anchor_min_correlation = 0.85;
  int anchor_min_age = 2;

  // Outlier rejection.
  bool outlier_rejection = true;
  int ransac_iterations = 48;
  double outlier_threshold_px = 1.0;
  int outlier_lag = 8;
  double outlier_lag_threshold_px = 1.2;

  // Stereo.
  double stereo_epipolar_px = 1.5;
  double stereo_forward_backward_px = 0.7;
  double stereo_min_depth_m = 0.2;

  // Running.
  int threads = 1;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("features_per_cell", &features_per_cell,
            {.doc = "Tracks that each cell of the detection grid is to hold; the cells' size "
                    "follows from it, max_tracks and the image's size.",
             .min = 1,
             .max = 50});
    v.Field("fast_threshold_min", &fast_threshold_min,
            {.doc = "FAST's threshold never falls below this, however few corners a cell has.",
             .unit = "grey levels",
             .min = 1,
             .max = 254});
    v.Field("fast_threshold_max", &fast_threshold_max,
            {.doc = "FAST's threshold never rises above this.",
             .unit = "grey levels",
             .min = 2,
             .max = 255});
    v.Field("min_corner_quality", &min_corner_quality,
            {.doc = "Smaller eigenvalue of the mean gradient tensor below which a corner is not "
                    "taken: flat or one-directional patches cannot be tracked.",
             .unit = "grey levels^2 / px^2",
             .min = 0});
    v.Field("min_distance_px", &min_distance_px,
            {.doc = "Smallest distance between two tracks; the older one wins.",
             .unit = "px",
             .min = 1,
             .max = 500});
    v.Field("border_px", &border_px,
            {.doc = "Tracks end and corners are not taken this close to the image's edge.",
             .unit = "px",
             .min = 1,
             .max = 200});
    v.Field("subpixel_half_window_px", &subpixel_half_window_px,
            {.doc = "Half the window in which a new corner is refined to subpixels; 0: not at all.",
             .unit = "px",
             .min = 0,
             .max = 20});
    v.Field("clahe", &clahe, {.doc = "Equalize each image's contrast locally before all else."});
    v.Field("clahe_clip_limit", &clahe_clip_limit,
            {.doc = "Limit of the contrast's amplification.", .min = 0.1, .max = 100});
    v.Field("klt_half_window_px", &klt_half_window_px,
            {.doc = "The patch that is tracked is 2 n + 1 pixels wide.",
             .unit = "px",
             .min = 2,
             .max = 30});
    v.Field("klt_levels", &klt_levels,
            {.doc = "Levels of the image pyramid, the image itself included.", .min = 1, .max = 8});
    v.Field("klt_iterations", &klt_iterations,
            {.doc = "Most iterations on a level.", .min = 1, .max = 200});
    v.Field("klt_epsilon_px", &klt_epsilon_px,
            {.doc = "A step shorter than this ends a level.", .unit = "px", .min = 1e-4, .max = 1});
    v.Field("forward_backward_px", &forward_backward_px,
            {.doc = "A point tracked forward and back may miss its start by this much.",
             .unit = "px",
             .min = 0.01,
             .max = 50});
    v.Field("gyro_prediction", &gyro_prediction,
            {.doc = "Start the search where the gyroscope's rotation says."});
    v.Field("anchor", &anchor,
            {.doc = "Correct each track by the patch in which it was first seen, so that errors of "
                    "the flow do not add up."});
    v.Field("anchor_half_window_px", &anchor_half_window_px,
            {.doc = "Radius of that patch.", .unit = "px", .min = 3, .max = 30});
    v.Field("anchor_max_shift_px", &anchor_max_shift_px,
            {.doc = "Largest correction in a frame; a patch that is further off is not the point.",
             .unit = "px",
             .min = 0.05,
             .max = 10});
    v.Field("anchor_min_correlation", &anchor_min_correlation,
            {.doc = "The patch counts as found from this correlation on.", .min = 0, .max = 1});
    v.Field("anchor_min_age", &anchor_min_age,
            {.doc = "A patch that is no longer found is taken anew where the point was last if it "
                    "had served for this long; a younger one ends its track.",
             .unit = "frames",
             .min = 0});
    v.Field("outlier_rejection", &outlier_rejection,
            {.doc = "Drop tracks that contradict the epipolar geometry of two frames."});
    v.Field("ransac_iterations", &ransac_iterations,
            {.doc = "Pairs of tracks that are tried for the direction of translation.",
             .min = 1,
             .max = 10000});
    v.Field(
        "outlier_threshold_px", &outlier_threshold_px,
        {.doc = "Largest distance from the epipolar line.", .unit = "px", .min = 0.05, .max = 50});
    v.Field("outlier_lag", &outlier_lag,
            {.doc = "The same test against the frame this many before, where slow drift shows; 0: "
                    "not at all.",
             .unit = "frames",
             .min = 0,
             .max = 100});
    v.Field("outlier_lag_threshold_px", &outlier_lag_threshold_px,
            {.doc = "Largest distance from the epipolar line in that test.",
             .unit = "px",
             .min = 0.05,
             .max = 50});
    v.Field("stereo_epipolar_px", &stereo_epipolar_px,
            {.doc = "Largest distance from the epipolar line that the told extrinsics give.",
             .unit = "px",
             .min = 0.05,
             .max = 50});
    v.Field("stereo_forward_backward_px", &stereo_forward_backward_px,
            {.doc = "As forward_backward_px, from the first camera to another and back.",
             .unit = "px",
             .min = 0.01,
             .max = 50});
    v.Field("stereo_min_depth_m", &stereo_min_depth_m,
            {.doc = "A stereo match nearer than this is refused.", .unit = "m", .min = 1e-3});
    v.Field("threads", &threads,
            {.doc = "Threads of the image processing; results are the same bytes for any number.",
             .min = 1,
             .max = 64});
  }
};

}  // namespace duet
