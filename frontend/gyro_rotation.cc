#include "frontend/gyro_rotation.h"

#include <algorithm>

#include "common/geometry/so3.h"

namespace duet {

std::optional<Eigen::Quaterniond> GyroRotation::Between(Timestamp t0, Timestamp t1) {
  if (buffer_.empty()) return std::nullopt;
  const Timestamp from = std::clamp(t0, buffer_.first(), buffer_.last());
  const Timestamp to = std::clamp(t1, buffer_.first(), buffer_.last());
  buffer_.Extract(from, to, &readings_);
  const ImuCorrection correct(calibration_, {.b_g = b_g_});
  const auto rate = [&](const ImuSample& s) { return correct(s.omega_m, s.a_m).omega_B; };

  Eigen::Quaterniond R_B0B = ExpQuaternion(rate(readings_.front()) * SecondsBetween(t0, from));
  Eigen::Vector3d omega_0 = rate(readings_.front());
  for (std::size_t i = 1; i < readings_.size(); ++i) {
    const Eigen::Vector3d omega_1 = rate(readings_[i]);
    const double dt_s = SecondsBetween(readings_[i - 1].timestamp, readings_[i].timestamp);
    R_B0B = R_B0B * ExpQuaternion(0.5 * (omega_0 + omega_1) * dt_s);
    omega_0 = omega_1;
  }
  R_B0B = R_B0B * ExpQuaternion(omega_0 * SecondsBetween(to, t1));
  buffer_.DropBefore(from);
  return R_B0B.conjugate().normalized();
}

void GyroRotation::LearnBias(const Eigen::Vector3d& delta_B, double dt_s) {
  // Too high a bias turns B1 too little: R_B1B0 = Exp(-(omega_m - b) dt), so delta = db dt.
  constexpr double kLargestStep = 0.05;  // rad/s
  constexpr int kMemory = 60;
  Eigen::Vector3d innovation = delta_B / dt_s;
  const double norm = innovation.norm();
  // The first intervals start from a bias of zero and must reach whatever it is.
  if (learned_ >= 3 && norm > kLargestStep) innovation *= kLargestStep / norm;
  learned_ = std::min(learned_ + 1, kMemory);
  b_g_ += innovation / learned_;
}

}  // namespace duet
