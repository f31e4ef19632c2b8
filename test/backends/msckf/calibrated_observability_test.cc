// What all measurements of a flight together say of the first state and of the calibration, with
// everything estimated and a rolling shutter: the filter's observability matrix.

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cstdio>
#include <map>
#include <optional>
#include <vector>

#include "backends/msckf/linearization.h"
#include "backends/msckf/nullspace.h"
#include "backends/msckf/transition.h"
#include "common/geometry/so3.h"
#include "common/measurement/triangulation.h"
#include "test/backends/calibrated_flight.h"
#include "test/backends/msckf/random_state.h"

namespace duet {
namespace {

using test::RandomVector;

constexpr int kTrackLength = 10;  // observations with which a track is used; it then starts anew

// Where Jacobians are taken: as Msckf does with first_estimates and rebase_first_estimates, with
// first_estimates alone, and with neither.
enum class Linearized { kRebased, kAtFirstEstimates, kAtCurrentEstimates };

struct LinearizationCase {
  CalibrationPriors priors = test::EverythingEstimated();
  double t_r_s = 0.02;
  Linearized linearized = Linearized::kRebased;
  bool corrected = true;  // false: the path of a filter that is never corrected
};

// A filter's run without its updates: the state is predicted from frame to frame and corrected at
// random at each by about as much as a filter does; every track of ten observations is linearized
// where Msckf would do it. `F_` is the derivative of the whole error (newest state, calibration,
// clones) by the first state's and the calibration's, (15 + c) columns.
class Flight {
 public:
  explicit Flight(const LinearizationCase& setup)
      : case_(setup), recording_(Simulated(setup)), random_(3) {
    for (const ImuSample& sample : recording_.imu) imu_.Add(sample);
    state_.emplace(recording_.told_rig, setup.priors, static_cast<int>(recording_.frames.size()));
    const Timestamp first =
        recording_.frames.front().timestamp + ToNanoseconds(recording_.told_rig.t_d_s);
    state_->Start({recording_.TruthAt(first), Matrix15d::Identity()});
    start_ = state_->inertial().nav;
    const int size = state_->size();
    F_ = Eigen::MatrixXd::Identity(size, size);
    for (const TrackFrameSet& frames : recording_.frames) Advance(frames);
  }

  [[nodiscard]] const CalibrationLayout& layout() const { return state_->layout(); }
  [[nodiscard]] const RigCalibration& told_rig() const { return recording_.told_rig; }
  [[nodiscard]] const NavState& start() const { return start_; }

  // What is not known of each column: start errors of 10 mrad, 0.1 m, 0.1 m/s, 0.01 rad/s,
  // 0.1 m/s^2, and the calibration's prior.
  [[nodiscard]] Eigen::VectorXd units() const {
    Eigen::VectorXd unit(F_.cols());
    unit << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.1),
        Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.01),
        Eigen::Vector3d::Constant(0.1), state_->layout().PriorSigmas();
    return unit;
  }

  // The observability matrix, its columns in those units.
  [[nodiscard]] Eigen::MatrixXd Observability() const {
    Eigen::Index rows = 0;
    for (const Eigen::MatrixXd& block : blocks_) rows += block.rows();
    Eigen::MatrixXd M(rows, F_.cols());
    rows = 0;
    for (const Eigen::MatrixXd& block : blocks_) {
      M.middleRows(rows, block.rows()) = block * units().asDiagonal();
      rows += block.rows();
    }
    return M;
  }

 private:
  static SimulatedRecording Simulated(const LinearizationCase& setup) {
    SimulationOptions options = test::CalibratedFlight(8.0, 0.0, setup.priors);
    options.t_r_s = setup.t_r_s;
    options.camera_rate_hz = 10.0;
    options.max_tracks = 40;
    options.told_errors = {};  // random corrections move the calibration about instead
    if (!setup.corrected) options.noise_scale = 0.0;  // it would leave the truth otherwise
    return Simulate(options);
  }

  void Advance(const TrackFrameSet& frames) {
    const RigCalibration& rig = state_->rig();
    const Timestamp instant = frames.timestamp + ToNanoseconds(rig.t_d_s);
    if (instant > state_->inertial().instant) Propagate(instant);
    state_->Augment(rig.t_d_s);
    const Eigen::Index n = F_.rows();
    F_.conservativeResize(n + state_->clone_size(), Eigen::NoChange);
    F_.bottomRows(state_->clone_size()) = F_.topRows(state_->clone_size());
    for (Clone& clone : state_->clones()) {
      clone.rates.Assign(imu_, clone.instant, 0.03, state_->inertial().biases, rig.imu);
    }
    const int clone = static_cast<int>(state_->clones().size()) - 1;
    for (const TrackObservation& o : frames.frames[0].observations) {
      std::vector<CloneObservation>& track = tracks_[o.track_id];
      track.push_back({clone, {0, Eigen::Vector2d(o.u, o.v)}});
      if (static_cast<int>(track.size()) < kTrackLength) continue;
      Linearize(track);
      track.clear();
    }
    Correct();
  }

