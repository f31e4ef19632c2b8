// What the window's accumulated prior, and the prior with the window's factors, say of a frame and
// of the calibration, with everything estimated and a rolling shutter.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "backends/window/window_estimator.h"
#include "experiments/imu_feed.h"
#include "test/backends/calibrated_flight.h"

namespace duet {
namespace {

// A start that says next to nothing of yaw and position; not less, or rounding swallows it (the
// information matrix holds 1e9 / rad^2).
constexpr double kStartYawSigma_rad = 10.0;
constexpr double kStartPositionSigma_m = 30.0;
// The calibration is known a hundred times worse than usual: alone, its prior gives singular values
// of 0.01 in the units below.
constexpr double kPriorScale = 100.0;

// Units of the components of a frame: what is not known of them at a usual start.
Vector15d FrameUnits() {
  Vector15d unit;
  unit << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.1),
      Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.01),
      Eigen::Vector3d::Constant(0.1);
  return unit;
}

// A turn about gravity and the shifts, over a frame and `calibration_size` components.
Eigen::MatrixXd TurnAndShifts(const NavState& nav, int calibration_size) {
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(kFrameSize + calibration_size, 4);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  N.block<3, 1>(0, 0) = up;
  N.block<3, 1>(3, 0) = up.cross(nav.p_GB);
  N.block<3, 1>(6, 0) = up.cross(nav.v_GB);
  N.block<3, 3>(3, 1).setIdentity();
  return N;
}

// The marginal information on one frame and the calibration, singular values (square roots of its
// eigenvalues) in units of FrameUnits and the calibration's usual priors, descending, and the
// information along the unobservable directions.
struct Information {
  Eigen::VectorXd singular_values;
  Eigen::Vector4d along;
};

class CalibratedWindow {
 public:
  explicit CalibratedWindow(bool first_estimates)
      : recording_(Simulated()),
        shared_(Shared()),
        setup_(MakeSetup(recording_, shared_)),
        reprojection_{setup_.g_G, shared_.pixel_noise_px, true} {
    options_.first_estimates = first_estimates;
    options_.min_depth_sigmas = 0.0;  // so unsure a start knows no depth
    estimator_.emplace(setup_, options_);
    start_ = recording_.TruthAt(recording_.frames.front().timestamp +
                                ToNanoseconds(recording_.told_rig.t_d_s));
    start_.nav.v_GB.setZero();
    Vector15d sigma = FrameUnits();
    sigma[2] = kStartYawSigma_rad;
    sigma.segment<3>(3).setConstant(kStartPositionSigma_m);
    estimator_->Initialize({start_, Matrix15d(sigma.cwiseAbs2().asDiagonal())});
    ImuFeed feed(recording_.imu);
    for (const TrackFrameSet& frames : recording_.frames) {
      feed.Advance(frames.timestamp + ToNanoseconds(ImuHorizon(shared_)), &*estimator_);
      const EstimatorOutput& output = estimator_->ProcessFrame(frames);
      EXPECT_NE(output.status, EstimatorStatus::kFailed) << output.reason;
      rig_ = output.rig;
      keyframes_ += output.keyframe ? 1 : 0;
    }
  }

  [[nodiscard]] int keyframes() const { return keyframes_; }
  [[nodiscard]] int frame_count() const { return static_cast<int>(estimator_->frames().size()); }

  // What the start said along the unobservable directions.
  [[nodiscard]] Eigen::Vector4d AlongStart() const {
    const double position = 1.0 / (kStartPositionSigma_m * kStartPositionSigma_m);
    const double lever2 = start_.nav.p_GB.head<2>().squaredNorm();
    return {1.0 / (kStartYawSigma_rad * kStartYawSigma_rad) + lever2 * position, position, position,
            position};
  }

  // Of the prior alone, on the oldest frame.
  [[nodiscard]] Information OfPrior() const {
    WindowLinearizer linearizer = Linearizer();
    InformationForm form = NormalEquations(frame_count(), estimator_->layout()).Take();
    AddPrior(estimator_->prior(), frame_count(), estimator_->layout(), &form);
    return Of(form, 0, linearizer.first().nav.front());
  }

