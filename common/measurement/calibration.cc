#include "common/measurement/calibration.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/so3.h"
#include "common/imu/imu_delta.h"
#include "common/measurement/gauge.h"
#include "common/support/logging.h"

namespace duet {
namespace {

constexpr int kBlockKinds = 9;

// The order of DESIGN.md section 3: IMU, then camera by camera, then the times.
template <class Function>
void ForEachBlock(const RigCalibration& rig, Function&& function) {
  function(CalibrationBlock::kTg, -1, 9);
  function(CalibrationBlock::kTs, -1, 9);
  function(CalibrationBlock::kTa, -1, 9);
  for (int c = 0; c < static_cast<int>(rig.cameras.size()); ++c) {
    function(CalibrationBlock::kExtrinsicTranslation, c, 3);
    function(CalibrationBlock::kExtrinsicRotation, c, 3);
    function(CalibrationBlock::kIntrinsics, c, CameraModel::kPinholeParameters);
    function(CalibrationBlock::kDistortion, c, rig.cameras[c].model.distortion_count());
  }
  function(CalibrationBlock::kTimeOffset, -1, 1);
  function(CalibrationBlock::kReadoutTime, -1, 1);
}

const BlockPrior& PriorOf(const CalibrationPriors& p, CalibrationBlock block) {
  switch (block) {
    case CalibrationBlock::kTg:
      return p.T_g;
    case CalibrationBlock::kTs:
      return p.T_s;
    case CalibrationBlock::kTa:
      return p.T_a;
    case CalibrationBlock::kExtrinsicTranslation:
      return p.p_CB;
    case CalibrationBlock::kExtrinsicRotation:
      return p.R_CB;
    case CalibrationBlock::kIntrinsics:
      return p.intrinsics;
    case CalibrationBlock::kDistortion:
      return p.distortion;
    case CalibrationBlock::kTimeOffset:
      return p.t_d;
    case CalibrationBlock::kReadoutTime:
      return p.t_r;
  }
  LOG(FATAL) << "unknown calibration block";
}

// True where the gauge holds a number of a T matrix (by rows) at its told value.
bool HeldByGauge(const CalibrationPriors& priors, CalibrationBlock block, int number) {
  const bool held =
      GaugeActs(priors) &&
      ((block == CalibrationBlock::kTg && priors.imu_frame == ImuFrame::kGyroscope) ||
       (block == CalibrationBlock::kTa && priors.imu_frame == ImuFrame::kAccelerometer));
  return held && IsAboveDiagonal(number);
}

// All numbers of a block that is a plain vector (all but R_CB).
Eigen::VectorXd NumbersOf(const RigCalibration& rig, const CalibrationLayout::Entry& e) {
  switch (e.block) {
    case CalibrationBlock::kTg:
    case CalibrationBlock::kTs:
    case CalibrationBlock::kTa:
      return ToVector(rig.imu).segment<9>(ImuBlockOffset(e.block));
    case CalibrationBlock::kExtrinsicTranslation:
      return rig.cameras[e.camera].p_CB;
    case CalibrationBlock::kIntrinsics:
      return rig.cameras[e.camera].model.parameters().head<CameraModel::kPinholeParameters>();
    case CalibrationBlock::kDistortion:
      return rig.cameras[e.camera].model.parameters().segment(
          CameraModel::kPinholeParameters, rig.cameras[e.camera].model.distortion_count());
    case CalibrationBlock::kTimeOffset:
      return Eigen::VectorXd::Constant(1, rig.t_d_s);
    case CalibrationBlock::kReadoutTime:
      return Eigen::VectorXd::Constant(1, rig.t_r_s);
    case CalibrationBlock::kExtrinsicRotation:
      break;
  }
  LOG(FATAL) << "a rotation is no vector";
}

// The components of such a block.
Eigen::VectorXd VectorOf(const RigCalibration& rig, const CalibrationLayout::Entry& e) {
  const Eigen::VectorXd numbers = NumbersOf(rig, e);
  Eigen::VectorXd vector(e.size);
  for (int k = 0; k < e.size; ++k) vector[k] = numbers[e.number[k]];
  return vector;
}

void AddToBlock(const CalibrationLayout::Entry& e, const Eigen::VectorXd& d, RigCalibration* rig) {
  switch (e.block) {
    case CalibrationBlock::kTg:
    case CalibrationBlock::kTs:
    case CalibrationBlock::kTa: {
      Eigen::Matrix<double, 27, 1> vector = ToVector(rig->imu);
      for (int k = 0; k < e.size; ++k) vector[ImuBlockOffset(e.block) + e.number[k]] += d[k];
      rig->imu = ImuCalibrationFromVector(vector);
      return;
    }
    case CalibrationBlock::kExtrinsicTranslation:
      rig->cameras[e.camera].p_CB += d;
      return;
    case CalibrationBlock::kExtrinsicRotation: {
      CameraCalibration& camera = rig->cameras[e.camera];
      camera.R_CB = BoxPlus(camera.R_CB, Eigen::Vector3d(d));
      return;
    }
    case CalibrationBlock::kIntrinsics:
    case CalibrationBlock::kDistortion: {
      CameraModel& model = rig->cameras[e.camera].model;
      CameraModel::Parameters parameters = model.parameters();
      const bool pinhole = e.block == CalibrationBlock::kIntrinsics;
      parameters.segment(pinhole ? 0 : CameraModel::kPinholeParameters, e.size) += d;
      model.set_parameters(parameters);
      return;
    }
    case CalibrationBlock::kTimeOffset:
      rig->t_d_s += d[0];
      return;
    case CalibrationBlock::kReadoutTime:
      rig->t_r_s += d[0];
      return;
  }
}

std::vector<std::string> NamesOf(const CalibrationLayout::Entry& e) {
  const auto matrix = [&](const std::string& name) {
    std::vector<std::string> names;
    for (int k = 0; k < e.size; ++k) {
      const int row = e.number[k] / 3 + 1;
      const int column = e.number[k] % 3 + 1;
      names.push_back(name + std::to_string(10 * row + column));
    }
    return names;
  };
  const std::string cam = "cam" + std::to_string(e.camera) + ".";
  switch (e.block) {
    case CalibrationBlock::kTg:
      return matrix("T_g.");
    case CalibrationBlock::kTs:
      return matrix("T_s.");
    case CalibrationBlock::kTa:
      return matrix("T_a.");
    case CalibrationBlock::kExtrinsicTranslation:
      return {cam + "p_CB.x", cam + "p_CB.y", cam + "p_CB.z"};
    case CalibrationBlock::kExtrinsicRotation:
      return {cam + "R_CB.x", cam + "R_CB.y", cam + "R_CB.z"};
    case CalibrationBlock::kIntrinsics:
      return {cam + "fx", cam + "fy", cam + "ox", cam + "oy"};
    case CalibrationBlock::kDistortion:
      if (e.size == 5) return {cam + "k1", cam + "k2", cam + "t1", cam + "t2", cam + "k3"};
      return {cam + "k1", cam + "k2", cam + "k3", cam + "k4"};
    case CalibrationBlock::kTimeOffset:
      return {"t_d"};
    case CalibrationBlock::kReadoutTime:
      return {"t_r"};
  }
  return {};
}

}  // namespace

CalibrationLayout::CalibrationLayout(const CalibrationPriors& priors, const RigCalibration& rig)
    : camera_count_(static_cast<int>(rig.cameras.size())) {
  offset_of_.assign(kBlockKinds * (camera_count_ + 1), -1);
  ForEachBlock(rig, [&](CalibrationBlock block, int camera, int size) {
    const BlockPrior& prior = PriorOf(priors, block);
    if (!prior.estimated || (camera >= 0 && !priors.Estimates(camera))) return;
    Entry entry{.block = block, .camera = camera, .offset = size_};
    for (int number = 0; number < size; ++number) {
      if (HeldByGauge(priors, block, number)) continue;
      double sigma = prior.sigma;
      if (block == CalibrationBlock::kDistortion) {
        const double told =
            rig.cameras[camera].model.parameters()[CameraModel::kPinholeParameters + number];
        sigma = std::hypot(sigma, priors.distortion.share * told);
      }
      if (IsImuBlock(block)) imu_columns_.push_back(ImuBlockOffset(block) + number);
      entry.number[entry.size] = number;
      entry.sigma[entry.size++] = sigma;
    }
    entries_.push_back(entry);
    offset_of_[static_cast<int>(block) * (camera_count_ + 1) + camera + 1] = size_;
    size_ += entry.size;
  });
}

int CalibrationLayout::OffsetOf(CalibrationBlock block, int camera) const {
  if (offset_of_.empty()) return -1;
  return offset_of_[static_cast<int>(block) * (camera_count_ + 1) + camera + 1];
}

Eigen::VectorXd CalibrationLayout::PriorSigmas() const {
  Eigen::VectorXd sigmas(size_);
  for (const Entry& e : entries_) {
    for (int k = 0; k < e.size; ++k) sigmas[e.offset + k] = e.sigma[k];
  }
  return sigmas;
}

std::vector<std::string> CalibrationLayout::ComponentNames() const {
  std::vector<std::string> names;
  for (const Entry& e : entries_) {
    for (std::string& name : NamesOf(e)) names.push_back(std::move(name));
  }
  return names;
}

std::vector<std::string> CalibrationLayout::ComponentUnits() const {
  static constexpr std::array<const char*, kBlockKinds> kUnits = {
      "", "rad s m^-1", "", "m", "rad", "px", "", "s", "s"};
  std::vector<std::string> units;
  for (const Entry& e : entries_) {
    units.insert(units.end(), static_cast<std::size_t>(e.size),
                 kUnits[static_cast<std::size_t>(e.block)]);
  }
  return units;
}

std::string BlockName(const CalibrationLayout::Entry& entry) {
  static constexpr std::array<const char*, kBlockKinds> kNames = {
      "T_g", "T_s", "T_a", "p_CB", "R_CB", "intrinsics", "distortion", "t_d", "t_r"};
  const char* name = kNames[static_cast<std::size_t>(entry.block)];
  return entry.camera < 0 ? name : "cam" + std::to_string(entry.camera) + "." + name;
}

RigCalibration BoxPlus(const RigCalibration& rig, const CalibrationLayout& layout,
                       const Eigen::Ref<const Eigen::VectorXd>& error) {
  CHECK_EQ(error.size(), layout.size());
  RigCalibration result = rig;
  for (const auto& e : layout.entries()) AddToBlock(e, error.segment(e.offset, e.size), &result);
  return result;
}

Eigen::VectorXd BoxMinus(const RigCalibration& a, const RigCalibration& b,
                         const CalibrationLayout& layout) {
  Eigen::VectorXd error(layout.size());
  for (const auto& e : layout.entries()) {
    if (e.block == CalibrationBlock::kExtrinsicRotation) {
      error.segment<3>(e.offset) = BoxMinus(a.cameras[e.camera].R_CB, b.cameras[e.camera].R_CB);
    } else {
      error.segment(e.offset, e.size) = VectorOf(a, e) - VectorOf(b, e);
    }
  }
  return error;
}

bool PixelsLeaveTheInstant(const CalibrationPriors& priors, const RigCalibration& rig) {
  return priors.t_d.estimated || priors.t_r.estimated || rig.t_r_s != 0.0;
}

void HoldTimes(const CalibrationLayout& layout, const TimeBounds& bounds, RigCalibration* rig) {
  if (layout.OffsetOf(CalibrationBlock::kTimeOffset) >= 0) {
    rig->t_d_s = std::clamp(rig->t_d_s, -bounds.max_abs_t_d_s, bounds.max_abs_t_d_s);
  }
  if (layout.OffsetOf(CalibrationBlock::kReadoutTime) >= 0) {
    rig->t_r_s = std::clamp(rig->t_r_s, -bounds.max_abs_t_r_s, bounds.max_abs_t_r_s);
  }
}

Eigen::VectorXd ComponentValues(const RigCalibration& rig, const CalibrationLayout& layout) {
  Eigen::VectorXd values(layout.size());
  for (const auto& e : layout.entries()) {
    if (e.block == CalibrationBlock::kExtrinsicRotation) {
      values.segment<3>(e.offset) = Log(rig.cameras[e.camera].R_CB);
    } else {
      values.segment(e.offset, e.size) = VectorOf(rig, e);
    }
  }
  return values;
}

}  // namespace duet
