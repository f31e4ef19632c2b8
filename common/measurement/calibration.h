#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "common/camera/camera_model.h"
#include "common/imu/imu_model.h"

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

/// Which blocks an estimator estimates and how well they are known before (1 sigma).
struct CalibrationPriors {
  /// A block is estimated where its flag is set, else fixed at its told value.
  bool estimate_T_g = false;
  bool estimate_T_s = false;
  bool estimate_T_a = false;
  bool estimate_p_CB = false;
  bool estimate_R_CB = false;
  bool estimate_intrinsics = false;
  bool estimate_distortion = false;
  bool estimate_t_d = false;
  bool estimate_t_r = false;
  double sigma_T_g = 0.01;
  double sigma_T_s = 1e-3;  ///< rad/s per m/s^2
  double sigma_T_a = 0.01;
  double sigma_p_CB_m = 0.02;
  double sigma_R_CB_rad = 0.0175;
  double sigma_intrinsics_px = 5.0;
  double sigma_distortion = 0.01;
  double sigma_t_d_s = 0.01;
  double sigma_t_r_s = 0.02;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("estimate_T_g", &estimate_T_g,
            {.doc = "Estimate T_g (gyroscope scale and misalignment)."});
    v.Field("estimate_T_s", &estimate_T_s, {.doc = "Estimate T_s (g-sensitivity)."});
    v.Field("estimate_T_a", &estimate_T_a,
            {.doc = "Estimate T_a (accelerometer scale and misalignment)."});
    v.Field("estimate_p_CB", &estimate_p_CB, {.doc = "Estimate p_CB of each camera."});
    v.Field("estimate_R_CB", &estimate_R_CB, {.doc = "Estimate R_CB of each camera."});
    v.Field("estimate_intrinsics", &estimate_intrinsics,
            {.doc = "Estimate fx fy ox oy of each camera."});
    v.Field("estimate_distortion", &estimate_distortion,
            {.doc = "Estimate the distortion of each camera."});
    v.Field("estimate_t_d", &estimate_t_d, {.doc = "Estimate t_d, one for the rig."});
    v.Field("estimate_t_r", &estimate_t_r, {.doc = "Estimate t_r, one for the rig."});
    v.Field("sigma_T_g", &sigma_T_g,
            {.doc = "Prior of each number of T_g.", .unit = "1", .min = 0});
    v.Field("sigma_T_s", &sigma_T_s,
            {.doc = "Prior of each number of T_s.", .unit = "rad/s per m/s^2", .min = 0});
    v.Field("sigma_T_a", &sigma_T_a,
            {.doc = "Prior of each number of T_a.", .unit = "1", .min = 0});
    v.Field("sigma_p_CB_m", &sigma_p_CB_m,
            {.doc = "Prior of p_CB, per axis.", .unit = "m", .min = 0});
    v.Field("sigma_R_CB_rad", &sigma_R_CB_rad,
            {.doc = "Prior of R_CB, per axis.", .unit = "rad", .min = 0});
    v.Field("sigma_intrinsics_px", &sigma_intrinsics_px,
            {.doc = "Prior of fx fy ox oy.", .unit = "px", .min = 0});
    v.Field("sigma_distortion", &sigma_distortion,
            {.doc = "Prior of each distortion number.", .unit = "1", .min = 0});
    v.Field("sigma_t_d_s", &sigma_t_d_s, {.doc = "Prior of t_d.", .unit = "s", .min = 0});
    v.Field("sigma_t_r_s", &sigma_t_r_s, {.doc = "Prior of t_r.", .unit = "s", .min = 0});
  }
};

/// The estimated part of the calibration as one error vector.
class CalibrationLayout {
 public:
  struct Entry {
    CalibrationBlock block;
    int camera;  ///< index into RigCalibration::cameras; -1 for blocks of the rig or the IMU
    int offset;  ///< first component in the error vector
    int size;
    double sigma;
  };

  CalibrationLayout() = default;
  CalibrationLayout(const CalibrationPriors& priors, const RigCalibration& rig);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// Offset of a block in the error vector, -1 where it is fixed. `camera` is -1 for T matrices and
  /// times.
  [[nodiscard]] int OffsetOf(CalibrationBlock block, int camera = -1) const;
  /// True where a T matrix is estimated: an IMU delta then needs its Jacobians to them.
  [[nodiscard]] bool EstimatesImu() const;
  /// The prior's standard deviations, one a component.
  [[nodiscard]] Eigen::VectorXd PriorSigmas() const;
  /// "cam0.p_CB.x", "t_d", ...: names for files, one a component.
  [[nodiscard]] std::vector<std::string> ComponentNames() const;

 private:
  std::vector<Entry> entries_;
  std::vector<int> offset_of_;  // block-major lookup
  int camera_count_ = 0;
  int size_ = 0;
};

/// rig (+) error and a (-) b on the estimated components.
[[nodiscard]] RigCalibration BoxPlus(const RigCalibration& rig, const CalibrationLayout& layout,
                                     const Eigen::Ref<const Eigen::VectorXd>& error);
[[nodiscard]] Eigen::VectorXd BoxMinus(const RigCalibration& a, const RigCalibration& b,
                                       const CalibrationLayout& layout);

/// The values of the estimated components for files, in the order of ComponentNames(); a rotation
/// as the rotation vector of R_CB [rad].
[[nodiscard]] Eigen::VectorXd ComponentValues(const RigCalibration& rig,
                                              const CalibrationLayout& layout);

}  // namespace duet
