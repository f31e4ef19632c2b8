#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "backends/factory.h"
#include "experiments/imu_feed.h"
#include "test/backends/calibrated_flight.h"

namespace duet::test {

/// A start's uncertainty that shows what an estimator gains falsely: at the default of 1e-4 rad
/// that is hidden by what it truly loses within seconds (a few mrad in a minute).
inline constexpr double kTellingYawSigma_rad = 0.1;

/// The estimators' defaults, with or without first estimates.
inline BackendOptions WithFirstEstimates(bool first_estimates) {
  BackendOptions backends;
  backends.msckf.first_estimates = backends.window.first_estimates = first_estimates;
  return backends;
}

/// What an estimator said of its yaw over a run.
struct YawUncertainty {
  int frames = 0;
  int at_rest = 0;          ///< frames with the standstill measurement
  int lost = 0;             ///< frames that were not tracked
  double smallest = 1e300;  ///< standard deviation of yaw over the start's, its smallest
  double at_end = 0.0;      ///< the same at the last frame
  std::string failure;
};

/// Everything estimated, rolling shutter, two seconds at rest and then six-axis motion. The start
/// is at rest: its velocity is zero exactly, as every start at rest takes it (a velocity known in G
/// would tell yaw); tilt and biases are off by what their covariance says. Yaw: theta's z, theta
/// being global.
inline YawUncertainty MeasureYaw(const std::string& estimator_name, const BackendOptions& backends,
                                 double sigma_yaw_rad, double duration_s) {
  constexpr double kRest_s = 2.0;
  SharedOptions shared;
  shared.calibration = EverythingEstimated();
  SimulationOptions simulation = CalibratedFlight(duration_s, kRest_s, shared.calibration);
  simulation.max_tracks = 60;
  simulation.pixel_noise_px = 0.5;  // with 1 px rest is told from motion now and then only
  const SimulatedRecording recording = Simulate(simulation);
  const auto estimator = MakeEstimator(estimator_name, MakeSetup(recording, shared), backends);

  Vector15d sigma;
  sigma << 0.01, 0.01, sigma_yaw_rad, Eigen::Vector3d::Constant(1e-4),
      Eigen::Vector3d::Constant(0.05), Eigen::Vector3d::Constant(0.01),
      Eigen::Vector3d::Constant(0.1);
  Random random(5);
  const Timestamp first =
      recording.frames.front().timestamp + ToNanoseconds(recording.told_rig.t_d_s);
  InitialCondition initial = DrawInitialCondition(
      recording.TruthAt(first), Matrix15d(sigma.cwiseAbs2().asDiagonal()), &random);
  initial.state.nav.v_GB.setZero();
  estimator->Initialize(initial);

  YawUncertainty yaw;
  ImuFeed feed(recording.imu);
  for (const TrackFrameSet& frames : recording.frames) {
    feed.Advance(frames.timestamp + ToNanoseconds(ImuHorizon(shared)), estimator.get());
    const EstimatorOutput& output = estimator->ProcessFrame(frames);
    if (output.status == EstimatorStatus::kFailed) {
      yaw.failure = output.reason;
      return yaw;
    }
    ++yaw.frames;
    yaw.at_rest += output.standstill ? 1 : 0;
    yaw.lost += output.status == EstimatorStatus::kTracking ? 0 : 1;
    yaw.at_end = std::sqrt(output.covariance(2, 2)) / sigma_yaw_rad;
    yaw.smallest = std::min(yaw.smallest, yaw.at_end);
  }
  return yaw;
}

inline void Print(const std::string& what, const YawUncertainty& yaw) {
  std::printf(
      "%s: %d frames, %d at rest; yaw's sigma over the start's: smallest 1 %+.1e, at the end "
      "%.6f\n",
      what.c_str(), yaw.frames, yaw.at_rest, yaw.smallest - 1.0, yaw.at_end);
}

}  // namespace duet::test
