#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "common/imu/imu_buffer.h"
#include "common/imu/imu_model.h"
#include "common/support/timestamp.h"

namespace duet {

/// The motion close to a state's instant s_i, as the IMU saw it, with the corrected rates frozen at
/// the biases and T matrices they were made with (DESIGN.md section 3, "Time"): what is needed to
/// take a pose from s_i to s_i + tau for a row of a rolling shutter or a shift of t_d.
class RateProfile {
 public:
  struct Motion {
    Eigen::Quaterniond R = Eigen::Quaterniond::Identity();  ///< R_B(s_i) B(s_i + tau)
    Eigen::Vector3d s = Eigen::Vector3d::Zero();            ///< as in ImuDelta
    Eigen::Vector3d y = Eigen::Vector3d::Zero();
    Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< corrected rates at s_i + tau
    Eigen::Vector3d a_B = Eigen::Vector3d::Zero();
  };

  /// Replaces the profile by the readings within [instant - reach_s, instant + reach_s], as far as
  /// the buffer holds them (beyond, the outermost rates go on). Reuses its memory.
  void Assign(const ImuBuffer& buffer, Timestamp instant, double reach_s, const ImuBiases& biases,
              const ImuCalibration& calibration);

  /// Motion over `tau_s` from the instant; tau 0 gives the identity and the rates there.
  [[nodiscard]] Motion At(double tau_s) const;

  /// The last answer, for who asks again and again over the same time (an observation: times change
  /// from step to step of a solver, not from evaluation to evaluation). Belongs to one profile, and
  /// only until its next Assign.
  struct Memo {
    void Clear() { tau_s = std::numeric_limits<double>::quiet_NaN(); }
    double tau_s = std::numeric_limits<double>::quiet_NaN();  ///< none
    Motion motion;
  };
  [[nodiscard]] const Motion& At(double tau_s, Memo* memo) const {
    if (memo->tau_s != tau_s) {
      memo->motion = At(tau_s);
      memo->tau_s = tau_s;
    }
    return memo->motion;
  }

 private:
  struct Node {
    double tau_s;
    Motion motion;
  };
  std::vector<Node> nodes_;  // ascending in tau; contains tau = 0
  std::size_t zero_ = 0;
  std::vector<ImuSample> readings_;  // scratch
};

}  // namespace duet
