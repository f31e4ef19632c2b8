// The forward information filter against the information matrix of the whole problem at once, and
// what every information must be.

#include "experiments/observability/fisher_information.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

#include "backends/window/prior.h"
#include "backends/window/window_linearizer.h"
#include "common/imu/imu_delta.h"
#include "common/measurement/triangulation.h"
#include "test/experiments/observability/small_simulation.h"

namespace duet {
namespace {

// The covariance of the newest frame and the calibration from the dense information matrix over all
// frames, built by the window's own linearization, each piece of a track anchored in its own first
// frame.
Eigen::MatrixXd DenseCovariance(const ObservedMotion& motion, int window_frames,
                                int min_observations) {
  const EstimatorSetup& setup = motion.setup;
  const CalibrationLayout layout(setup.shared.calibration, setup.rig);
  const ReprojectionSetup reprojection{
      .g_G = setup.g_G, .pixel_noise_px = setup.shared.pixel_noise_px, .off_instant = true};
  WindowOptions options;
  options.first_estimates = false;
  options.robust_loss = WindowOptions::RobustLoss::kNone;
  WindowLinearizer linearizer(options, reprojection, setup.shared.standstill, layout);

  ImuBuffer imu;
  for (const ImuSample& sample : motion.imu) imu.Add(sample);
  std::vector<WindowFrame> frames(motion.states.size());
  std::vector<ImuSample> readings;
  StandstillDetector standstill(setup.shared.standstill);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    WindowFrame& frame = frames[k];
    frame.state = motion.states[k];
    frame.t_d_at_instant_s = setup.rig.t_d_s;
    frame.rates.Assign(imu, frame.state.instant, 0.5 * std::abs(setup.rig.t_r_s) + 1e-3,
                       frame.state.biases, setup.rig.imu);
    frame.at_rest_since_before =
        standstill.Update(motion.frames[k], frame.state.instant, imu) && k > 0;
    if (k == 0) continue;
    imu.Extract(frames[k - 1].state.instant, frame.state.instant, &readings);
    ImuLink link;
    link.delta = IntegrateImu(readings, frames[k - 1].state.biases, setup.rig.imu, setup.imu_noise);
    link.sqrt_information = SquareRootInformation(link.delta.covariance);
    frame.link = link;
  }
  linearizer.SetWindow(frames, setup.rig);

  std::map<std::uint64_t, std::vector<LandmarkObservation>> tracks;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (const TrackFrame& camera : motion.frames[k].frames) {
      for (const TrackObservation& o : camera.observations) {
        tracks[o.track_id].push_back(
            {.frame = static_cast<int>(k), .pixel = {camera.camera, {o.u, o.v}}});
      }
    }
  }
  const int frame_count = static_cast<int>(frames.size());
  NormalEquations equations(frame_count, layout);
  for (int i = 1; i < frame_count; ++i) linearizer.AddLink(i, &equations);
  for (const auto& [id, observations] : tracks) {
    std::vector<TrackObservationInState> rays;
    for (const LandmarkObservation& o : observations) {
      rays.push_back(
          {{frames[o.frame].state.nav, setup.rig.t_d_s, &frames[o.frame].rates}, o.pixel});
    }
    const Pose anchor = frames[observations.front().frame].state.nav.pose();
    InverseDepth point;
    if (Triangulate(setup.rig, rays, anchor, setup.g_G, {}, &point) != TriangulationStatus::kOk) {
      continue;
    }
    const Eigen::Vector3d p_G = LandmarkInGlobal(setup.rig, anchor, point);
    const int first = observations.front().frame;
    const int length = window_frames > 0 ? window_frames : frame_count;
    for (int start = first; start < frame_count; start += length) {
      Landmark piece;
      for (const LandmarkObservation& o : observations) {
        if (o.frame >= start && o.frame < start + length) piece.observations.push_back(o);
      }
      if (static_cast<int>(piece.observations.size()) < min_observations) continue;
      EXPECT_TRUE(LandmarkFromGlobal(setup.rig, frames[piece.anchor()].state.nav.pose(), p_G,
                                     &piece.value));
      linearizer.AddLandmark(piece, frame_count - 1, &equations);
    }
  }
  InformationForm form = equations.Take();
  AddPrior(StartPrior({.state = {}, .covariance = motion.start_covariance}, setup.rig, layout),
           frame_count, layout, &form);
  return NewestCovariance(form.H, layout.size());
}

// Largest difference of two covariances in units of the second's standard deviations.
double Difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

// Of a - b, in units of b's standard deviations.
double SmallestEigenvalueOfDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd D = scale.asDiagonal() * (a - b) * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(D).eigenvalues()[0];
}

