#include "backends/msckf/filter_state.h"

#include <algorithm>

#include "common/geometry/so3.h"
#include "common/support/logging.h"

namespace duet {

FilterState::FilterState(const RigCalibration& rig, const CalibrationPriors& priors, int max_clones)
    : layout_(priors, rig),
      time_matters_(PixelsLeaveTheInstant(priors, rig)),
      clone_size_(time_matters_ ? 9 : 6),
      max_clones_(max_clones),
      rig_(rig) {
  const int capacity = CloneOffset(max_clones);
  P_ = Eigen::MatrixXd::Zero(capacity, capacity);
  clones_.reserve(max_clones);
}

void FilterState::Start(const InitialCondition& initial) {
  inertial_ = initial.state;
  nav_fej_ = initial.state.nav;
  clones_.clear();
  P_.setZero();
  P_.topLeftCorner<kNavSize, kNavSize>() = initial.covariance;
  const int at = CalibrationOffset();
  const int size = layout_.size();
  const Eigen::VectorXd variances = layout_.PriorSigmas().cwiseAbs2();
  P_.diagonal().segment(at, size) = variances;
  if (const Eigen::MatrixXd& gain = initial.calibration_gain; gain.size() > 0) {
    const Eigen::MatrixXd cross = gain * variances.asDiagonal();
    P_.block(0, at, kNavSize, size) = cross;
    P_.block(at, 0, size, kNavSize) = cross.transpose();
    P_.topLeftCorner<kNavSize, kNavSize>() += cross * gain.transpose();
  }
}

int FilterState::CloneIndex(std::uint64_t id) const {
  const auto it =
      std::lower_bound(clones_.begin(), clones_.end(), id,
                       [](const Clone& clone, std::uint64_t x) { return clone.id < x; });
  CHECK(it != clones_.end() && it->id == id) << "clone " << id << " is not in the window";
  return static_cast<int>(it - clones_.begin());
}

void FilterState::SetPropagated(const NavState& nav, Timestamp instant) {
  inertial_.nav = nav;
  inertial_.instant = instant;
  nav_fej_ = nav;
}

void FilterState::Augment(double t_d_at_instant_s) {
  CHECK_LT(static_cast<int>(clones_.size()), max_clones_);
  DuplicateComponents(P_, size(), 0, clone_size_);
  Clone clone;
  clone.id = next_clone_id_++;
  clone.instant = inertial_.instant;
  clone.t_d_at_instant_s = t_d_at_instant_s;
  clone.nav = inertial_.nav;
  clone.nav_fej = nav_fej_;
  clones_.push_back(std::move(clone));
}

void FilterState::RemoveClone(int clone) {
  RemoveComponents(P(), CloneOffset(clone), clone_size_);
  clones_.erase(clones_.begin() + clone);
}

void FilterState::Correct(const Eigen::Ref<const Eigen::VectorXd>& dx, const TimeBounds& bounds) {
  inertial_ = BoxPlus(inertial_, Vector15d(dx.head<kNavSize>()));
  if (layout_.size() > 0) {
    rig_ = BoxPlus(rig_, layout_, dx.segment(CalibrationOffset(), layout_.size()));
    HoldTimes(layout_, bounds, &rig_);
  }
  for (int i = 0; i < static_cast<int>(clones_.size()); ++i) {
    Vector9d error = Vector9d::Zero();
    error.head(clone_size_) = dx.segment(CloneOffset(i), clone_size_);
    clones_[i].nav = BoxPlus(clones_[i].nav, error);
  }
}

void FilterState::Rebase() {
  Eigen::Ref<Eigen::MatrixXd> P_all = P();
  const auto add_rotation = [&](int component, int theta, const Eigen::Vector3d& moved) {
    const Eigen::Matrix3d M = -Hat(moved);
    // Neither product is of what it is added to: no temporaries are needed.
    P_all.middleRows<3>(component) += M.lazyProduct(P_all.middleRows<3>(theta));
    P_all.middleCols<3>(component) += P_all.middleCols<3>(theta).lazyProduct(M.transpose());
  };
  const auto rebase = [&](int offset, bool with_velocity, const NavState& nav, NavState* fej) {
    add_rotation(offset + 3, offset, nav.p_GB - fej->p_GB);
    if (with_velocity) add_rotation(offset + 6, offset, nav.v_GB - fej->v_GB);
    *fej = nav;
  };
  rebase(0, true, inertial_.nav, &nav_fej_);
  for (int i = 0; i < static_cast<int>(clones_.size()); ++i) {
    rebase(CloneOffset(i), time_matters_, clones_[i].nav, &clones_[i].nav_fej);
  }
}

void RemoveComponents(Eigen::Ref<Eigen::MatrixXd> P, int first, int count) {
  const auto n = P.rows();
  const auto after = n - first - count;
  // Ascending copies within a column: the source always lies ahead of what has been written.
  for (Eigen::Index j = 0; j < n - count; ++j) {
    const auto from = j < first ? j : j + count;
    for (Eigen::Index i = 0; i < first; ++i) P(i, j) = P(i, from);
    for (Eigen::Index i = first; i < first + after; ++i) P(i, j) = P(i + count, from);
  }
}

void DuplicateComponents(Eigen::Ref<Eigen::MatrixXd> P, int n, int first, int count) {
  CHECK_LE(n + count, P.rows());
  P.block(n, 0, count, n) = P.block(first, 0, count, n);
  P.block(0, n, n, count) = P.block(0, first, n, count);
  P.block(n, n, count, count) = P.block(first, first, count, count);
}

}  // namespace duet
