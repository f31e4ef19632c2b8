#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/imu/imu_buffer.h"
#include "common/imu/imu_model.h"

namespace duet {

/// The rotation between two frames by the gyroscope, with a bias that the front end finds itself
/// from how far the tracks' rotation differs from the gyroscope's.
class GyroRotation {
 public:
  explicit GyroRotation(const ImuCalibration& calibration) : calibration_(calibration) {}

  void Add(const ImuSample& sample) { buffer_.Add(sample); }

  /// R_B1B0: takes a vector from B at `t0` to B at `t1` >= t0. Where the samples do not reach, the
  /// nearest one's rate goes on. Nothing without a sample. Forgets what lies before `t0`.
  [[nodiscard]] std::optional<Eigen::Quaterniond> Between(Timestamp t0, Timestamp t1);

  /// `delta_B` (rad, in B at the end of `dt_s`): R_B1B0_true = Exp(delta_B) R_B1B0, as the tracks
  /// say. b_g is an average of what this tells of it: the plain mean at first, then one that
  /// forgets with a time constant of 60 intervals; a single interval moves it by at most
  /// 0.05 rad/s times its weight, so that a wrong one does no harm.
  void LearnBias(const Eigen::Vector3d& delta_B, double dt_s);

  [[nodiscard]] const Eigen::Vector3d& b_g() const { return b_g_; }
  [[nodiscard]] int learned() const { return learned_; }

 private:
  ImuCalibration calibration_;
  ImuBuffer buffer_;
  Eigen::Vector3d b_g_ = Eigen::Vector3d::Zero();
  int learned_ = 0;
  std::vector<ImuSample> readings_;  // scratch
};

}  // namespace duet