  void Propagate(Timestamp instant) {
    std::vector<ImuSample> readings;
    const InertialState& inertial = state_->inertial();
    imu_.Extract(inertial.instant, instant, &readings);
    const ImuDelta delta = IntegrateImu(readings, inertial.biases, state_->rig().imu, {});
    const NavState next = Predict(inertial.nav, delta, recording_.g_G);
    const NavState& start =
        case_.linearized == Linearized::kAtCurrentEstimates ? inertial.nav : state_->nav_fej();
    const Transition t = MakeTransition(delta, start, next, recording_.g_G);
    const std::vector<int>& imu_columns = state_->layout().imu_columns();
    const auto T_count = static_cast<Eigen::Index>(imu_columns.size());
    F_.topRows<9>() = (t.Phi.topRows<9>() * F_.topRows<15>() +
                       t.Gamma(Eigen::all, imu_columns) * F_.middleRows(15, T_count))
                          .eval();
    state_->SetPropagated(next, instant);
  }

  void Linearize(const std::vector<CloneObservation>& track) {
    std::vector<TrackObservationInState> in_states;
    for (const CloneObservation& o : track) {
      const Clone& clone = state_->clones()[o.clone];
      in_states.push_back({{clone.nav, clone.t_d_at_instant_s, &clone.rates}, o.pixel});
    }
    const int anchor = track.front().clone;
    InverseDepth landmark;
    if (Triangulate(state_->rig(), in_states, state_->clones()[anchor].nav.pose(), recording_.g_G,
                    {}, &landmark) != TriangulationStatus::kOk) {
      return;
    }
    VisualColumns columns;
    columns.Assign(*state_);
    LinearizationSettings settings;
    settings.g_G = recording_.g_G;
    settings.separate_first_estimates = case_.linearized == Linearized::kAtFirstEstimates;
    const int count = 2 * kTrackLength;
    LandmarkRows H_f(count, 3);
    MeasurementRows rows(count, columns.width() + 1);
    if (!LinearizeLandmark(*state_, columns, settings, anchor, landmark, track, H_f, rows)) return;
    ProjectNullspace(H_f, rows);
    const std::vector<int> components(columns.components().begin(), columns.components().end());
    blocks_.push_back(rows.bottomRows(count - 3).leftCols(columns.width()) *
                      F_(components, Eigen::all));
  }

  // To where a converged filter stands: scattered about the truth.
  void Correct() {
    Eigen::VectorXd dx(state_->size());
    const auto scatter = [&]() {
      Vector9d error;
      error << RandomVector(&random_, 5e-4), RandomVector(&random_, 3e-3),
          RandomVector(&random_, 1e-2);
      return error;
    };
    const InertialState& inertial = state_->inertial();
    Vector15d error;
    error << scatter(), RandomVector(&random_, 1e-4), RandomVector(&random_, 1e-2);
    dx.head<15>() = BoxMinus(BoxPlus(recording_.TruthAt(inertial.instant), error), inertial);
    const Eigen::VectorXd sigmas = layout().PriorSigmas();
    dx.segment(15, sigmas.size()) =
        BoxMinus(recording_.true_rig, state_->rig(), layout()) +
        0.02 * sigmas.cwiseProduct(random_.NormalVector(static_cast<int>(sigmas.size())));
    for (int i = 0; i < static_cast<int>(state_->clones().size()); ++i) {
      const Clone& clone = state_->clones()[i];
      dx.segment<9>(state_->CloneOffset(i)) =
          BoxMinus(BoxPlus(recording_.TruthAt(clone.instant).nav, scatter()), clone.nav);
    }
    if (!case_.corrected) dx.setZero();
    state_->Correct(dx, {.max_abs_t_d_s = 0.05, .max_abs_t_r_s = 0.05});
    if (case_.linearized != Linearized::kRebased) return;
    // What Rebase does to the covariance, for F.
    const auto rebase = [&](int offset, const NavState& now, const NavState& first) {
      F_.middleRows<3>(offset + 3) -= Hat(now.p_GB - first.p_GB) * F_.middleRows<3>(offset);
      F_.middleRows<3>(offset + 6) -= Hat(now.v_GB - first.v_GB) * F_.middleRows<3>(offset);
    };
    rebase(0, state_->inertial().nav, state_->nav_fej());
    for (int i = 0; i < static_cast<int>(state_->clones().size()); ++i) {
      const Clone& clone = state_->clones()[i];
      rebase(state_->CloneOffset(i), clone.nav, clone.nav_fej);
    }
    state_->Rebase();
  }

  LinearizationCase case_;
  SimulatedRecording recording_;
  Random random_;
  ImuBuffer imu_;
  NavState start_;
  std::optional<FilterState> state_;
  Eigen::MatrixXd F_;
  std::map<std::uint64_t, std::vector<CloneObservation>> tracks_;
  std::vector<Eigen::MatrixXd> blocks_;
};

// What counts as zero of singular values over the largest: rounding leaves 1e-16, or 1e-14 where
// directions are null by the integrator's Jacobians rather than term by term, and what is observed
// lies above 1e-6.
constexpr double kZero = 1e-12;
constexpr double kObserved = 1e-6;

