#include "backends/window/window_estimator.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstring>
#include <functional>
#include <map>
#include <vector>

#include "common/geometry/so3.h"
#include "common/measurement/told_errors.h"
#include "experiments/simulation/simulator.h"

namespace duet {
namespace {

Matrix15d StartCovariance(double sigma_yaw, double sigma_p) {
  Vector15d sigma;
  sigma << 0.01, 0.01, sigma_yaw, sigma_p, sigma_p, sigma_p, 0.05, 0.05, 0.05, 0.01, 0.01, 0.01,
      0.1, 0.1, 0.1;
  return sigma.cwiseAbs2().asDiagonal();
}

struct Flight {
  SimulatedRecording recording;
  SharedOptions shared;
  WindowOptions options;
  Matrix15d start_covariance = StartCovariance(1e-4, 1e-4);
  bool draw_start = true;

  /// Feeds the recording; `after` sees every output. Returns the estimator.
  std::unique_ptr<WindowEstimator> Go(
      const std::function<void(const WindowEstimator&, const EstimatorOutput&)>& after = nullptr) {
    const EstimatorSetup setup = MakeSetup(recording, shared);
    auto estimator = std::make_unique<WindowEstimator>(setup, options);
    const Timestamp first =
        recording.frames.front().timestamp + ToNanoseconds(recording.told_rig.t_d_s);
    Random random(77);
    InitialCondition initial{recording.TruthAt(first), start_covariance};
    if (draw_start) initial = DrawInitialCondition(initial.state, start_covariance, &random);
    estimator->Initialize(initial);
    std::size_t fed = 0;
    const Timestamp horizon = ToNanoseconds(ImuHorizon(setup.shared));
    for (const TrackFrameSet& frames : recording.frames) {
      while (fed < recording.imu.size() &&
             (fed == 0 || recording.imu[fed - 1].timestamp < frames.timestamp + horizon)) {
        estimator->AddImu(recording.imu[fed++]);
      }
      const EstimatorOutput& output = estimator->ProcessFrame(frames);
      if (after) after(*estimator, output);
    }
    return estimator;
  }
};

Flight Easy(double duration_s, int cameras = 1, const std::string& preset = "room_easy",
            const CalibrationPriors& calibration = {}) {
  SimulationOptions simulation = SimulationPreset(preset);
  simulation.duration_s = duration_s;
  simulation.cameras = cameras;
  simulation.seed = 3;
  simulation.told_errors = ToldErrorsOfPriors(calibration);
  Flight run;
  run.recording = Simulate(simulation);
  run.shared.calibration = calibration;
  return run;
}

double PoseNees(const Flight& run, const EstimatorOutput& output) {
  const Vector15d e = BoxMinus(run.recording.TruthAt(output.state.instant), output.state);
  const Eigen::MatrixXd P = output.covariance.topLeftCorner<6, 6>();
  return e.head<6>().dot(P.ldlt().solve(e.head<6>()));
}

TEST(WindowEstimator, TracksWithinItsOwnCovariance) {
  for (const int cameras : {1, 2}) {
    Flight run = Easy(3.0, cameras);
    double sum = 0.0;
    int count = 0;
    run.Go([&](const WindowEstimator&, const EstimatorOutput& output) {
      ASSERT_NE(output.status, EstimatorStatus::kFailed) << output.reason;
      sum += PoseNees(run, output);
      ++count;
    });
    EXPECT_EQ(count, static_cast<int>(run.recording.frames.size()));
    // One run: its instants move together, so that a mean over time scatters like a single draw of
    // chi-squared with 6 degrees of freedom; 20 is its 99.7 % quantile. Over seeds: the long test.
    EXPECT_LT(sum / count, 20.0) << cameras << " cameras";
  }
}

TEST(WindowEstimator, SameInputSameBytes) {
  Flight run = Easy(1.0, 2);
  run.shared.calibration.p_CB.estimated = run.shared.calibration.t_d.estimated = true;
  std::vector<double> bytes[2];
  for (std::vector<double>& b : bytes) {
    run.Go([&](const WindowEstimator&, const EstimatorOutput& output) {
      const auto append = [&](const double* data, Eigen::Index n) {
        b.insert(b.end(), data, data + n);
      };
      append(output.state.nav.R_GB.coeffs().data(), 4);
      append(output.state.nav.p_GB.data(), 3);
      append(output.state.nav.v_GB.data(), 3);
      append(output.state.biases.b_g.data(), 3);
      append(output.state.biases.b_a.data(), 3);
      append(output.covariance.data(), output.covariance.size());
    });
  }
  ASSERT_EQ(bytes[0].size(), bytes[1].size());
  EXPECT_EQ(std::memcmp(bytes[0].data(), bytes[1].data(), bytes[0].size() * sizeof(double)), 0);
}

TEST(WindowEstimator, ErrorsShrinkWithTheNoise) {
  // A hundredth of all noise: a hundredth of the error, up to the floor that 200 Hz IMU samples
  // leave (a millimetre; their straight lines between samples are not the motion).
  double error[2];
  for (int k = 0; k < 2; ++k) {
    SimulationOptions simulation = SimulationPreset("room_easy");
    simulation.duration_s = 3.0;
    simulation.noise_scale = k == 0 ? 1.0 : 0.01;
    Flight run;
    run.recording = Simulate(simulation);
    run.start_covariance *= simulation.noise_scale * simulation.noise_scale;
    run.shared.pixel_noise_px = run.recording.pixel_noise_px;
    const auto estimator = run.Go();
    const InertialState& last = estimator->frames().back().state;
    error[k] = BoxMinus(run.recording.TruthAt(last.instant), last).head<6>().norm();
  }
  EXPECT_LT(error[1], 0.03 * error[0] + 1e-3);
}

TEST(WindowEstimator, GainsNoInformationOnYawAndPosition) {
  // Yaw and position can never be known better than at the start (0.2 rad, 2 m); with first
  // estimates the newest frame's covariance says so, to the rounding of an information matrix whose
  // largest entries are 1e9 times theirs; without them it does not. (The first velocity must be
  // unknown too: one that is known in G tells yaw.)
  for (const bool first_estimates : {true, false}) {
    Flight run = Easy(4.0);
    run.start_covariance = StartCovariance(0.2, 2.0);
    run.start_covariance.diagonal().segment<3>(6).setConstant(2500.0);
    run.draw_start = false;
    run.options.first_estimates = first_estimates;
    run.options.min_depth_sigmas = 0.0;  // so unsure a start knows no depth
    double yaw_sigma = 0.0;
    double p_sigma = 1e300;
    run.Go([&](const WindowEstimator&, const EstimatorOutput& output) {
      ASSERT_EQ(output.covariance.rows(), 15);
      const Eigen::VectorXd sigma = output.covariance.diagonal().cwiseSqrt();
      yaw_sigma = sigma[2];
      p_sigma = std::min(p_sigma, sigma.segment<3>(3).minCoeff());
    });
    EXPECT_EQ(yaw_sigma > 0.2 * (1.0 - 1e-3), first_estimates) << yaw_sigma;
    EXPECT_TRUE(!first_estimates || p_sigma > 2.0 * (1.0 - 1e-3)) << p_sigma;
  }
}

TEST(WindowEstimator, EveryFrameModeKeepsConsecutiveFrames) {
  Flight run = Easy(2.0);
  run.options.keyframes = WindowOptions::Keyframes::kEveryFrame;
  run.options.max_frames = 7;
  run.Go([&](const WindowEstimator& estimator, const EstimatorOutput& output) {
    EXPECT_TRUE(output.keyframe);
    const auto& frames = estimator.frames();
    EXPECT_LE(frames.size(), 6U);  // the oldest has left, the next is to come
    for (std::size_t i = 1; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].state.instant - frames[i - 1].state.instant, 50'000'000);
    }
  });
}

