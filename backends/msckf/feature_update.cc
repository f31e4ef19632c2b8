#include "backends/msckf/feature_update.h"

#include <algorithm>
#include <type_traits>

#include "backends/msckf/compression.h"
#include "backends/msckf/nullspace.h"
#include "common/support/logging.h"

namespace duet {
namespace {

/// Up to so many rows a column the update is cheaper than to compress first, with H P' from the
/// rows as they are before the projection (counted in multiplications).
constexpr double kMaxUncompressed = 1.4;

/// Rows of the residual after the projection of one landmark, at most.
int MaxDegreesOfFreedom(const EstimatorSetup& setup, const MsckfOptions& options) {
  return 2 * options.max_clones * static_cast<int>(setup.rig.cameras.size());
}

/// Removes the elements for which `refuse` is true (it may change the others), keeping the order.
template <class T, class Refuse>
void KeepUnless(std::vector<T>* elements, const Refuse& refuse) {
  std::size_t kept = 0;
  for (T& element : *elements) {
    if (!refuse(element)) (*elements)[kept++] = element;
  }
  elements->resize(kept);
}

}  // namespace

FeatureUpdate::FeatureUpdate(const EstimatorSetup& setup, const MsckfOptions& options)
    : options_(options),
      settings_{options.first_estimates && !options.rebase_first_estimates,
                setup.shared.pixel_noise_px, setup.g_G},
      gate_(options.gate_probability, MaxDegreesOfFreedom(setup, options)),
      outlier_search_(options.outlier_probability) {
  const int max_observations = options.max_clones * static_cast<int>(setup.rig.cameras.size());
  in_states_.reserve(max_observations);
  observations_.reserve(max_observations * options.max_landmarks_per_update);
  candidates_.reserve(options.max_landmarks_per_update);
}

void FeatureUpdate::SelectFinishedTracks(const FilterState& state, bool window_full,
                                         FeatureTracks* tracks, FeatureCounts* counts) {
  candidates_.clear();
  const std::uint64_t oldest = state.clones().front().id;
  for (int i = 0; i < tracks->size(); ++i) {
    const FeatureTrack& track = (*tracks)[i];
    if (!track.alive) ++counts->lost;
    if (track.observations.empty()) continue;
    const bool enough = static_cast<int>(track.observations.size()) >= options_.min_observations;
    const bool spans = window_full && track.observations.front().clone_id == oldest;
    if (!track.alive && !enough) ++counts->too_short;
    if (enough && (!track.alive || spans)) candidates_.emplace_back().track = i;
  }
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [&](const Candidate& a, const Candidate& b) {
                     const FeatureTrack& track_a = (*tracks)[a.track];
                     const FeatureTrack& track_b = (*tracks)[b.track];
                     if (track_a.alive != track_b.alive) return track_b.alive;
                     return track_a.observations.size() > track_b.observations.size();
                   });
  const auto limit = static_cast<std::size_t>(options_.max_landmarks_per_update);
  if (candidates_.size() > limit) candidates_.resize(limit);
}

void FeatureUpdate::GatherObservations(const FilterState& state, const FeatureTrack& track,
                                       Candidate* candidate) {
  candidate->first_observation = static_cast<int>(observations_.size());
  candidate->observation_count = static_cast<int>(track.observations.size());
  for (const ClonedObservation& o : track.observations) {
    observations_.push_back({state.CloneIndex(o.clone_id), {o.camera, Eigen::Vector2d(o.u, o.v)}});
  }
}

std::span<CloneObservation> FeatureUpdate::ObservationsOf(const Candidate& candidate) {
  return std::span<CloneObservation>(observations_)
      .subspan(candidate.first_observation, candidate.observation_count);
}

TriangulationStatus FeatureUpdate::TriangulateOne(const FilterState& state, Candidate* candidate) {
  const bool time_matters = state.time_matters();
  in_states_.clear();
  for (const CloneObservation& o : ObservationsOf(*candidate)) {
    const Clone& clone = state.clones()[o.clone];
    in_states_.push_back(
        {{clone.nav, clone.t_d_at_instant_s, time_matters ? &clone.rates : nullptr}, o.pixel});
  }
  candidate->anchor_clone = observations_[candidate->first_observation].clone;
  const Pose anchor = state.clones()[candidate->anchor_clone].nav.pose();
  return duet::Triangulate(state.rig(), in_states_, anchor, settings_.g_G, triangulation_,
                           &candidate->landmark);
}

