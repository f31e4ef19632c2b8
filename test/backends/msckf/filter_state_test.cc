// The layout of state and covariance: augmentation, removal, correction, first estimates.

#include "backends/msckf/filter_state.h"

#include <gtest/gtest.h>

#include "common/geometry/so3.h"
#include "test/backends/msckf/random_state.h"

namespace duet {
namespace {

using test::RandomCovariance;

CalibrationPriors WithTimes() {
  CalibrationPriors priors;
  priors.p_CB.estimated = true;
  priors.t_d.estimated = true;
  return priors;
}

TEST(FilterState, StartsWithThePriorsOfTheCalibration) {
  FilterState state(test::StereoRig(), WithTimes(), 5);
  InitialCondition initial;
  initial.covariance = 2.0 * Matrix15d::Identity();
  state.Start(initial);
  ASSERT_EQ(state.size(), 15 + 3 + 3 + 1);
  EXPECT_EQ(state.P()(0, 0), 2.0);
  EXPECT_DOUBLE_EQ(state.P()(15, 15), 0.02 * 0.02);
  EXPECT_DOUBLE_EQ(state.P()(21, 21), 0.01 * 0.01);
  EXPECT_EQ(state.P()(15, 16), 0.0);
}

TEST(FilterState, ClonesHoldVelocityOnlyWhereTimesMatter) {
  EXPECT_EQ(FilterState(test::StereoRig(), CalibrationPriors(), 5).clone_size(), 6);
  EXPECT_EQ(FilterState(test::StereoRig(), WithTimes(), 5).clone_size(), 9);
  RigCalibration rolling = test::StereoRig();
  rolling.t_r_s = 0.02;
  EXPECT_EQ(FilterState(rolling, CalibrationPriors(), 5).clone_size(), 9);
}

// 6.18: P <- [I; J] P [I; J]'.
TEST(FilterState, AugmentationCopiesTheNewestStatesError) {
  Random random(1);
  FilterState state = test::RandomState(&random, test::StereoRig(), WithTimes(), 4);
  const int n = state.size();
  state.RemoveClone(0);
  const Eigen::MatrixXd P = state.P();
  const int m = n - 9;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, m);
  J.topRows(m).setIdentity();
  J.block<9, 9>(m, 0).setIdentity();
  state.Augment(0.001);
  EXPECT_LT((Eigen::MatrixXd(state.P()) - J * P * J.transpose()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(state.clones().back().nav.p_GB, state.inertial().nav.p_GB);
  EXPECT_EQ(state.clones().back().t_d_at_instant_s, 0.001);
}

TEST(FilterState, RemovalKeepsEverythingElse) {
  Random random(2);
  for (int removed = 0; removed < 4; ++removed) {
    FilterState state = test::RandomState(&random, test::StereoRig(), WithTimes(), 4);
    const Eigen::MatrixXd P = state.P();
    std::vector<int> kept;
    for (int i = 0; i < state.size(); ++i) {
      if (i < state.CloneOffset(removed) || i >= state.CloneOffset(removed + 1)) kept.push_back(i);
    }
    const std::uint64_t gone = state.clones()[removed].id;
    state.RemoveClone(removed);
    EXPECT_TRUE(state.P() == P(kept, kept));
    for (const Clone& clone : state.clones()) EXPECT_NE(clone.id, gone);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(state.CloneIndex(state.clones()[i].id), i);
  }
}

TEST(FilterState, CorrectionIsBoxPlusOfEveryPart) {
  Random random(3);
  FilterState state = test::RandomState(&random, test::StereoRig(), WithTimes(), 3);
  Eigen::VectorXd dx(state.size());
  for (Eigen::Index i = 0; i < dx.size(); ++i) dx[i] = 1e-3 * random.Normal();
  const FilterState before = state;
  state.Correct(dx, {});
  // Differences of numbers of size 5 hold 1e-15.
  EXPECT_LT((BoxMinus(state.inertial(), before.inertial()) - dx.head<15>()).norm(), 1e-14);
  EXPECT_LT((BoxMinus(state.rig(), before.rig(), state.layout()) - dx.segment(15, 7)).norm(),
            1e-14);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((BoxMinus(state.clones()[i].nav, before.clones()[i].nav) -
               dx.segment<9>(state.CloneOffset(i)))
                  .norm(),
              1e-14);
    EXPECT_EQ(state.clones()[i].nav_fej.p_GB, before.clones()[i].nav_fej.p_GB);
  }
}

TEST(FilterState, TimeOffsetStaysWithinItsBound) {
  Random random(4);
  FilterState state = test::RandomState(&random, test::StereoRig(), WithTimes(), 3);
  Eigen::VectorXd dx = Eigen::VectorXd::Zero(state.size());
  dx[15 + 6] = 0.5;
  state.Correct(dx, {.max_abs_t_d_s = 0.02, .max_abs_t_r_s = 0.0});
  EXPECT_EQ(state.rig().t_d_s, 0.02);
}

// Turning about gravity and shifting, of the whole error state.
Eigen::MatrixXd Unobservable(const FilterState& state) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(state.size(), 4);
  const auto fill = [&](int offset, const NavState& nav) {
    N.block<3, 1>(offset, 0) = up;
    N.block<3, 1>(offset + 3, 0) = up.cross(nav.p_GB);
    N.block<3, 1>(offset + 6, 0) = up.cross(nav.v_GB);
    N.block<3, 3>(offset + 3, 1).setIdentity();
  };
  fill(0, state.nav_fej());
  for (int i = 0; i < static_cast<int>(state.clones().size()); ++i) {
    fill(state.CloneOffset(i), state.clones()[i].nav_fej);
  }
  return N;
}

// What P does not know of the unobservable directions before, it does not know after: with
// P = X + N A N', Rebase gives M X M' + N' A N'' with N' those at the current values.
TEST(FilterState, RebaseCarriesUnobservableDirectionsAlong) {
  Random random(5);
  FilterState state = test::RandomState(&random, test::StereoRig(), WithTimes(), 4);
  const Eigen::MatrixXd X = state.P();
  FilterState plain = state;
  plain.Rebase();
  FilterState shifted = state;
  const Eigen::MatrixXd A = 100.0 * RandomCovariance(&random, 4);
  const Eigen::MatrixXd N = Unobservable(state);
  shifted.P() = X + N * A * N.transpose();
  shifted.Rebase();
  const Eigen::MatrixXd N_current = Unobservable(shifted);
  EXPECT_GT((N_current - N).norm(), 0.05);
  EXPECT_LT((Eigen::MatrixXd(shifted.P()) - Eigen::MatrixXd(plain.P()) -
             N_current * A * N_current.transpose())
                .cwiseAbs()
                .maxCoeff(),
            1e-14 * shifted.P().norm());
  for (const Clone& clone : shifted.clones()) EXPECT_EQ(clone.nav.p_GB, clone.nav_fej.p_GB);
}

}  // namespace
}  // namespace duet
