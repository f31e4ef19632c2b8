#include "backends/window/parameter_arena.h"

#include "backends/window/imu_factor.h"
#include "common/geometry/rotation_manifold.h"

namespace duet {
namespace {

using Map3 = Eigen::Map<Eigen::Vector3d>;
using MapQuaternion = Eigen::Map<Eigen::Quaterniond>;  // x y z w

// A number of T_g, T_s or T_a, counted by rows.
double& ImuNumber(CalibrationBlock block, int number, ImuCalibration* imu) {
  Eigen::Matrix3d& T = block == CalibrationBlock::kTg   ? imu->T_g
                       : block == CalibrationBlock::kTs ? imu->T_s
                                                        : imu->T_a;
  return T(number / 3, number % 3);
}

void PackBlock(const CalibrationLayout::Entry& e, const RigCalibration& rig, double* values) {
  Eigen::Map<Eigen::VectorXd> out(values, e.size);
  switch (e.block) {
    case CalibrationBlock::kTg:
    case CalibrationBlock::kTs:
    case CalibrationBlock::kTa: {
      ImuCalibration imu = rig.imu;
      for (int k = 0; k < e.size; ++k) out[k] = ImuNumber(e.block, e.number[k], &imu);
      return;
    }
    case CalibrationBlock::kExtrinsicTranslation:
      out = rig.cameras[e.camera].p_CB;
      return;
    case CalibrationBlock::kExtrinsicRotation:
      MapQuaternion{values} = rig.cameras[e.camera].R_CB;
      return;
    case CalibrationBlock::kIntrinsics:
      out = rig.cameras[e.camera].model.parameters().head(e.size);
      return;
    case CalibrationBlock::kDistortion:
      out = rig.cameras[e.camera].model.parameters().tail(e.size);
      return;
    case CalibrationBlock::kTimeOffset:
      out[0] = rig.t_d_s;
      return;
    case CalibrationBlock::kReadoutTime:
      out[0] = rig.t_r_s;
      return;
  }
}

void UnpackBlock(const CalibrationLayout::Entry& e, double* values, RigCalibration* rig) {
  const Eigen::Map<const Eigen::VectorXd> in(values, e.size);
  switch (e.block) {
    case CalibrationBlock::kTg:
    case CalibrationBlock::kTs:
    case CalibrationBlock::kTa:
      for (int k = 0; k < e.size; ++k) ImuNumber(e.block, e.number[k], &rig->imu) = in[k];
      return;
    case CalibrationBlock::kExtrinsicTranslation:
      rig->cameras[e.camera].p_CB = in;
      return;
    case CalibrationBlock::kExtrinsicRotation:
      rig->cameras[e.camera].R_CB = MapQuaternion{values}.normalized();
      return;
    case CalibrationBlock::kIntrinsics:
    case CalibrationBlock::kDistortion: {
      CameraModel& model = rig->cameras[e.camera].model;
      CameraModel::Parameters parameters = model.parameters();
      const bool pinhole = e.block == CalibrationBlock::kIntrinsics;
      parameters.segment(pinhole ? 0 : CameraModel::kPinholeParameters, e.size) = in;
      model.set_parameters(parameters);
      return;
    }
    case CalibrationBlock::kTimeOffset:
      rig->t_d_s = in[0];
      return;
    case CalibrationBlock::kReadoutTime:
      rig->t_r_s = in[0];
      return;
  }
}

}  // namespace

void ParameterArena::Resize(int frame_count, int landmark_count) {
  frame_count_ = frame_count;
  int size = kFrameDoubles * frame_count;
  group_numbers_.clear();
  calibration_.resize(layout_->entries().size());
  for (const CalibrationGroup& group : groups_) {
    group_numbers_.push_back(size);
    for (const CalibrationGroup::Part& part : group.parts) {
      // An entry goes on in the next group without a gap.
      if (part.entry != CalibrationGroup::kFilling && part.first == 0) {
        calibration_[part.entry] = size + part.number;
      }
    }
    size += group.ambient_size;
  }
  landmarks_ = size;
  values_.assign(size + 3 * landmark_count, 0.0);
  point_.nav.resize(frame_count);
  point_.biases.resize(frame_count);
  frame_lifts_.resize(frame_count);
  calibration_lifts_.resize(layout_->entries().size());
}

void ParameterArena::Pack(const std::vector<WindowFrame>& frames, const RigCalibration& rig) {
  for (int i = 0; i < frame_count_; ++i) {
    const InertialState& state = frames[i].state;
    MapQuaternion(pose(i)) = state.nav.R_GB;
    Map3(pose(i) + 4) = state.nav.p_GB;
    Map3(velocity(i)) = state.nav.v_GB;
    Map3(biases(i)) = state.biases.b_g;
    Map3(biases(i) + 3) = state.biases.b_a;
  }
  point_.rig = rig;
  for (int e = 0; e < static_cast<int>(calibration_.size()); ++e) {
    PackBlock(layout_->entries()[e], rig, calibration(e));
  }
  Unpack();
}

void ParameterArena::Unpack() {
  const RotationManifold manifold;
  for (int i = 0; i < frame_count_; ++i) {
    point_.nav[i] = {MapQuaternion(pose(i)).normalized(), Map3(pose(i) + 4), Map3(velocity(i))};
    point_.biases[i] = {Map3(biases(i)), Map3(biases(i) + 3)};
    manifold.MinusJacobian(pose(i), frame_lifts_[i].data());
  }
  for (int e = 0; e < static_cast<int>(calibration_.size()); ++e) {
    const CalibrationLayout::Entry& entry = layout_->entries()[e];
    UnpackBlock(entry, calibration(e), &point_.rig);
    if (entry.block == CalibrationBlock::kExtrinsicRotation) {
      manifold.MinusJacobian(calibration(e), calibration_lifts_[e].data());
    }
  }
}

void ParameterArena::PrepareForEvaluation(bool /*evaluate_jacobians*/, bool new_evaluation_point) {
  if (new_evaluation_point) Unpack();
}

}  // namespace duet