TEST(WindowEstimator, SeesRestInAWindowShorterThanTheTimeRestIsJudgedOver) {
  const auto frames_at_rest = [](WindowOptions::Keyframes keyframes, int max_frames) {
    Flight run = Easy(3.0, 1, "room_rest");  // sets off after two seconds
    run.options.keyframes = keyframes;
    run.options.max_frames = max_frames;
    int at_rest = 0;
    run.Go([&](const WindowEstimator&, const EstimatorOutput& output) {
      at_rest += output.standstill ? 1 : 0;
    });
    return at_rest;
  };
  const int with_keyframes = frames_at_rest(WindowOptions::Keyframes::kParallax, 11);
  EXPECT_GT(with_keyframes, 10);
  // Six consecutive frames span 0.3 s; rest is judged over half a second.
  EXPECT_EQ(frames_at_rest(WindowOptions::Keyframes::kEveryFrame, 6), with_keyframes);
}

TEST(WindowEstimator, DroppedFramesLeaveTheWholeImuDelta) {
  // The link over dropped frames is the composition of theirs: the same as integrating the whole
  // interval at once.
  Flight run = Easy(2.0);
  run.options.min_parallax_px = 1000.0;  // no keyframe but by the interval
  run.options.max_keyframe_interval_s = 0.5;
  run.options.min_common_tracks = 0;
  run.options.reintegration_threshold = 1e300;
  ImuBuffer imu;
  for (const ImuSample& sample : run.recording.imu) imu.Add(sample);
  const auto estimator = run.Go();
  int long_links = 0;
  for (const WindowFrame& frame : estimator->frames()) {
    if (!frame.link) continue;
    const ImuDelta& delta = frame.link->delta;
    long_links += delta.dt_s > 0.3 ? 1 : 0;
    std::vector<ImuSample> readings;
    imu.Extract(delta.start, delta.end, &readings);
    const ImuDelta whole =
        IntegrateImu(readings, delta.biases, delta.calibration, run.recording.noise,
                     {.covariance = true, .bias_jacobians = true, .calibration_jacobians = false});
    EXPECT_LT(BoxMinus(delta.R, whole.R).norm(), 1e-12);
    EXPECT_LT((delta.y - whole.y).norm(), 1e-12);
    EXPECT_LT((delta.covariance - whole.covariance).norm(), 1e-9 * whole.covariance.norm());
  }
  EXPECT_GE(long_links, 2);
}