// How many directions are null; prints the singular values about the gap and checks that there is
// one.
int NullDirections(const char* what, const Flight& flight) {
  const Eigen::MatrixXd M = flight.Observability();
  Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(M).singularValues();
  std::printf("%s, %ld rows, singular values 1 ...", what, static_cast<long>(M.rows()));
  values /= values[0];
  for (Eigen::Index i = values.size() - 9; i < values.size(); ++i) std::printf(" %.1e", values[i]);
  std::printf("\n");
  EXPECT_FALSE(((values.array() > kZero) && (values.array() < kObserved)).any()) << what;
  return static_cast<int>((values.array() < kZero).count());
}

TEST(CalibratedObservability, ExactlyFourDirectionsAreUnobservableWithFirstEstimates) {
  for (const Linearized linearized : {Linearized::kRebased, Linearized::kAtFirstEstimates}) {
    const Flight flight({.linearized = linearized});
    ASSERT_EQ(flight.layout().size(), 41);
    EXPECT_EQ(NullDirections("first estimates", flight), 4);

    // They are a turn about gravity and a shift; the calibration has no part in them.
    const NavState& first = flight.start();
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(15 + flight.layout().size(), 4);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    N.block<3, 1>(0, 0) = up;
    N.block<3, 1>(3, 0) = up.cross(first.p_GB);
    N.block<3, 1>(6, 0) = up.cross(first.v_GB);
    N.block<3, 3>(3, 1).setIdentity();
    const Eigen::MatrixXd M = flight.Observability() * flight.units().cwiseInverse().asDiagonal();
    EXPECT_LT((M * N).norm(), 1e-12 * M.norm());
  }
}

TEST(CalibratedObservability, HeadingIsFalselyObservedWithCurrentEstimates) {
  EXPECT_EQ(
      NullDirections("current estimates", Flight({.linearized = Linearized::kAtCurrentEstimates})),
      3);
}

// With imu_frame free the body's axes are null too, along one consistent path: the truth's.
TEST(CalibratedObservability, SevenDirectionsAreUnobservableWithTheGaugeFree) {
  const CalibrationPriors free = test::EverythingEstimated(ImuFrame::kFree);
  EXPECT_EQ(NullDirections("gauge free, global shutter, truth",
                           Flight({.priors = free, .t_r_s = 0.0, .corrected = false})),
            7);
  // First estimates are made for the other four: a filter that is corrected on its way observes
  // the axes, falsely.
  EXPECT_EQ(NullDirections("gauge free, global shutter", Flight({.priors = free, .t_r_s = 0.0})),
            4);
  // So does a rolling shutter, along the truth: a row's pose comes by the IMU's rates, which turn
  // with the axes, and whose derivatives are left out within tau (DESIGN.md section 3).
  EXPECT_EQ(NullDirections("gauge free, rolling shutter, truth",
                           Flight({.priors = free, .corrected = false})),
            4);
}

// How much the pixels say of a turn of the axes, as a share of what they say of the same turn of
// the camera alone: nothing, but for the frozen rates, which leave about |omega| tau.
TEST(CalibratedObservability, FrozenRatesTellTheAxesByTheTurnWithinTheReadout) {
  for (const double t_r_s : {0.0, 0.02}) {
    const Flight flight(
        {.priors = test::EverythingEstimated(ImuFrame::kFree), .t_r_s = t_r_s, .corrected = false});
    const Eigen::MatrixXd M = flight.Observability() * flight.units().cwiseInverse().asDiagonal();
    double share = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d phi = Eigen::Vector3d::Unit(axis);  // x_B' = Exp(phi) x_B
      const RigCalibration& rig = flight.told_rig();
      const int R_CB = 15 + flight.layout().OffsetOf(CalibrationBlock::kExtrinsicRotation, 0);
      Eigen::VectorXd camera = Eigen::VectorXd::Zero(M.cols());
      camera.segment<3>(R_CB) = -(rig.cameras[0].R_CB * phi);
      Eigen::VectorXd axes = camera;
      axes.head<3>() = -(flight.start().R_GB * phi);
      const auto turn = [&](CalibrationBlock block, const Eigen::Matrix3d& T) {
        const Eigen::Matrix3d change = -T * Hat(phi);
        axes.segment<9>(15 + flight.layout().OffsetOf(block)) =
            change.transpose().reshaped();  // by rows
      };
      turn(CalibrationBlock::kTg, rig.imu.T_g);
      turn(CalibrationBlock::kTs, rig.imu.T_s);
      turn(CalibrationBlock::kTa, rig.imu.T_a);
      share = std::max(share, (M * axes).norm() / (M * camera).norm());
    }
    std::printf("t_r %g s: a turn of the axes is seen by %.1e of the camera's\n", t_r_s, share);
    if (t_r_s == 0.0) {
      EXPECT_LT(share, 1e-9);
    } else {
      EXPECT_LT(share, 0.02);
      EXPECT_GT(share, 1e-4);
    }
  }
}

}  // namespace
}  // namespace duet
