#pragma once

namespace duet {

/// The filter's own settings (thesis chapter 6). What it shares with the window is in
/// SharedOptions.
struct MsckfOptions {
  /// How the error is taken over an IMU interval: by the shared ImuDelta, or with the thesis's
  /// trapezoids in its place (trapezoid_delta.h).
  enum class TransitionRule { kDelta, kThesisTrapezoid };

  int max_clones = 20;
  bool first_estimates = true;
  bool rebase_first_estimates = true;
  int min_observations = 4;
  int second_order_landmarks = 30;
  double min_depth_sigmas = 3.0;
  int max_landmarks_per_update = 30;
  bool gate = true;
  double gate_probability = 0.95;
  bool remove_outliers = true;
  double outlier_probability = 0.9999;
  int dead_reckoning_after_frames = 20;
  TransitionRule transition = TransitionRule::kDelta;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("max_clones", &max_clones,
            {.doc = "Poses in the sliding window, the newest frame's included (m of 6.2.2).",
             .min = 3,
             .max = 100});
    v.Field("first_estimates", &first_estimates,
            {.doc = "Evaluate Jacobians at the first estimates of every frame's orientation, "
                    "position and velocity: the filter then keeps its four unobservable directions "
                    "(position and heading) and does not become overconfident in them."});
    v.Field(
        "rebase_first_estimates", &rebase_first_estimates,
        {.doc = "With first_estimates: after each update take the corrected values as first "
                "estimates and carry the covariance along, so that its unobservable directions "
                "stay exactly what they were. false keeps the values of the moment when a state "
                "was made: an inexact start then makes the first window's Jacobians wrong for "
                "good (room_easy, 10 seeds: mean NEES of the pose 22 instead of 6)."});
    v.Field("min_observations", &min_observations,
            {.doc = "A track that ended with fewer observations (all cameras) is not used.",
             .min = 2,
             .max = 100});
    v.Field(
        "max_landmarks_per_update", &max_landmarks_per_update,
        {.doc = "Most landmarks in one frame's update. Tracks that ended come first, then those "
                "that span the window, longest first; of the others that span the window only "
                "the oldest observation is lost.",
         .min = 1,
         .max = 2000});
    v.Field(
        "second_order_landmarks", &second_order_landmarks,
        {.doc = "What linearizing a landmark leaves out, its depth's error times those of poses "
                "and calibration, is noise as large as if so many landmarks shared it; 0: none, "
                "and the filter is overconfident where the motion hardly fixes depths.",
         .min = 0,
         .max = 1000});
    v.Field("min_depth_sigmas", &min_depth_sigmas,
            {.doc = "A landmark is used where its inverse depth is so many of its standard "
                    "deviations away from zero; without, hovering makes the filter overconfident "
                    "(hover, 10 seeds: mean NEES of the pose 25 instead of 6).",
             .min = 0,
             .max = 100});
    v.Field("gate", &gate, {.doc = "Refuse landmarks by the chi-squared test (6.24 to 6.26)."});
    v.Field("gate_probability", &gate_probability,
            {.doc = "Share of good landmarks that the chi-squared test lets pass.",
             .min = 0.5,
             .max = 0.999999});
    v.Field("remove_outliers", &remove_outliers,
            {.doc = "Where the gate refuses a landmark, leave out those of its pixels (at most a "
                    "quarter) that contradict the others, and test it once more. One bad pixel "
                    "costs the filter a whole track otherwise (outliers, 20 seeds: 6 % of the "
                    "landmarks refused instead of 32 %, position error 0.0083 m instead of 0.0092 "
                    "m, NEES as it should be in both)."});
    v.Field("outlier_probability", &outlier_probability,
            {.doc = "Share of good pixels that the test of remove_outliers keeps.",
             .min = 0.9,
             .max = 0.99999999});
    v.Field("dead_reckoning_after_frames", &dead_reckoning_after_frames,
            {.doc = "So many frames without an update are reported as dead reckoning.",
             .unit = "frames",
             .min = 1,
             .max = 1e6});
    v.Choice(
        "transition", &transition,
        {{"delta", TransitionRule::kDelta}, {"thesis_trapezoid", TransitionRule::kThesisTrapezoid}},
        {.doc = "Phi, Gamma and Q of an IMU interval: delta takes the Jacobians and the "
                "covariance of the IMU delta, which the window uses too (fourth order in the "
                "step); thesis_trapezoid those of the thesis's trapezoids (B.49 to B.63, "
                "composed over the readings, errata corrected), to show what they cost "
                "(docs/equations.md). The state itself goes the same way in both."});
  }
};

}  // namespace duet