TEST(WindowEstimator, IntegratesAgainBeyondTheThreshold) {
  // At every solve each link stands within the threshold of the biases the solve starts from, which
  // are those after the frame before. (Without the threshold the start's errors of 0.1 m/s^2 and
  // 0.01 rad/s would stay in.)
  Flight run = Easy(1.5);
  run.options.keyframes = WindowOptions::Keyframes::kEveryFrame;
  run.options.reintegration_threshold = 1e-4;
  std::map<Timestamp, ImuBiases> before;
  int checked = 0;
  run.Go([&](const WindowEstimator& estimator, const EstimatorOutput&) {
    const auto& frames = estimator.frames();
    for (std::size_t i = 1; i < frames.size(); ++i) {
      const auto biases = before.find(frames[i - 1].state.instant);
      if (!frames[i].link || biases == before.end()) continue;
      EXPECT_LE(DistanceFromLinearization(frames[i].link->delta, biases->second,
                                          run.recording.told_rig.imu),
                1e-4);
      ++checked;
    }
    for (const WindowFrame& frame : frames) before[frame.state.instant] = frame.state.biases;
  });
  EXPECT_GT(checked, 100);
}

TEST(WindowEstimator, SkipsFramesThatTheImuDoesNotCover) {
  Flight run = Easy(3.0);
  // The IMU ends 0.5 s before the last frame.
  const Timestamp end = run.recording.frames.back().timestamp - 500'000'000;
  std::erase_if(run.recording.imu, [&](const ImuSample& s) { return s.timestamp > end; });
  int skipped = 0;
  const auto estimator = run.Go([&](const WindowEstimator&, const EstimatorOutput& output) {
    skipped += output.reason.rfind("skipped", 0) == 0 ? 1 : 0;
    EXPECT_NE(output.status, EstimatorStatus::kFailed);
  });
  EXPECT_EQ(skipped, 10);
  EXPECT_EQ(estimator->skipped_frames(), 10);
}