bool FeatureUpdate::LinearizeOne(const FilterState& state, const Candidate& candidate) {
  const int count = 2 * candidate.observation_count;
  return LinearizeLandmark(state, columns_, settings_, candidate.anchor_clone, candidate.landmark,
                           ObservationsOf(candidate), H_f_.middleRows(candidate.first_row, count),
                           rows_.middleRows(candidate.first_row, count));
}

/// True where the pixels fix the depth: the inverse depth is min_depth_sigmas of its standard
/// deviation (from the pixels' noise alone, H_f whitened) above zero.
bool FeatureUpdate::HasDepth(const Candidate& candidate) {
  const auto H_f = H_f_.middleRows(candidate.first_row, 2 * candidate.observation_count);
  const Eigen::Matrix3d covariance = (H_f.transpose() * H_f).inverse();
  const double rho = candidate.landmark.z();
  return rho > 0.0 &&
         rho * rho > options_.min_depth_sigmas * options_.min_depth_sigmas * covariance(2, 2);
}

void FeatureUpdate::MultiplyOne(const FilterState& state, const Candidate& candidate) {
  const int count = 2 * candidate.observation_count;
  const int size = state.clone_size();
  const auto rows = rows_.middleRows(candidate.first_row, count);
  // As columns of P H', which lie next to one another.
  const Eigen::Ref<const Eigen::MatrixXd> P = state.P();
  const auto n = P.rows();
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> P_H(&HP_(candidate.first_row, 0), n, count,
                                                           Eigen::OuterStride<>(HP_.cols()));
  const int anchor = candidate.anchor_clone;
  H_columns_ = rows.middleCols(columns_.CloneColumn(anchor), size).transpose();
  P_H.noalias() = P.middleCols(state.CloneOffset(anchor), size) * H_columns_;
  const int calibration = columns_.CloneColumn(static_cast<int>(state.clones().size()));
  if (const int width = columns_.width() - calibration; width > 0) {
    H_columns_ = rows.middleCols(calibration, width).transpose();
    P_H.noalias() += P.middleCols(columns_.components()[calibration], width) * H_columns_;
  }
  const std::span<const CloneObservation> observations = ObservationsOf(candidate);
  for (int k = 0; k < candidate.observation_count; ++k) {
    const int clone = observations[k].clone;
    if (clone == anchor) continue;
    const auto add = [&]<int kSize>(std::integral_constant<int, kSize>) {
      const Eigen::Matrix<double, kSize, 2> H_k =
          rows.block<2, kSize>(2 * k, columns_.CloneColumn(clone)).transpose();
      P_H.middleCols<2>(2 * k) += P.middleCols<kSize>(state.CloneOffset(clone)).lazyProduct(H_k);
    };
    if (size == 9) {
      add(std::integral_constant<int, 9>());
    } else {
      add(std::integral_constant<int, 6>());
    }
  }
}

bool FeatureUpdate::HasSecondOrderNoise(const FilterState& state, const Candidate& candidate) {
  if (options_.second_order_landmarks == 0) return false;
  const int count = 2 * candidate.observation_count;
  const int first = columns_.CloneColumn(candidate.anchor_clone);
  const int width = columns_.width() - first;
  const auto H = rows_.block(candidate.first_row, first, count, width);
  const auto P = MeasuredCovariance(state).bottomRightCorner(width, width);
  const double rho = candidate.landmark.z();
  second_order_.SetDepth(H, H_f_.middleRows(candidate.first_row, count), P);
  if (!second_order_.Matters(rho, options_.second_order_landmarks)) return false;
  H_f_at_infinity_.resize(count, 3);
  rows_at_infinity_.resize(count, rows_.cols());
  const InverseDepth at_infinity(candidate.landmark.x(), candidate.landmark.y(), 0.0);
  if (!LinearizeLandmark(state, columns_, settings_, candidate.anchor_clone, at_infinity,
                         ObservationsOf(candidate), H_f_at_infinity_, rows_at_infinity_)) {
    return false;
  }
  return second_order_.SetDerivative(H, rows_at_infinity_.middleCols(first, width), rho, P,
                                     options_.second_order_landmarks);
}

