// Which directions of the state a window of measurements says nothing of: with first estimates
// exactly four (a turn about gravity and a shift), as in truth; with Jacobians at whatever is
// current only three, because heading gains information that nobody measured.

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "backends/msckf/linearization.h"
#include "backends/msckf/nullspace.h"
#include "backends/msckf/transition.h"
#include "common/geometry/so3.h"
#include "test/backends/msckf/random_state.h"

namespace duet {
namespace {

using test::kGravity;
using test::RandomVector;

constexpr int kClones = 16;
constexpr int kLandmarks = 25;

// A filter's history: the state is predicted from frame to frame, and corrected at each.
struct History {
  FilterState state;
  std::vector<Transition> first;    // between first estimates
  std::vector<Transition> current;  // from the corrected state to its prediction
};

History MakeHistory(Random* random) {
  const ImuBuffer imu = test::MovingImu();
  History history{FilterState(test::StereoRig(), CalibrationPriors(), kClones), {}, {}};
  FilterState& state = history.state;
  InitialCondition initial;
  initial.state.instant = ToNanoseconds(0.3);
  initial.state.nav.p_GB = Eigen::Vector3d(3, -2, 1);
  initial.state.nav.v_GB = Eigen::Vector3d(1.0, 0.2, 0.0);
  state.Start(initial);
  NavState corrected = initial.state.nav;
  for (int i = 0; i < kClones; ++i) {
    if (i > 0) {
      const Timestamp t_0 = state.inertial().instant;
      const Timestamp t_1 = t_0 + ToNanoseconds(0.05);
      std::vector<ImuSample> readings;
      imu.Extract(t_0, t_1, &readings);
      const ImuDelta delta = IntegrateImu(readings, initial.state.biases, state.rig().imu, {});
      const NavState first = state.nav_fej();
      const NavState predicted = Predict(corrected, delta, kGravity);
      history.first.push_back(MakeTransition(delta, first, predicted, kGravity));
      history.current.push_back(MakeTransition(delta, corrected, predicted, kGravity));
      state.SetPropagated(predicted, t_1);
    }
    state.Augment(0.0);
    Vector9d correction;
    correction << RandomVector(random, 2e-3), RandomVector(random, 0.01),
        RandomVector(random, 0.02);
    corrected = BoxPlus(state.inertial().nav, correction);
    state.clones().back().nav = corrected;
  }
  return history;
}

// The measurements of all landmarks against the error (15) of the first state, without their noise:
// each landmark's projected rows times the transitions from the first state to its clones.
Eigen::MatrixXd Observability(const History& history, bool first_estimates, Random* random) {
  const FilterState& state = history.state;
  std::vector<Matrix15d> from_start = {Matrix15d::Identity()};
  for (const Transition& t : first_estimates ? history.first : history.current) {
    from_start.push_back(t.Phi * from_start.back());
  }
  VisualColumns columns;
  columns.Assign(state);
  LinearizationSettings settings;
  settings.separate_first_estimates = first_estimates;
  std::vector<Eigen::MatrixXd> blocks;
  for (int l = 0; l < kLandmarks; ++l) {
    const int first_clone = l % (kClones - 5);
    std::vector<CloneObservation> observations;
    for (int clone = first_clone; clone < first_clone + 6; ++clone) {
      observations.push_back({clone, {0, Eigen::Vector2d(300, 200)}});
    }
    LandmarkRows H_f(12, 3);
    MeasurementRows rows(12, columns.width() + 1);
    EXPECT_TRUE(LinearizeLandmark(state, columns, settings, first_clone,
                                  test::RandomLandmark(random), observations, H_f, rows));
    ProjectNullspace(H_f, rows);
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(9, 15);
    for (int clone = 0; clone < kClones; ++clone) {
      block += rows.bottomRows(9).middleCols(columns.CloneColumn(clone), 6) *
               from_start[clone].topRows(6);
    }
    blocks.push_back(block);
  }
  Eigen::MatrixXd M(9 * kLandmarks, 15);
  for (int l = 0; l < kLandmarks; ++l) M.middleRows(9 * l, 9) = blocks[l];
  return M;
}

// Singular values that are zero to rounding: 1e-13 of the largest. Those of directions that are
// observed lie above 1e-7 here.
int NullDirections(const Eigen::MatrixXd& M) {
  const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(M).singularValues();
  return static_cast<int>((values.array() < 1e-12 * values[0]).count());
}

TEST(Observability, ExactlyFourDirectionsAreUnobservableWithFirstEstimates) {
  Random random(1);
  const History history = MakeHistory(&random);
  const Eigen::MatrixXd M = Observability(history, true, &random);
  EXPECT_EQ(NullDirections(M), 4);

  Eigen::Matrix<double, 15, 4> N = Eigen::Matrix<double, 15, 4>::Zero();
  const Eigen::Vector3d up = -kGravity.normalized();
  const NavState& first = history.state.clones().front().nav_fej;
  N.block<3, 1>(0, 0) = up;
  N.block<3, 1>(3, 0) = up.cross(first.p_GB);
  N.block<3, 1>(6, 0) = up.cross(first.v_GB);
  N.block<3, 3>(3, 1).setIdentity();
  EXPECT_LT((M * N).norm(), 1e-11 * M.norm());
}

TEST(Observability, HeadingIsFalselyObservedWithCurrentEstimates) {
  Random random(1);
  const History history = MakeHistory(&random);
  EXPECT_EQ(NullDirections(Observability(history, false, &random)), 3);
}

}  // namespace
}  // namespace duet