TEST(WindowEstimator, DeadReckonsWithoutFeaturesAndComesBack) {
  Flight run = Easy(5.0);
  auto& frames = run.recording.frames;
  for (std::size_t i = 50; i < 60; ++i) {
    for (TrackFrame& camera : frames[i].frames) camera.observations.clear();
  }
  // Tracks end with the gap; those after it have new ids.
  for (std::size_t i = 60; i < frames.size(); ++i) {
    for (TrackFrame& camera : frames[i].frames) {
      for (TrackObservation& o : camera.observations) o.track_id += 1'000'000;
    }
  }
  std::vector<EstimatorStatus> status;
  run.Go([&](const WindowEstimator&, const EstimatorOutput& output) {
    status.push_back(output.status);
  });
  EXPECT_EQ(status[49], EstimatorStatus::kTracking);
  for (std::size_t i = 50; i < 60; ++i) EXPECT_EQ(status[i], EstimatorStatus::kDeadReckoning);
  EXPECT_EQ(status.back(), EstimatorStatus::kTracking);
}

TEST(WindowEstimator, FailsWithAReasonAndStaysFailed) {
  Flight run = Easy(2.0);
  run.shared.failure.max_velocity_m_per_s = 0.1;  // room_easy moves at 0.5 m/s
  int failed = 0;
  const auto estimator = run.Go([&](const WindowEstimator&, const EstimatorOutput& output) {
    failed += output.status == EstimatorStatus::kFailed ? 1 : 0;
    if (failed > 0) {
      EXPECT_EQ(output.status, EstimatorStatus::kFailed);
      EXPECT_NE(output.reason.find("velocity"), std::string::npos);
    }
  });
  EXPECT_GT(failed, 5);
  EXPECT_FALSE(estimator->PredictAt(run.recording.frames[3].timestamp).has_value());
}

TEST(WindowEstimator, PredictsBetweenFramesByTheImu) {
  Flight run = Easy(3.0);
  const auto estimator = run.Go();
  const InertialState& last = estimator->frames().back().state;
  const Vector15d before = BoxMinus(run.recording.TruthAt(last.instant), last);
  const Timestamp t = last.instant + 15'000'000;
  const auto predicted = estimator->PredictAt(t);
  ASSERT_TRUE(predicted.has_value());
  const Vector9d after = BoxMinus(run.recording.TruthAt(t).nav, *predicted);
  // 15 ms later the same error, carried on: its velocity adds 1e-3 m at most.
  EXPECT_LT((after.head<6>() - before.head<6>()).norm(), 2e-3);
  EXPECT_FALSE(estimator->PredictAt(last.instant + 10'000'000'000).has_value());
}

TEST(WindowEstimator, FindsTimeOffsetAndCameraPosition) {
  CalibrationPriors calibration;
  calibration.p_CB.estimated = calibration.t_d.estimated = true;
  calibration.p_CB.sigma = 0.02;
  calibration.t_d.sigma = 0.005;
  Flight run = Easy(5.0, 1, "excited", calibration);
  run.shared.max_abs_t_d_s = 0.02;
  Eigen::VectorXd error;
  Eigen::VectorXd sigma;
  run.Go([&](const WindowEstimator& estimator, const EstimatorOutput& output) {
    ASSERT_NE(output.status, EstimatorStatus::kFailed) << output.reason;
    error = BoxMinus(run.recording.true_rig, output.rig, estimator.layout());
    sigma = output.covariance.diagonal().tail(4).cwiseSqrt();
  });
  ASSERT_EQ(error.size(), 4);
  EXPECT_LT(sigma[3], 1e-3);  // t_d: a fifth of its prior
  EXPECT_LT(sigma.head<3>().maxCoeff(), 0.01);
  for (int i = 0; i < 4; ++i) EXPECT_LT(std::abs(error[i]), 4.0 * sigma[i]) << "component " << i;
}

}  // namespace
}  // namespace duet