void FeatureUpdate::WhitenOne(Candidate* candidate) {
  const int count = 2 * candidate->observation_count;
  candidate->noise_factor = noise_factor_count_++;
  if (noise_factor_count_ > static_cast<int>(noise_factors_.size())) noise_factors_.emplace_back();
  Eigen::MatrixXd& factor = noise_factors_[candidate->noise_factor];
  factor = second_order_.factor();
  const auto L = factor.triangularView<Eigen::Lower>();
  auto H_f = H_f_.middleRows(candidate->first_row, count);
  auto rows = rows_.middleRows(candidate->first_row, count);
  L.solveInPlace(H_f);
  L.solveInPlace(rows);
  if (!product_known_) return;
  auto HP = HP_.middleRows(candidate->first_row, count);
  L.solveInPlace(HP);
}

void FeatureUpdate::ProjectOne(const FilterState& state, Candidate* candidate) {
  const int count = 2 * candidate->observation_count;
  if (product_known_) MultiplyOne(state, *candidate);
  candidate->noise_factor = -1;
  if (HasSecondOrderNoise(state, *candidate)) WhitenOne(candidate);
  const auto H_f = H_f_.middleRows(candidate->first_row, count);
  // The anchor is the oldest clone that saw the landmark: columns before it are zero.
  duet::ProjectNullspace(H_f, rows_.middleRows(candidate->first_row, count),
                         columns_.CloneColumn(candidate->anchor_clone), columns_.width());
  if (product_known_) ApplyProjection(H_f, HP_.middleRows(candidate->first_row, count));
}

void FeatureUpdate::Triangulate(const FilterState& state, FeatureTracks* tracks,
                                FeatureCounts* counts) {
  observations_.clear();
  KeepUnless(&candidates_, [&](Candidate& candidate) {
    GatherObservations(state, (*tracks)[candidate.track], &candidate);
    const TriangulationStatus status = TriangulateOne(state, &candidate);
    if (status == TriangulationStatus::kOk) return false;
    ++counts->not_triangulated;
    if (status == TriangulationStatus::kLargeResidual) tracks->Consume(candidate.track);
    observations_.resize(candidate.first_observation);
    return true;
  });
}

void FeatureUpdate::Linearize(const FilterState& state, FeatureTracks* tracks,
                              FeatureCounts* counts) {
  columns_.Assign(state);
  P_measured_known_ = false;
  noise_factor_count_ = 0;
  const int width = columns_.width() + 1;
  const auto row_count = static_cast<Eigen::Index>(2 * observations_.size());
  if (H_f_.rows() < row_count) H_f_.resize(row_count, 3);
  if (rows_.rows() < row_count || rows_.cols() != width) {
    rows_.resize(std::max(row_count, rows_.rows()), width);
  }
  int row = 0;
  KeepUnless(&candidates_, [&](Candidate& candidate) {
    candidate.first_row = row;
    const bool ok = LinearizeOne(state, candidate);
    if (!ok) tracks->Consume(candidate.track);
    if (!ok || !HasDepth(candidate)) {
      ++counts->not_triangulated;
      return true;
    }
    row += 2 * candidate.observation_count;
    return false;
  });
}

void FeatureUpdate::ProjectNullspace(const FilterState& state) {
  int row_count = 0;
  for (const Candidate& candidate : candidates_) row_count += 2 * candidate.observation_count - 3;
  product_known_ = row_count <= kMaxUncompressed * columns_.width();
  if (product_known_ && (HP_.rows() < rows_.rows() || HP_.cols() != state.size())) {
    HP_.resize(std::max(rows_.rows(), HP_.rows()), state.size());
  }
  for (Candidate& candidate : candidates_) ProjectOne(state, &candidate);
}

const Eigen::MatrixXd& FeatureUpdate::MeasuredCovariance(const FilterState& state) {
  if (P_measured_known_) return P_measured_;
  const Eigen::Ref<const Eigen::MatrixXd> P = state.P();
  const std::span<const int> components = columns_.components();
  const int width = columns_.width();
  P_measured_.resize(width, width);
  for (int j = 0; j < width; ++j) {
    for (int i = 0; i < width; ++i) P_measured_(i, j) = P(components[i], components[j]);
  }
  P_measured_known_ = true;
  return P_measured_;
}

