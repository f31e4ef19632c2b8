#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "backends/initialization/initialization.h"
#include "common/geometry/interpolation.h"
#include "common/geometry/so3.h"
#include "common/imu/imu_delta.h"

// Start from poses of the truth. Unknown x = (theta, p, v, b_g, b_a) at the instant; each pose k of
// the truth near it gives, with the IMU delta from the instant to it (forwards or backwards),
//
//   r_theta = Log(R_k (R dR_k(b))'),   r_p = p_k - (p + v dt + g dt^2/2 + R y_k(b)).
//
// Gauss-Newton with the deltas' first-order Jacobians. A step of the residuals between neighbours
// is a jump of the truth: poses beyond it, seen from the instant, are left out and the fit
// repeated.

namespace duet {
namespace {

struct PoseAndDelta {
  Pose T_GB;
  ImuDelta delta;  // from the instant to the pose
};

// What a motion-capture system or a total station gives; only the ratio to the bias priors matters.
constexpr double kPoseRotationSigma_rad = 1e-3;
constexpr double kPosePositionSigma_m = 1e-3;
// Jumps are told from noise beyond this many median absolute steps, and never below 1.5 mm, 3 mrad.
constexpr double kJumpFactor = 8.0;
constexpr double kMinJump_m = 1.5e-3;
constexpr double kMinJump_rad = 3e-3;
constexpr std::size_t kMinPoses = 5;
constexpr double kMinSpan_s = 0.1;
constexpr double kMaxExtrapolation_s = 0.01;

// Residual (theta, p) of one pose and its Jacobian to x.
void Evaluate(const PoseAndDelta& pose, const InertialState& x, const ImuCalibration& calibration,
              const Eigen::Vector3d& g_G, Vector6d* r, Eigen::Matrix<double, 6, 15>* J) {
  const CorrectedDelta delta = CorrectToFirstOrder(pose.delta, x.biases, calibration);
  const double dt = pose.delta.dt_s;
  const Eigen::Matrix3d R = x.nav.R_GB.toRotationMatrix();
  const Eigen::Vector3d p = x.nav.p_GB + dt * x.nav.v_GB + 0.5 * dt * dt * g_G + R * delta.y;
  r->head<3>() = BoxMinus(pose.T_GB.R, x.nav.R_GB * delta.R);
  r->tail<3>() = pose.T_GB.p - p;
  if (J == nullptr) return;
  J->setZero();
  J->block<3, 3>(0, 0).setIdentity();
  J->block<3, 3>(0, 9) = R * pose.delta.J_b_g.topRows<3>();
  J->block<3, 3>(0, 12) = R * pose.delta.J_b_a.topRows<3>();
  J->block<3, 3>(3, 0) = -Hat(R * delta.y);
  J->block<3, 3>(3, 3).setIdentity();
  J->block<3, 3>(3, 6) = dt * Eigen::Matrix3d::Identity();
  J->block<3, 3>(3, 9) = R * pose.delta.J_b_g.bottomRows<3>();
  J->block<3, 3>(3, 12) = R * pose.delta.J_b_a.bottomRows<3>();
}

// Gauss-Newton from *x over [begin, end); biases held by their prior. False where it is singular.
bool Fit(const std::vector<PoseAndDelta>& poses, std::size_t begin, std::size_t end,
         const EstimatorSetup& setup, const InitializationOptions& options, InertialState* x) {
  constexpr int kIterations = 8;
  Vector6d weight;
  weight.head<3>().setConstant(1.0 / kPoseRotationSigma_rad);
  weight.tail<3>().setConstant(1.0 / kPosePositionSigma_m);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Matrix15d H = Matrix15d::Zero();
    Vector15d b = Vector15d::Zero();
    const double w_g = 1.0 / (options.sigma_b_g_rad_per_s * options.sigma_b_g_rad_per_s);
    const double w_a = 1.0 / (options.sigma_b_a_m_per_s2 * options.sigma_b_a_m_per_s2);
    // The told biases are unknown, not zero: ten times the first state's uncertainty around zero.
    H.diagonal().segment<3>(9).setConstant(0.01 * w_g);
    H.diagonal().segment<3>(12).setConstant(0.01 * w_a);
    b.segment<3>(9) = -0.01 * w_g * x->biases.b_g;
    b.segment<3>(12) = -0.01 * w_a * x->biases.b_a;
    for (std::size_t k = begin; k < end; ++k) {
      Vector6d r;
      Eigen::Matrix<double, 6, 15> J;
      Evaluate(poses[k], *x, setup.rig.imu, setup.g_G, &r, &J);
      const Eigen::Matrix<double, 6, 15> WJ = weight.asDiagonal() * J;
      H.noalias() += WJ.transpose() * WJ;
      b.noalias() += WJ.transpose() * weight.cwiseProduct(r);
    }
    const Vector15d step = H.ldlt().solve(b);
    if (!step.allFinite()) return false;
    *x = BoxPlus(*x, step);
    if (step.norm() < 1e-10) break;
  }
  return true;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Narrows [*begin, *end) to the poses between the jumps nearest to the instant on either side.
// True where it changed.
bool CutAtJumps(const std::vector<PoseAndDelta>& poses, const InertialState& x,
                const EstimatorSetup& setup, std::size_t* begin, std::size_t* end) {
  std::vector<double> steps_m;
  std::vector<double> steps_rad;
  Vector6d previous;
  for (std::size_t k = *begin; k < *end; ++k) {
    Vector6d r;
    Evaluate(poses[k], x, setup.rig.imu, setup.g_G, &r, nullptr);
    if (k > *begin) {
      steps_rad.push_back((r - previous).head<3>().norm());
      steps_m.push_back((r - previous).tail<3>().norm());
    }
    previous = r;
  }
  if (steps_m.size() < 3) return false;
  const double bound_m = std::max(kMinJump_m, kJumpFactor * Median(steps_m));
  const double bound_rad = std::max(kMinJump_rad, kJumpFactor * Median(steps_rad));
  std::size_t low = *begin;
  std::size_t high = *end;
  for (std::size_t k = *begin + 1; k < *end; ++k) {
    const std::size_t i = k - *begin - 1;
    if (steps_m[i] <= bound_m && steps_rad[i] <= bound_rad) continue;
    if (poses[k].delta.dt_s <= 0.0) {
      low = k;
    } else {
      high = std::min(high, k);
    }
  }
  if (low == *begin && high == *end) return false;
  const bool enough =
      high >= low + kMinPoses && poses[high - 1].delta.dt_s - poses[low].delta.dt_s >= kMinSpan_s;
  if (!enough) return false;  // rather a fit across the jump than none
  *begin = low;
  *end = high;
  return true;
}

}  // namespace

InitializationResult InitializeFromPoses(const std::vector<StampedPose>& poses,
                                         const ImuBuffer& imu, Timestamp instant,
                                         const EstimatorSetup& setup,
                                         const InitializationOptions& options) {
  if (!imu.Covers(instant, instant)) {
    return InitializationFailure{"the IMU does not cover the first frame's instant"};
  }
  // A pose on the far side of the first frame is needed, or one so near that nothing is
  // extrapolated.
  const Timestamp reach = ToNanoseconds(kMaxExtrapolation_s);
  if (poses.empty() || instant < poses.front().timestamp - reach ||
      instant > poses.back().timestamp + reach) {
    return InitializationFailure{"the ground truth's poses do not reach the first frame"};
  }
  const Timestamp half_width = ToNanoseconds(options.fit_half_width_s);
  std::vector<PoseAndDelta> near;
  std::vector<ImuSample> readings;
  const auto first =
      std::lower_bound(poses.begin(), poses.end(), instant - half_width,
                       [](const StampedPose& pose, Timestamp t) { return pose.timestamp < t; });
  for (auto it = first; it != poses.end() && it->timestamp <= instant + half_width; ++it) {
    if (!imu.Covers(it->timestamp, it->timestamp)) continue;
    imu.Extract(instant, it->timestamp, &readings);
    near.push_back({it->T_GB, IntegrateImu(readings, {}, setup.rig.imu, setup.imu_noise,
                                           {.covariance = false, .calibration_jacobians = false})});
  }
  if (near.size() < kMinPoses || near.back().delta.dt_s - near.front().delta.dt_s < kMinSpan_s) {
    return InitializationFailure{"a start from ground truth needs at least " +
                                 std::to_string(kMinPoses) +
                                 " poses over 0.1 s within fit_half_width_s of the first frame, "
                                 "together with IMU; there are " +
                                 std::to_string(near.size())};
  }

  // First guess: the pose nearest in time, the mean velocity between the outermost.
  const auto nearest =
      std::min_element(near.begin(), near.end(), [](const PoseAndDelta& a, const PoseAndDelta& b) {
        return std::abs(a.delta.dt_s) < std::abs(b.delta.dt_s);
      });
  InertialState x;
  x.instant = instant;
  x.nav.R_GB = (nearest->T_GB.R * nearest->delta.R.conjugate()).normalized();
  x.nav.p_GB = nearest->T_GB.p;
  x.nav.v_GB = (near.back().T_GB.p - near.front().T_GB.p) /
               (near.back().delta.dt_s - near.front().delta.dt_s);
  std::size_t begin = 0;
  std::size_t end = near.size();
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    if (!Fit(near, begin, end, setup, options, &x)) {
      return InitializationFailure{
          "the fit of velocity and biases to the ground truth is singular"};
    }
    // Deltas are of first order in the biases: integrate again at the fitted ones, once near.
    for (std::size_t k = begin; k < end; ++k) {
      imu.Extract(instant, near[k].delta.end, &readings);
      near[k].delta = IntegrateImu(readings, x.biases, setup.rig.imu, setup.imu_noise,
                                   {.covariance = false, .calibration_jacobians = false});
    }
    if (!CutAtJumps(near, x, setup, &begin, &end) && round > 0) break;
  }

  InitialCondition result;
  result.state = x;
  result.covariance.setZero();
  const auto square = [](double sigma) { return sigma * sigma; };
  result.covariance.diagonal() << square(options.sigma_tilt_rad), square(options.sigma_tilt_rad),
      square(options.sigma_yaw_rad), Eigen::Vector3d::Constant(square(options.sigma_position_m)),
      Eigen::Vector3d::Constant(square(options.sigma_velocity_m_per_s)),
      Eigen::Vector3d::Constant(square(options.sigma_b_g_rad_per_s)),
      Eigen::Vector3d::Constant(square(options.sigma_b_a_m_per_s2));
  return result;
}

}  // namespace duet
