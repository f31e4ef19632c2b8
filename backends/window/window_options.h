#pragma once

namespace duet {

/// Settings of the sliding-window optimizer (backends/window/window_estimator.h).
struct WindowOptions {
  enum class Keyframes { kParallax, kEveryFrame };
  enum class Tracks { kLive, kFinished };
  enum class LiveLandmarks { kSplit, kDrop };
  enum class LandmarkParameters { kFull, kInverseDepthOnly };
  enum class RobustLoss { kNone, kHuber, kCauchy };
  enum class TrustRegion { kDogleg, kLevenbergMarquardt };
  enum class LinearSolver { kDenseSchur, kSparseSchur };

  int max_frames = 11;
  Keyframes keyframes = Keyframes::kParallax;
  double min_parallax_px = 30.0;
  int min_common_tracks = 40;
  double max_keyframe_interval_s = 1.0;

  Tracks tracks = Tracks::kLive;
  LandmarkParameters landmark_parameters = LandmarkParameters::kFull;
  LiveLandmarks live_landmarks = LiveLandmarks::kSplit;
  int frames_kept_from_prior = 2;
  int max_landmarks = 300;
  int min_landmarks = 6;
  double min_parallax_rad = 0.01;
  double min_depth_sigmas = 0.0;

  RobustLoss robust_loss = RobustLoss::kHuber;
  double loss_width_sigmas = 2.5;
  double max_reprojection_sigmas = 5.0;

  int max_iterations = 8;
  double function_tolerance = 1e-4;
  TrustRegion trust_region = TrustRegion::kDogleg;
  LinearSolver linear_solver = LinearSolver::kDenseSchur;
  double reintegration_threshold = 1e-3;
  bool first_estimates = true;

  double max_unaided_s = 1.0;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("max_frames", &max_frames,
            {.doc = "Frames in the window, the newest included.", .min = 3, .max = 64});
    v.Choice("keyframes", &keyframes,
             {{"parallax", Keyframes::kParallax}, {"every_frame", Keyframes::kEveryFrame}},
             {.doc = "Which frames stay: parallax drops the second newest frame while it is close "
                     "to the keyframe before it (VINS-Fusion's rule); every_frame keeps the newest "
                     "max_frames frames, as the filter does."});
    v.Field(
        "min_parallax_px", &min_parallax_px,
        {.doc = "A frame whose tracks moved that far on average since the last keyframe is one.",
         .unit = "px",
         .min = 0});
    v.Field("min_common_tracks", &min_common_tracks,
            {.doc = "A frame that shares fewer tracks with the last keyframe is a keyframe.",
             .min = 0});
    v.Field("max_keyframe_interval_s", &max_keyframe_interval_s,
            {.doc = "A frame is a keyframe where dropping it would leave a longer interval.",
             .unit = "s",
             .min = 0.01,
             .max = 10});
    v.Choice("tracks", &tracks, {{"live", Tracks::kLive}, {"finished", Tracks::kFinished}},
             {.doc = "live: a landmark is used as soon as it is triangulated. finished: only when "
                     "its track has ended or spans the window, as the filter does; with "
                     "keyframes: every_frame and frames_kept_from_prior: 0 both estimators then "
                     "use the same pixels at the same time."});
    v.Choice("landmark_parameters", &landmark_parameters,
             {{"full", LandmarkParameters::kFull},
              {"inverse_depth_only", LandmarkParameters::kInverseDepthOnly}},
             {.doc = "full: alpha, beta, rho are free and the anchor's pixel is a measurement like "
                     "every other. inverse_depth_only: VINS-Fusion's; the anchor's pixel is taken "
                     "as free of noise, which makes it overconfident."});
    v.Choice("live_landmarks", &live_landmarks,
             {{"split", LiveLandmarks::kSplit}, {"drop", LiveLandmarks::kDrop}},
             {.doc = "What becomes of a landmark that is still tracked when the oldest frame that "
                     "saw it leaves: split turns its observations into the prior and goes on with "
                     "a new landmark; drop forgets its observations in that frame only."});
    v.Field("frames_kept_from_prior", &frames_kept_from_prior,
            {.doc = "Observations of live landmarks in this many newest frames stay out of the "
                    "prior: those frames' estimates are still young, and the new landmark starts "
                    "with them.",
             .min = 0,
             .max = 32});
    v.Field("max_landmarks", &max_landmarks,
            {.doc = "Most landmarks in one problem, the longest observed first.", .min = 10});
    v.Field("min_landmarks", &min_landmarks,
            {.doc = "Fewer tracks in a frame, or fewer landmarks in use for max_unaided_s: dead "
                    "reckoning.",
             .min = 0});
    v.Field("min_parallax_rad", &min_parallax_rad,
            {.doc = "A landmark enters the problem when two of its rays differ by this angle.",
             .unit = "rad",
             .min = 1e-6,
             .max = 1});
    v.Field("min_depth_sigmas", &min_depth_sigmas,
            {.doc = "What a landmark says of the poses counts, in the prior and in the covariance, "
                    "once its inverse depth is so many of its standard deviations above zero, with "
                    "the poses and the calibration as uncertain as they are without the landmarks "
                    "at hand; 0: always. 3 keeps pure rotation from overconfidence, but a start "
                    "four times as unsure as the default one then never knows a depth and fails.",
             .min = 0,
             .max = 100});
    v.Choice("robust_loss", &robust_loss,
             {{"none", RobustLoss::kNone},
              {"huber", RobustLoss::kHuber},
              {"cauchy", RobustLoss::kCauchy}},
             {.doc = "Loss on the whitened reprojection error of one observation."});
    v.Field("loss_width_sigmas", &loss_width_sigmas,
            {.doc = "Where the loss leaves the parabola, in standard deviations.", .min = 0.1});
    v.Field("max_reprojection_sigmas", &max_reprojection_sigmas,
            {.doc = "A landmark with an observation further off after the solve ends (5: one in "
                    "270000 of a normal pair); 0 keeps all.",
             .min = 0});
    v.Field("max_iterations", &max_iterations,
            {.doc = "Bound of the solver's iterations.", .min = 1, .max = 1000});
    v.Field("function_tolerance", &function_tolerance,
            {.doc = "The solver stops where an iteration lowers the cost by less than this share.",
             .min = 0,
             .max = 0.1});
    v.Choice("trust_region", &trust_region,
             {{"dogleg", TrustRegion::kDogleg},
              {"levenberg_marquardt", TrustRegion::kLevenbergMarquardt}},
             {.doc = "Trust region method of the solver."});
    v.Choice(
        "linear_solver", &linear_solver,
        {{"dense_schur", LinearSolver::kDenseSchur}, {"sparse_schur", LinearSolver::kSparseSchur}},
        {.doc = "Linear solver; the landmarks are eliminated first in both."});
    v.Field("reintegration_threshold", &reintegration_threshold,
            {.doc = "An IMU delta is integrated again where biases or calibration have moved its "
                    "rotation [rad], velocity [m/s] or position [m] further; the first-order "
                    "correction is wrong by about the square.",
             .min = 0});
    v.Field("first_estimates", &first_estimates,
            {.doc = "Priors and the covariance are linearized at the first estimates of frames."});
    v.Field("max_unaided_s", &max_unaided_s,
            {.doc = "Tracks without parallax (at the start, while hovering) may leave the window "
                    "without landmarks for this long before it counts as dead reckoning.",
             .unit = "s",
             .min = 0});
  }
};

}  // namespace duet