bool FeatureUpdate::PassesGate(const FilterState& state, const Candidate& candidate) {
  const int width = columns_.width();
  const int first = columns_.CloneColumn(candidate.anchor_clone);
  const int count = 2 * candidate.observation_count - 3;
  const auto block = rows_.middleRows(candidate.first_row + 3, count);
  const auto H = block.middleCols(first, width - first);
  const auto r = block.col(width);
  if (!product_known_) {
    return gate_.Passes(H, r,
                        MeasuredCovariance(state).bottomRightCorner(width - first, width - first));
  }
  if (gate_.PassesAtOnce(r)) return true;
  const std::span<const int> components = columns_.components();
  const auto HP = HP_.middleRows(candidate.first_row + 3, count);
  HP_measured_.resize(count, width - first);
  for (int j = first; j < width; ++j) HP_measured_.col(j - first) = HP.col(components[j]);
  return gate_.PassesOfKnownProduct(HP_measured_, H, r);
}

bool FeatureUpdate::RemoveOutliers(const FilterState& state, Candidate* candidate) {
  const int width = columns_.width();
  const int first = columns_.CloneColumn(candidate->anchor_clone);
  const int count = candidate->observation_count;
  const auto block = rows_.middleRows(candidate->first_row + 3, 2 * count - 3);
  if (!outlier_search_.Find(
          H_f_.middleRows(candidate->first_row, 2 * count), block.middleCols(first, width - first),
          block.col(width),
          MeasuredCovariance(state).bottomRightCorner(width - first, width - first), gate_,
          candidate->noise_factor < 0 ? nullptr : &noise_factors_[candidate->noise_factor],
          std::min(count / 4, count - options_.min_observations), &outliers_)) {
    return false;
  }
  const std::span<CloneObservation> observations = ObservationsOf(*candidate);
  auto next_outlier = outliers_.begin();
  int kept = 0;
  for (int k = 0; k < count; ++k) {
    if (next_outlier != outliers_.end() && *next_outlier == k) {
      ++next_outlier;
    } else {
      observations[kept++] = observations[k];
    }
  }
  candidate->observation_count = kept;
  if (TriangulateOne(state, candidate) != TriangulationStatus::kOk ||
      !LinearizeOne(state, *candidate) || !HasDepth(*candidate)) {
    return false;
  }
  ProjectOne(state, candidate);
  return true;
}

void FeatureUpdate::Gate(const FilterState& state, FeatureTracks* tracks, FeatureCounts* counts) {
  KeepUnless(&candidates_, [&](Candidate& candidate) {
    tracks->Consume(candidate.track);
    bool passes = !options_.gate || PassesGate(state, candidate);
    if (!passes && options_.remove_outliers) {
      passes = RemoveOutliers(state, &candidate) && PassesGate(state, candidate);
      if (passes) ++counts->cleaned;
    }
    ++(passes ? counts->used : counts->gated);
    return !passes;
  });
}

Eigen::Ref<const Eigen::MatrixXd> FeatureUpdate::Compress() {
  Eigen::Index row_count = 0;
  for (const Candidate& candidate : candidates_) row_count += 2 * candidate.observation_count - 3;
  stack_.resize(row_count, columns_.width() + 1);
  Eigen::Index row = 0;
  for (const Candidate& candidate : candidates_) {
    const int count = 2 * candidate.observation_count - 3;
    stack_.middleRows(row, count) = rows_.middleRows(candidate.first_row + 3, count);
    row += count;
  }
  shape_ = MeasurementShape::kFull;
  if (product_known_) return stack_;
  const int remaining = duet::Compress(stack_);
  if (remaining < row_count) shape_ = MeasurementShape::kUpperTriangular;
  return stack_.topRows(remaining);
}

bool FeatureUpdate::TakeProduct(Eigen::MatrixXd* P_H) const {
  if (!product_known_) return false;
  P_H->resize(HP_.cols(), stack_.rows());
  Eigen::Index column = 0;
  for (const Candidate& candidate : candidates_) {
    const int count = 2 * candidate.observation_count - 3;
    P_H->middleCols(column, count) = HP_.middleRows(candidate.first_row + 3, count).transpose();
    column += count;
  }
  return true;
}

}  // namespace duet
