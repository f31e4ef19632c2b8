#pragma once

#include <Eigen/Core>

#include "backends/msckf/transition.h"
#include "common/measurement/calibration.h"

namespace duet {

/// Memory that PropagateCovariance reuses.
struct PropagationWorkspace {
  Eigen::Matrix<double, 9, Eigen::Dynamic> F;
  Eigen::Matrix<double, 9, Eigen::Dynamic> F_P;
};

/// P <- [Phi Gamma 0; 0 I 0; 0 0 I] P [...]' + blockdiag(Q, 0, 0) (thesis B.1), in place. P is over
/// (theta, p, v, b_g, b_a | calibration | anything); the T matrices that `layout` estimates take
/// their columns of Gamma. Biases carry over unchanged, so only nine rows and columns are computed.
void PropagateCovariance(const Transition& transition, const CalibrationLayout& layout,
                         Eigen::Ref<Eigen::MatrixXd> P, PropagationWorkspace* workspace);

}  // namespace duet
