#include "backends/window/reprojection_factor.h"

namespace duet {
namespace {

ObservingState StateOf(const ReprojectionSetup& setup, const WindowPoint& point,
                       const std::vector<WindowFrame>& frames,
                       const LandmarkObservation& observation) {
  const WindowFrame& frame = frames[observation.frame];
  return {point.nav[observation.frame], frame.t_d_at_instant_s,
          setup.off_instant ? &frame.rates : nullptr, &observation.motion};
}

// d uv / d one block of the calibration.
template <class Block>
void SetCalibrationJacobian(const ObservationJacobians& J, const CalibrationLayout::Entry& entry,
                            int camera, Block out) {
  out.setZero();
  const bool observing = entry.camera == camera;
  switch (entry.block) {
    case CalibrationBlock::kExtrinsicTranslation:
      if (entry.camera == 0) out += J.anchor_extrinsics.leftCols<3>();
      if (observing) out += J.extrinsics.leftCols<3>();
      return;
    case CalibrationBlock::kExtrinsicRotation:
      if (entry.camera == 0) out += J.anchor_extrinsics.rightCols<3>();
      if (observing) out += J.extrinsics.rightCols<3>();
      return;
    case CalibrationBlock::kIntrinsics:
      if (observing) out = J.parameters.leftCols<CameraModel::kPinholeParameters>();
      return;
    case CalibrationBlock::kDistortion:
      if (observing) out = J.parameters.middleCols(CameraModel::kPinholeParameters, entry.size);
      return;
    case CalibrationBlock::kTimeOffset:
      out = J.t_d;
      return;
    case CalibrationBlock::kReadoutTime:
      out = J.t_r;
      return;
    case CalibrationBlock::kTg:
    case CalibrationBlock::kTs:
    case CalibrationBlock::kTa:
      return;  // rates are frozen within an observation's delay
  }
}

}  // namespace

void CalibrationJacobian(const ObservationJacobians& J, const CalibrationLayout& layout, int camera,
                         Eigen::Ref<Eigen::Matrix<double, 2, Eigen::Dynamic>> out) {
  for (const auto& entry : layout.entries()) {
    SetCalibrationJacobian(J, entry, camera, out.middleCols(entry.offset, entry.size));
  }
}

bool EvaluateReprojection(const ReprojectionSetup& setup, const WindowPoint& point,
                          const std::vector<WindowFrame>& frames, int anchor,
                          const LandmarkObservation& observation, const InverseDepth& landmark,
                          Eigen::Vector2d* r) {
  Eigen::Vector2d uv;
  if (!PredictPixel(point.rig, point.nav[anchor].pose(), landmark,
                    StateOf(setup, point, frames, observation), observation.pixel, setup.g_G,
                    &uv)) {
    return false;
  }
  *r = (uv - observation.pixel.uv) / setup.pixel_noise_px;
  return true;
}

bool EvaluateReprojection(const ReprojectionSetup& setup, const WindowPoint& point,
                          const std::vector<WindowFrame>& frames, const CalibrationLayout& layout,
                          int anchor, const LandmarkObservation& observation,
                          const InverseDepth& landmark, Eigen::Vector2d* r,
                          ReprojectionJacobians* jacobians) {
  Eigen::Vector2d uv;
  ObservationJacobians J;
  if (!PredictPixel(point.rig, point.nav[anchor].pose(), landmark,
                    StateOf(setup, point, frames, observation), observation.pixel, setup.g_G, &uv,
                    &J)) {
    return false;
  }
  const double weight = 1.0 / setup.pixel_noise_px;
  *r = weight * (uv - observation.pixel.uv);
  jacobians->landmark = weight * J.landmark;
  jacobians->anchor = weight * J.anchor;
  jacobians->state = weight * J.state;
  jacobians->calibration.resize(2, layout.size());
  CalibrationJacobian(J, layout, observation.pixel.camera, jacobians->calibration);
  jacobians->calibration *= weight;
  return true;
}

}  // namespace duet
