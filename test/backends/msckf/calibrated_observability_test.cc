// What all measurements of a flight together say of the first state and of the calibration, with
// everything estimated and a rolling shutter: the filter's observability matrix.

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cstdio>
#include <map>
#include <vector>

#include "backends/msckf/linearization.h"
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

struct Case {
  CalibrationPriors priors = test::EverythingEstimated();
  double t_r_s = 0.02;
  Linearized linearized = Linearized::kRebased;
  double correction = 1.0;  // times the usual size; 0: the path of a filter that is never corrected
};

// A filter's run without its updates: the state is predicted from frame to frame and corrected at
// random at each by as much as a filter does; every track of ten observations is linearized where
// Msckf would do it. `F` is the derivative of the whole error (newest state, calibration, clones)
// by the first state's and the calibration's, (15 + c) columns.
class Flight {
 public:
  explicit Flight(const Case& setup) : case_(setup), recording_(Simulated(setup)), random_(3) {
    for (const ImuSample& sample : recording_.imu) imu_.Add(sample);
    state_.emplace(recording_.told_rig, setup.priors, static_cast<int>(recording_.frames.size()));
    const Timestamp first =
        recording_.frames.front().timestamp + ToNanoseconds(recording_.told_rig.t_d_s);
    state_->Start({recording_.TruthAt(first), Matrix15d::Identity()});
    const int size = state_->size();
    F_ = Eigen::MatrixXd::Identity(size, size);
    for (const TrackFrameSet& frames : recording_.frames) Advance(frames);
  }

  [[nodiscard]] const CalibrationLayout& layout() const { return state_->layout(); }

  // The observability matrix, every column in units of what is not known of it: start errors of
  // 10 mrad, 0.1 m, 0.1 m/s, 0.01 rad/s, 0.1 m/s^2, and the calibration's prior.
  [[nodiscard]] Eigen::MatrixXd Observability() const {
    Eigen::VectorXd unit(F_.cols());
    unit << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.1),
        Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.01),
        Eigen::Vector3d::Constant(0.1), state_->layout().PriorSigmas();
    Eigen::Index rows = 0;
    for (const Eigen::MatrixXd& block : blocks_) rows += block.rows();
    Eigen::MatrixXd M(rows, F_.cols());
    rows = 0;
    for (const Eigen::MatrixXd& block : blocks_) {
      M.middleRows(rows, block.rows()) = block * unit.asDiagonal();
      rows += block.rows();
    }
    return M;
  }

 private:
  static SimulatedRecording Simulated(const Case& setup) {
    SimulationOptions options = test::CalibratedFlight(8.0, 0.0, setup.priors);
    options.t_r_s = setup.t_r_s;
    options.camera_rate_hz = 10.0;
    options.max_tracks = 40;
    SimulatedRecording recording = Simulate(options);
    if (setup.t_r_s == 0.0) recording.told_rig.t_r_s = 0.0;
    return recording;
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
    const NavState& start = case_.linearized == Linearized::kAtCurrentEstimates
                                ? inertial.nav
                                : state_->nav_fej();
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

  // Of about the size of a filter's corrections once it has converged.
  void Correct() {
    Eigen::VectorXd dx(state_->size());
    const auto draw = [&](int offset) {
      dx.segment<9>(offset) << RandomVector(&random_, 5e-4), RandomVector(&random_, 2e-3),
          RandomVector(&random_, 1e-2);
    };
    draw(0);
    dx.segment<6>(9) << RandomVector(&random_, 1e-4), RandomVector(&random_, 2e-3);
    for (int i = 0; i < state_->layout().size(); ++i) {
      dx[15 + i] = 0.02 * state_->layout().PriorSigmas()[i] * random_.Normal();
    }
    for (int i = 0; i < static_cast<int>(state_->clones().size()); ++i) {
      draw(state_->CloneOffset(i));
    }
    dx *= case_.correction;
    state_->Correct(dx, 0.05, 0.05);
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

  Case case_;
  SimulatedRecording recording_;
  Random random_;
  ImuBuffer imu_;
  std::optional<FilterState> state_;
  Eigen::MatrixXd F_;
  std::map<std::uint64_t, std::vector<CloneObservation>> tracks_;
  std::vector<Eigen::MatrixXd> blocks_;
};

// The singular values, over the largest; prints those about the gap.
Eigen::VectorXd SingularValues(const char* what, const Eigen::MatrixXd& M) {
  Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(M).singularValues();
  std::printf("%s: %ld x %ld, largest %.1e, then of it", what, static_cast<long>(M.rows()),
              static_cast<long>(M.cols()), values[0]);
  values /= values[0];
  for (Eigen::Index i = values.size() - 9; i < values.size(); ++i) std::printf(" %.1e", values[i]);
  std::printf("\n");
  return values;
}

TEST(CalibratedObservability, Explore) {
  for (double t_r : {0.02, 0.0})
  for (double corr : {1.0, 0.0})
  for (ImuFrame frame : {ImuFrame::kGyroscope, ImuFrame::kFree})
    for (const Linearized l : {Linearized::kRebased, Linearized::kAtFirstEstimates,
                             Linearized::kAtCurrentEstimates}) {
    Case c;
    c.priors = test::EverythingEstimated(frame);
    c.linearized = l;
    c.t_r_s = t_r;
    c.correction = corr;
    const Flight flight(c);
    std::printf("t_r %g corr %g frame %d linearized %d ", t_r, corr, (int)frame, (int)l);
    SingularValues("filter", flight.Observability());
  }
}

}  // namespace
}  // namespace duet
