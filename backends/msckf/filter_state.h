#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "backends/estimator.h"
#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"
#include "common/measurement/rate_profile.h"

namespace duet {

/// A pose of the sliding window (6.2.2): the state at the instant of a frame, copied when the frame
/// came (6.4).
struct Clone {
  std::uint64_t id = 0;  ///< counts up; observations refer to it
  Timestamp instant = 0;
  double t_d_at_instant_s = 0.0;  ///< the t_d that the instant was made with
  NavState nav;                   ///< current estimate; v is only kept up where times matter
  NavState nav_fej;               ///< where Jacobians are taken, see FilterState
  RateProfile rates;  ///< the motion around the instant; empty where times do not matter
};

/// The filter's state and covariance. The error state is, in this order,
///
///   +------------------------+-------------------+-------------+-------------+- ...
///   | theta  p  v  b_g  b_a  | calibration       | theta  p  v | theta  p  v |
///   +------------------------+-------------------+-------------+-------------+- ...
///     0 .. 14, newest state    15 .. 15 + c - 1    oldest clone    next clone
///
/// with the estimated calibration in CalibrationLayout's order (c components). A clone's velocity
/// is there to estimate the times (6.2.2): where t_d and t_r are fixed and t_r is zero, no
/// measurement depends on it, and clones are (theta, p) only. The covariance lies in the leading
/// corner of one matrix that is allocated once, for max_clones clones.
///
/// First estimates. Every Jacobian is taken at x_fej, and the covariance's unobservable directions
/// are those at x_fej. A clone's is its value when it was made, and stays (Huang, Mourikis and
/// Roumeliotis 2010), or it follows the corrections with the covariance (Rebase).
class FilterState {
 public:
  static constexpr int kNavSize = 15;

  FilterState(const RigCalibration& rig, const CalibrationPriors& priors, int max_clones);

  /// The first state, the calibration's priors, no clones.
  void Start(const InitialCondition& initial);

  [[nodiscard]] int size() const { return CloneOffset(static_cast<int>(clones_.size())); }
  [[nodiscard]] int CalibrationOffset() const { return kNavSize; }
  [[nodiscard]] int CloneOffset(int clone) const {
    return kNavSize + layout_.size() + clone_size_ * clone;
  }
  /// Components of a clone: 9 (theta, p, v), or 6 without v.
  [[nodiscard]] int clone_size() const { return clone_size_; }
  /// True where pixels may be taken at another time than their state's instant: t_d or t_r is
  /// estimated, or t_r is not zero.
  [[nodiscard]] bool time_matters() const { return time_matters_; }

  [[nodiscard]] const InertialState& inertial() const { return inertial_; }
  [[nodiscard]] const NavState& nav_fej() const { return nav_fej_; }
  [[nodiscard]] const RigCalibration& rig() const { return rig_; }
  [[nodiscard]] const CalibrationLayout& layout() const { return layout_; }
  [[nodiscard]] const std::vector<Clone>& clones() const { return clones_; }
  [[nodiscard]] std::vector<Clone>& clones() { return clones_; }
  /// Index of the clone with this id; CHECKs that it is in the window.
  [[nodiscard]] int CloneIndex(std::uint64_t id) const;

  [[nodiscard]] Eigen::Ref<Eigen::MatrixXd> P() { return P_.topLeftCorner(size(), size()); }
  [[nodiscard]] Eigen::Ref<const Eigen::MatrixXd> P() const {
    return P_.topLeftCorner(size(), size());
  }

  /// Replaces the navigation state by the propagated one; its value is its first estimate. The
  /// covariance is Propagate's (propagation.h).
  void SetPropagated(const NavState& nav, Timestamp instant);

  /// Appends a clone of the newest state (6.18). The clone's error is the state's own.
  void Augment(double t_d_at_instant_s);
  /// Drops a clone with its rows and columns (6.6).
  void RemoveClone(int clone);

  /// x (+) dx (6.35) for the whole state; first estimates stay. t_d and t_r are kept within the
  /// bounds.
  void Correct(const Eigen::Ref<const Eigen::VectorXd>& dx, const TimeBounds& bounds);

  /// Takes the current values as first estimates, and the covariance with them:
  ///
  ///   P <- M P M',   M: p_i += -[p_i - p_i,fej]x theta_i,   v_i += -[v_i - v_i,fej]x theta_i
  ///
  /// M is the identity but for the correction, and takes the unobservable directions at the old
  /// values to those at the new ones, N(x) = M N(x_fej): what could not be observed stays so,
  /// exactly, while Jacobians are taken at the best values known. (M is the change of coordinates
  /// after which the error of a right-invariant filter, theta with p + [p]x theta and v + [v]x
  /// theta, keeps its covariance; Zhang et al., "Convergence and consistency analysis for a 3-D
  /// invariant-EKF SLAM", 2017.) Fixed first estimates of an inexact start stay wrong instead: the
  /// Jacobians of the whole first window are.
  void Rebase();

 private:
  CalibrationLayout layout_;
  bool time_matters_;
  int clone_size_;
  int max_clones_;
  RigCalibration rig_;
  InertialState inertial_;
  NavState nav_fej_;
  std::vector<Clone> clones_;
  std::uint64_t next_clone_id_ = 0;
  Eigen::MatrixXd P_;
};

/// Drops components [first, first + count) of an n x n covariance in place; the rest moves up.
void RemoveComponents(Eigen::Ref<Eigen::MatrixXd> P, int first, int count);
/// Appends copies of components [first, first + count) to the leading n x n corner of P, which must
/// be at least n + count wide (6.18 with J_pi an identity on those components).
void DuplicateComponents(Eigen::Ref<Eigen::MatrixXd> P, int n, int first, int count);

}  // namespace duet
