#include "backends/msckf/linearization.h"

#include "common/support/logging.h"

namespace duet {
namespace {

/// The rows of one observation.
using TwoRowsRef =
    Eigen::Ref<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;

ObservingState Observing(const Clone& clone, const NavState& nav, bool time_matters) {
  return {nav, clone.t_d_at_instant_s, time_matters ? &clone.rates : nullptr};
}

/// Adds a camera's p_CB and R_CB columns.
void AddExtrinsics(const CalibrationLayout& layout, const VisualColumns& columns, int camera,
                   const Eigen::Matrix<double, 2, 6>& J, double weight, TwoRowsRef rows) {
  const int p = columns.CalibrationColumn(layout, CalibrationBlock::kExtrinsicTranslation, camera);
  if (p >= 0) rows.middleCols<3>(p) += weight * J.leftCols<3>();
  const int R = columns.CalibrationColumn(layout, CalibrationBlock::kExtrinsicRotation, camera);
  if (R >= 0) rows.middleCols<3>(R) += weight * J.rightCols<3>();
}

/// Adds all calibration columns of one observation.
void AddCalibration(const FilterState& state, const VisualColumns& columns, int camera,
                    const ObservationJacobians& J, double weight, TwoRowsRef rows) {
  const CalibrationLayout& layout = state.layout();
  if (layout.size() == 0) return;
  AddExtrinsics(layout, columns, 0, J.anchor_extrinsics, weight, rows);
  AddExtrinsics(layout, columns, camera, J.extrinsics, weight, rows);
  const int intrinsics = columns.CalibrationColumn(layout, CalibrationBlock::kIntrinsics, camera);
  if (intrinsics >= 0) {
    rows.middleCols<CameraModel::kPinholeParameters>(intrinsics) +=
        weight * J.parameters.leftCols<CameraModel::kPinholeParameters>();
  }
  const int distortion = columns.CalibrationColumn(layout, CalibrationBlock::kDistortion, camera);
  if (distortion >= 0) {
    const int count = state.rig().cameras[camera].model.distortion_count();
    rows.middleCols(distortion, count) +=
        weight * J.parameters.middleCols(CameraModel::kPinholeParameters, count);
  }
  const int t_d = columns.CalibrationColumn(layout, CalibrationBlock::kTimeOffset);
  if (t_d >= 0) rows.col(t_d) += weight * J.t_d;
  const int t_r = columns.CalibrationColumn(layout, CalibrationBlock::kReadoutTime);
  if (t_r >= 0) rows.col(t_r) += weight * J.t_r;
}

}  // namespace

void VisualColumns::Assign(const FilterState& state) {
  clone_size_ = state.clone_size();
  components_.clear();
  for (int i = state.CloneOffset(0); i < state.size(); ++i) components_.push_back(i);
  first_calibration_column_ = width();
  first_calibration_offset_ = state.layout().size();
  for (const CalibrationLayout::Entry& entry : state.layout().entries()) {
    if (IsImuBlock(entry.block)) continue;  // no pixel measures it
    first_calibration_offset_ = std::min(first_calibration_offset_, entry.offset);
    for (int k = 0; k < entry.size; ++k) {
      components_.push_back(state.CalibrationOffset() + entry.offset + k);
    }
  }
}

int VisualColumns::CalibrationColumn(const CalibrationLayout& layout, CalibrationBlock block,
                                     int camera) const {
  const int offset = layout.OffsetOf(block, camera);
  return offset < 0 ? -1 : first_calibration_column_ + offset - first_calibration_offset_;
}

bool LinearizeLandmark(const FilterState& state, const VisualColumns& columns,
                       const LinearizationSettings& settings, int anchor_clone,
                       const InverseDepth& landmark, std::span<const CloneObservation> observations,
                       LandmarkRowsRef H_f, MeasurementRowsRef rows) {
  CHECK_EQ(rows.rows(), static_cast<Eigen::Index>(2 * observations.size()));
  const bool time_matters = state.time_matters();
  const double weight = 1.0 / settings.pixel_noise_px;
  const Clone& anchor = state.clones()[anchor_clone];
  rows.setZero();
  ObservationJacobians J;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const CloneObservation& observation = observations[k];
    const Clone& clone = state.clones()[observation.clone];
    TwoRowsRef two_rows = rows.middleRows<2>(static_cast<Eigen::Index>(2 * k));
    Eigen::Vector2d predicted;
    if (!PredictPixel(state.rig(), anchor.nav.pose(), landmark,
                      Observing(clone, clone.nav, time_matters), observation.pixel, settings.g_G,
                      &predicted, settings.separate_first_estimates ? nullptr : &J)) {
      return false;
    }
    two_rows.rightCols<1>() = weight * (observation.pixel.uv - predicted);
    if (settings.separate_first_estimates &&
        !PredictPixel(state.rig(), anchor.nav_fej.pose(), landmark,
                      Observing(clone, clone.nav_fej, time_matters), observation.pixel,
                      settings.g_G, &predicted, &J)) {
      return false;
    }
    H_f.middleRows<2>(static_cast<Eigen::Index>(2 * k)) = weight * J.landmark;
    two_rows.middleCols<6>(columns.CloneColumn(anchor_clone)) += weight * J.anchor;
    const int column = columns.CloneColumn(observation.clone);
    if (time_matters) {
      two_rows.middleCols<9>(column) += weight * J.state;
    } else {
      two_rows.middleCols<6>(column) += weight * J.state.leftCols<6>();
    }
    AddCalibration(state, columns, observation.pixel.camera, J, weight, two_rows);
  }
  return true;
}

}  // namespace duet
