#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "common/camera/camera_model.h"
#include "common/imu/imu_model.h"
#include "common/measurement/calibration_options.h"

namespace duet {

/// One camera of the rig: x_C = R_CB x_B + p_CB (p_CB: the body's origin in the camera frame, m).
struct CameraCalibration {
  CameraModel model;
  Eigen::Quaterniond R_CB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_CB = Eigen::Vector3d::Zero();
};

/// Everything that may be calibrated, in the order of DESIGN.md section 3:
/// T_g T_s T_a | for each camera: p_CB, R_CB, intrinsics, distortion | t_d, t_r.
struct RigCalibration {
  ImuCalibration imu;
  std::vector<CameraCalibration> cameras;
  double t_d_s = 0.0;  ///< an image stamped t was taken, at its middle row, at t + t_d
  double t_r_s = 0.0;  ///< readout time of all rows; negative reads upwards; 0 is a global shutter
  bool readout_by_columns = false;
};

enum class CalibrationBlock {
  kTg,
  kTs,
  kTa,                    // 9 each
  kExtrinsicTranslation,  // p_CB, 3
  kExtrinsicRotation,     // R_CB, 3: R_CB_true = Exp(phi) R_CB, phi in C
  kIntrinsics,            // fx fy ox oy, 4
  kDistortion,            // 5 or 4
  kTimeOffset,            // t_d, 1
  kReadoutTime,           // t_r, 1
};

/// True for T_g, T_s, T_a, the part of the calibration that an IMU delta depends on.
[[nodiscard]] constexpr bool IsImuBlock(CalibrationBlock block) {
  return block == CalibrationBlock::kTg || block == CalibrationBlock::kTs ||
         block == CalibrationBlock::kTa;
}
/// Where such a block starts among the 27 numbers.
[[nodiscard]] constexpr int ImuBlockOffset(CalibrationBlock block) {
  return block == CalibrationBlock::kTg ? 0 : block == CalibrationBlock::kTs ? 9 : 18;
}

/// The estimated part of the calibration as one error vector.
class CalibrationLayout {
 public:
  static constexpr int kMaxBlockSize = 9;
  struct Entry {
    CalibrationBlock block;
    int camera;    ///< index into RigCalibration::cameras; -1 for blocks of the rig or the IMU
    int offset;    ///< first component in the error vector
    int size = 0;  ///< components; fewer than the block's numbers where the gauge holds some
    /// Which of the block's numbers the components are, ascending, and their priors.
    std::array<int, kMaxBlockSize> number{};
    std::array<double, kMaxBlockSize> sigma{};
  };

  CalibrationLayout() = default;
  CalibrationLayout(const CalibrationPriors& priors, const RigCalibration& rig);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// Offset of a block in the error vector, -1 where it is fixed. `camera` is -1 for T matrices and
  /// times.
  [[nodiscard]] int OffsetOf(CalibrationBlock block, int camera = -1) const;
  /// True where a T matrix is estimated: an IMU delta then needs its Jacobians to them.
  [[nodiscard]] bool EstimatesImu() const { return !imu_columns_.empty(); }
  /// The T matrices' components, which come first, as indices of the 27 numbers: columns of Gamma
  /// or of J_T.
  [[nodiscard]] const std::vector<int>& imu_columns() const { return imu_columns_; }
  /// The prior's standard deviations, one a component.
  [[nodiscard]] Eigen::VectorXd PriorSigmas() const;
  /// "cam0.p_CB.x", "t_d", ...: names for files, one a component.
  [[nodiscard]] std::vector<std::string> ComponentNames() const;
  /// "m", "rad s m^-1", "" where it has none, ...: one a component, as files write them.
  [[nodiscard]] std::vector<std::string> ComponentUnits() const;

 private:
  std::vector<Entry> entries_;
  std::vector<int> offset_of_;  // block-major lookup
  std::vector<int> imu_columns_;
  int camera_count_ = 0;
  int size_ = 0;
};

/// "T_g", "cam0.p_CB", "t_d", ...: the block's name for tables; without the camera as in the
/// configuration.
[[nodiscard]] std::string BlockName(const CalibrationLayout::Entry& entry);

/// rig (+) error and a (-) b on the estimated components.
[[nodiscard]] RigCalibration BoxPlus(const RigCalibration& rig, const CalibrationLayout& layout,
                                     const Eigen::Ref<const Eigen::VectorXd>& error);
[[nodiscard]] Eigen::VectorXd BoxMinus(const RigCalibration& a, const RigCalibration& b,
                                       const CalibrationLayout& layout);

/// True where a pixel may be of another instant than its frame's pose, because a time is estimated
/// or the shutter told as rolling. Estimators then carry velocities and rates for their frames.
[[nodiscard]] bool PixelsLeaveTheInstant(const CalibrationPriors& priors,
                                         const RigCalibration& rig);

/// Within which estimators hold the times that they estimate.
struct TimeBounds {
  double max_abs_t_d_s = std::numeric_limits<double>::infinity();
  double max_abs_t_r_s = std::numeric_limits<double>::infinity();
};
/// Sets an estimated time that lies outside of its bound to it.
void HoldTimes(const CalibrationLayout& layout, const TimeBounds& bounds, RigCalibration* rig);

/// A number whose standard deviation stays above this share of its prior's was not observed.
inline constexpr double kUnobservedShare = 0.9;

/// The values of the estimated components for files, in the order of ComponentNames(); a rotation
/// as the rotation vector of R_CB [rad].
[[nodiscard]] Eigen::VectorXd ComponentValues(const RigCalibration& rig,
                                              const CalibrationLayout& layout);

}  // namespace duet
