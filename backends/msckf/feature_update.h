#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "backends/estimator.h"
#include "backends/msckf/feature_tracks.h"
#include "backends/msckf/filter_state.h"
#include "backends/msckf/gate.h"
#include "backends/msckf/kalman_update.h"
#include "backends/msckf/linearization.h"
#include "backends/msckf/msckf_options.h"
#include "backends/msckf/outlier_search.h"
#include "backends/msckf/second_order_noise.h"
#include "common/measurement/triangulation.h"

namespace duet {

/// One frame's visual measurements, from the tracks that are due to the compressed stack that the
/// Kalman update takes (thesis 6.5). The stages are called in order, each works on what the one
/// before left; memory is kept from frame to frame.
class FeatureUpdate {
 public:
  FeatureUpdate(const EstimatorSetup& setup, const MsckfOptions& options);

  /// Chooses the tracks that are due: those that ended with enough observations and, where
  /// `window_full`, those whose observations reach back to the oldest clone, which is about to be
  /// dropped. At most max_landmarks_per_update, ended ones first, longest first.
  void SelectFinishedTracks(const FilterState& state, bool window_full, FeatureTracks* tracks,
                            FeatureCounts* counts);

  /// 5.1, 5.4: the landmarks, anchored in the oldest clone that saw them. A track whose pixels do
  /// not fit one point is refused and its observations with it; one that has no depth yet (too
  /// little parallax) keeps what the window keeps of them.
  void Triangulate(const FilterState& state, FeatureTracks* tracks, FeatureCounts* counts);

  /// 6.5.1: Jacobians and residuals of all landmarks, one block of rows each. Leaves out, as
  /// Triangulate does, those without depth: where nothing moves, a depth is made of the pixels'
  /// noise, and what follows from it is wrong and overconfident.
  void Linearize(const FilterState& state, FeatureTracks* tracks, FeatureCounts* counts);

  /// 6.5.2: three rows a landmark go. Before it a row has few entries (the anchor, the observing
  /// clone, the calibration), after it many: so where Compress will leave the rows as they are, P
  /// H' is made of them here, and projected with them.
  void ProjectNullspace(const FilterState& state);

  /// 6.5.3: refuses landmarks by the chi-squared test; one that fails because of single pixels is
  /// used without them (MsckfOptions::remove_outliers). Uses up the observations of both kinds.
  void Gate(const FilterState& state, FeatureTracks* tracks, FeatureCounts* counts);

  /// 6.30 to 6.32: the measurements that remain, [H | r] of unit noise; no rows where there are
  /// none. Valid until the next call. Not compressed are stacks that have hardly more rows than
  /// columns: there the update itself is cheaper.
  [[nodiscard]] Eigen::Ref<const Eigen::MatrixXd> Compress();

  /// Where P H' of what Compress returned is known: writes it, as long as P has not changed since
  /// ProjectNullspace. Else false.
  [[nodiscard]] bool TakeProduct(Eigen::MatrixXd* P_H) const;

  /// Of what Compress returned.
  [[nodiscard]] MeasurementShape shape() const { return shape_; }
  /// What the columns of the stack act on.
  [[nodiscard]] const VisualColumns& columns() const { return columns_; }

 private:
  /// A landmark of this frame's update.
  struct Candidate {
    int track = 0;              // index into FeatureTracks
    int first_observation = 0;  // into observations_
    int observation_count = 0;
    int first_row = 0;  // into rows_ and H_f_
    int anchor_clone = 0;
    int noise_factor = -1;  // into noise_factors_, where it has noise of second order
    InverseDepth landmark = InverseDepth::Zero();
  };

  void GatherObservations(const FilterState& state, const FeatureTrack& track,
                          Candidate* candidate);
  [[nodiscard]] std::span<CloneObservation> ObservationsOf(const Candidate& candidate);
  /// The steps of one landmark. `observations_` and `first_row` are given.
  [[nodiscard]] TriangulationStatus TriangulateOne(const FilterState& state, Candidate* candidate);
  [[nodiscard]] bool LinearizeOne(const FilterState& state, const Candidate& candidate);
  [[nodiscard]] bool HasDepth(const Candidate& candidate);
  void ProjectOne(const FilterState& state, Candidate* candidate);
  /// The noise of second order of a landmark's rows before the projection (second_order_noise.h),
  /// into second_order_. False where it is too small to matter.
  [[nodiscard]] bool HasSecondOrderNoise(const FilterState& state, const Candidate& candidate);
  /// Makes the landmark's rows of unit variance where they have noise of second order.
  void WhitenOne(Candidate* candidate);
  /// H P of a landmark's rows before the projection, into HP_.
  void MultiplyOne(const FilterState& state, const Candidate& candidate);
  [[nodiscard]] bool PassesGate(const FilterState& state, const Candidate& candidate);
  /// The covariance of the measured components; gathered when first asked for in a frame.
  [[nodiscard]] const Eigen::MatrixXd& MeasuredCovariance(const FilterState& state);
  /// Leaves out what contradicts the rest and takes the landmark through the steps once more, up to
  /// the projection. False where that is not possible.
  [[nodiscard]] bool RemoveOutliers(const FilterState& state, Candidate* candidate);

  MsckfOptions options_;
  LinearizationSettings settings_;
  TriangulationOptions triangulation_;
  ChiSquaredGate gate_;
  OutlierSearch outlier_search_;
  VisualColumns columns_;

  std::vector<Candidate> candidates_;
  std::vector<CloneObservation> observations_;
  std::vector<TrackObservationInState> in_states_;  // one landmark's
  LandmarkRows H_f_;
  MeasurementRows rows_;
  bool product_known_ = false;
  MeasurementRows HP_;             // beside rows_, where the product is known
  Eigen::MatrixXd H_columns_;      // scratch
  SecondOrderNoise second_order_;  // one landmark's
  std::vector<Eigen::MatrixXd> noise_factors_;
  int noise_factor_count_ = 0;
  LandmarkRows H_f_at_infinity_;  // scratch
  MeasurementRows rows_at_infinity_;
  std::vector<int> outliers_;   // of one landmark
  Eigen::MatrixXd P_measured_;  // covariance of the measured components
  bool P_measured_known_ = false;
  Eigen::MatrixXd HP_measured_;  // scratch
  Eigen::MatrixXd stack_;
  MeasurementShape shape_ = MeasurementShape::kFull;
};

}  // namespace duet