class FilterAgainstBatch : public testing::TestWithParam<int> {};

TEST_P(FilterAgainstBatch, IsTheDenseInformationOfTheWholeProblem) {
  SimulationOptions options = ObservedSimulation::Options(6.0);
  options.trajectory = "lissajous";
  options.t_d_s = 0.004;
  options.cameras = GetParam();
  const ObservedSimulation simulation(options, AllEstimated());
  const FisherInformation information(simulation.motion);
  EXPECT_GT(information.tracks(), 50);
  for (const int window : {0, 7}) {
    const int min_observations = window > 0 ? 4 : 2;
    const PredictedCovariance predicted =
        information.Predict({.window_frames = window, .min_observations = min_observations});
    const Eigen::MatrixXd dense = DenseCovariance(simulation.motion, window, min_observations);
    ASSERT_EQ(dense.rows(), predicted.covariance.rows());
    // Two orders of elimination of a matrix whose scaled condition number is about 1e6.
    EXPECT_LT(Difference(predicted.covariance, dense), 1e-8) << "window " << window;
  }
}
INSTANTIATE_TEST_SUITE_P(Cameras, FilterAgainstBatch, testing::Values(1, 2));

TEST(FisherInformation, IsTheSameAtRest) {
  SimulationOptions options = ObservedSimulation::Options(6.0);
  options.rest_s = 3.0;
  const ObservedSimulation simulation(options, AllEstimated());
  const FisherInformation information(simulation.motion);
  EXPECT_GT(information.frames_at_rest(), 5);
  EXPECT_LT(
      Difference(information.Predict({}).covariance, DenseCovariance(simulation.motion, 0, 2)),
      1e-8);
}

// The shorter the pieces, the less is known, in every direction of the calibration.
TEST(FisherInformation, CutTracksNeverSayMore) {
  SimulationOptions options = ObservedSimulation::Options(10.0);
  const ObservedSimulation simulation(options, AllEstimated());
  const FisherInformation information(simulation.motion);
  Eigen::MatrixXd longer = information.Predict({}).CalibrationCovariance();
  const double whole_trace = longer.diagonal().cwiseSqrt().sum();
  for (const int window : {24, 12, 6, 3}) {  // each divides the one before
    const Eigen::MatrixXd cut =
        information.Predict({.window_frames = window}).CalibrationCovariance();
    EXPECT_GT(SmallestEigenvalueOfDifference(cut, longer), -1e-7) << window;
    longer = cut;
  }
  EXPECT_GT(longer.diagonal().cwiseSqrt().sum(), 1.05 * whole_trace);
}

TEST(FisherInformation, GrowsWithTimeAndNeverShrinks) {
  SimulationOptions options = ObservedSimulation::Options(12.0);
  const ObservedSimulation simulation(options, AllEstimated());
  const FisherInformation information(simulation.motion);
  const Eigen::VectorXd prior = information.layout().PriorSigmas();
  for (const int window : {0, 8}) {
    std::vector<double> times;
    for (int i = 1; i < 12; ++i) times.push_back(i);
    const PredictedCovariance predicted =
        information.Predict({.window_frames = window, .times_s = times});
    ASSERT_EQ(predicted.history.size(), 12U);
    Eigen::VectorXd before = prior;
    for (const PredictedCovariance::Row& row : predicted.history) {
      EXPECT_LE((row.sigmas - before).cwiseQuotient(before).maxCoeff(), 1e-8) << row.time_s;
      before = row.sigmas;
    }
    EXPECT_LT(before.cwiseQuotient(prior).minCoeff(), 0.2);
  }
}

// Twice the densities, pixel noise, priors and first state's uncertainty: twice the uncertainty.
TEST(FisherInformation, ScalesWithEveryNoise) {
  SimulationOptions options = ObservedSimulation::Options(4.0);
  const ObservedSimulation simulation(options, AllEstimated());
  ObservedMotion twice = simulation.motion;
  twice.setup.imu_noise.gyroscope_density *= 2.0;
  twice.setup.imu_noise.accelerometer_density *= 2.0;
  twice.setup.imu_noise.gyroscope_random_walk *= 2.0;
  twice.setup.imu_noise.accelerometer_random_walk *= 2.0;
  twice.setup.shared.pixel_noise_px *= 2.0;
  twice.setup.shared.calibration = ScaledPriors(twice.setup.shared.calibration, 2.0);
  twice.start_covariance *= 4.0;
  const Eigen::MatrixXd once = FisherInformation(simulation.motion).Predict({}).covariance;
  EXPECT_LT(Difference(FisherInformation(twice).Predict({}).covariance, 4.0 * once), 1e-9);
}

}  // namespace
}  // namespace duet
