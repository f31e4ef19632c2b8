#pragma once

#include <span>

#include "common/imu/imu_delta.h"

namespace duet {

/// The IMU delta with Jacobians and covariance by the thesis's trapezoids of one step (B.49 to
/// B.63), composed over the readings; the motion (R, s, y) is IntegrateImu's to the bit, so that
/// MakeTransition makes Phi, Gamma and Q of it the same way and nothing but the approximation
/// differs. It exists to show what that costs; see MsckfOptions::transition and docs/equations.md.
///
/// Over a step of h from R to R' (into the frame of the delta's start), with the rates taken at its
/// *end* and W = d omega / d x, A = d a / d x there (B.15 to B.19, B.32 to B.36):
///
///   theta = h/2 (R + R') W                             B.49, B.52, B.55, B.58, B.61
///   s     = h/2 (R + R') A - h^2/4 [R' a]x (R + R') W  B.50, B.53, B.56, B.59, B.62
///   y     = h/2 of the first term of s + h/3 of the second
///
/// Deviations, the errata of docs/equations.md: the second term of s has the sign of B.50 in all
/// five (printed with the other one in B.53, B.56, B.59 and B.62), and y takes h/3 of it (B.51,
/// B.54, B.57, B.60 and B.63 take h/2). What came before the step is carried on exactly, as in
/// delta_step.h. The thesis does not say how its Q is made; here by the same rule, the trapezoid of
/// the integral of F N F':  Q = h/2 (F N F' + N'), N the noises' density at the begin, N' at the
/// end of the step.
///
/// Bias Jacobians are of second order in the step; those to T matrices of first where rates change
/// (they are taken at the end of the step alone), held by TrapezoidDelta.OrdersOfConvergence.
/// `readings` as of IntegrateImu, but ascending (CHECKed): a filter propagates forwards.
[[nodiscard]] ImuDelta IntegrateImuByTrapezoids(std::span<const ImuSample> readings,
                                                const ImuBiases& biases,
                                                const ImuCalibration& calibration,
                                                const ImuNoise& noise,
                                                const ImuDeltaOptions& options = {});

}  // namespace duet