  // Of the prior and all factors of the window, on the newest frame.
  [[nodiscard]] Information OfAll() const {
    WindowLinearizer linearizer = Linearizer();
    NormalEquations equations(frame_count(), estimator_->layout());
    for (int i = 1; i < frame_count(); ++i) linearizer.AddLink(i, &equations);
    for (const Landmark& landmark : estimator_->landmarks()) {
      if (landmark.in_problem) linearizer.AddLandmark(landmark, frame_count() - 1, &equations);
    }
    InformationForm form = equations.Take();
    AddPrior(estimator_->prior(), frame_count(), estimator_->layout(), &form);
    return Of(form, frame_count() - 1, linearizer.first().nav.back());
  }

 private:
  static SharedOptions Shared() {
    SharedOptions shared;
    shared.calibration = ScaledPriors(test::EverythingEstimated(), kPriorScale);
    return shared;
  }

  static SimulatedRecording Simulated() {
    SimulationOptions options = test::CalibratedFlight(6.0, 1.0, Shared().calibration);
    options.told_errors = {};
    options.camera_rate_hz = 10.0;
    options.max_tracks = 60;
    return Simulate(options);
  }

  [[nodiscard]] WindowLinearizer Linearizer() const {
    WindowLinearizer linearizer(options_, reprojection_, shared_.standstill, estimator_->layout());
    linearizer.SetWindow(estimator_->frames(), rig_);
    return linearizer;
  }

  [[nodiscard]] Information Of(const InformationForm& form, int frame, const NavState& nav) const {
    std::vector<int> keep;
    std::vector<int> drop;
    for (int i = 0; i < static_cast<int>(form.b.size()); ++i) {
      const bool kept = i / kFrameSize == frame || i >= kFrameSize * frame_count();
      if (kept || form.H(i, i) > 0.0) (kept ? keep : drop).push_back(i);
    }
    const Eigen::MatrixXd H = SchurComplement(form, keep, drop).H;
    Eigen::VectorXd unit(H.rows());
    unit << FrameUnits(), estimator_->layout().PriorSigmas() / kPriorScale;
    const Eigen::MatrixXd scaled = unit.asDiagonal() * H * unit.asDiagonal();
    const Eigen::MatrixXd N = TurnAndShifts(nav, estimator_->layout().size());
    return {Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled)
                .eigenvalues()
                .reverse()
                .cwiseMax(0.0)
                .cwiseSqrt(),
            (N.transpose() * H * N).diagonal()};
  }

  SimulatedRecording recording_;
  SharedOptions shared_;
  EstimatorSetup setup_;
  WindowOptions options_;
  ReprojectionSetup reprojection_;
  std::optional<WindowEstimator> estimator_;
  InertialState start_;
  RigCalibration rig_;
  int keyframes_ = 0;
};

// Singular values below the gap; prints those about it.
int Unobserved(const char* what, const Information& information) {
  // The four say what the start said, 1e-3 (0.01 rad of 10) and 3e-3 (0.1 m of 30); all else has
  // learned more than the calibration's prior (0.01).
  constexpr double kUnobserved = 5e-3;
  constexpr double kObserved = 0.05;
  const Eigen::VectorXd& values = information.singular_values;
  std::printf("%s: %ld singular values, %.1e ...", what, static_cast<long>(values.size()),
              values[0]);
  for (Eigen::Index i = values.size() - 6; i < values.size(); ++i) std::printf(" %.2e", values[i]);
  std::printf("; along yaw %.4e\n", information.along[0]);
  EXPECT_FALSE(((values.array() > kUnobserved) && (values.array() < kObserved)).any()) << what;
  return static_cast<int>((values.array() <= kUnobserved).count());
}

TEST(CalibratedPrior, ExactlyFourDirectionsAreUnobservableWithFirstEstimates) {
  const CalibratedWindow flight(true);
  EXPECT_GE(flight.keyframes(), 20);
  for (const bool prior_alone : {true, false}) {
    const Information information = prior_alone ? flight.OfPrior() : flight.OfAll();
    ASSERT_EQ(information.singular_values.size(), 56);
    EXPECT_EQ(Unobserved(prior_alone ? "prior" : "prior and window", information), 4);
    // Nothing has been added along them to what the start said, but for rounding (1 %).
    for (int k = 0; k < 4; ++k) {
      EXPECT_LT(information.along[k], 1.05 * flight.AlongStart()[k]) << k;
    }
  }
}

TEST(CalibratedPrior, HeadingIsFalselyObservedWithCurrentEstimates) {
  const CalibratedWindow flight(false);
  EXPECT_EQ(Unobserved("prior", flight.OfPrior()), 3);
  EXPECT_EQ(Unobserved("prior and window", flight.OfAll()), 3);
}

}  // namespace
}  // namespace duet
