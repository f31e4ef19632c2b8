#include "experiments/simulation/simulator.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "common/geometry/so3.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "experiments/simulation/scenario.h"

namespace duet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SimulationOptions ShortRun() {
  SimulationOptions options;
  options.duration_s = 5.0;
  return options;
}

TEST(Simulator, SameOptionsGiveTheSameRecordingAndAnotherSeedAnother) {
  SimulationOptions options = ShortRun();
  options.cameras = 2;
  const SimulatedRecording a = Simulate(options);
  const SimulatedRecording b = Simulate(options);
  options.seed = 2;
  const SimulatedRecording c = Simulate(options);
  ASSERT_EQ(a.imu.size(), b.imu.size());
  for (std::size_t i = 0; i < a.imu.size(); ++i) {
    ASSERT_EQ(a.imu[i].omega_m, b.imu[i].omega_m);
    ASSERT_EQ(a.imu[i].a_m, b.imu[i].a_m);
  }
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& x = a.frames[i].frames[k].observations;
      const auto& y = b.frames[i].frames[k].observations;
      ASSERT_EQ(x.size(), y.size());
      for (std::size_t j = 0; j < x.size(); ++j) {
        ASSERT_EQ(x[j].track_id, y[j].track_id);
        ASSERT_EQ(x[j].u, y[j].u);
        ASSERT_EQ(x[j].v, y[j].v);
      }
    }
  }
  EXPECT_NE(a.imu[0].omega_m, c.imu[0].omega_m);
  EXPECT_NE(a.frames[0].frames[0].observations[0].u, c.frames[0].frames[0].observations[0].u);
}

TEST(Simulator, TracksAreASoundStream) {
  SimulationOptions options = ShortRun();
  options.cameras = 2;
  const SimulatedRecording recording = Simulate(options);
  EXPECT_EQ(recording.frames.size(), 101U);
  std::map<std::uint64_t, int> last_seen;
  std::map<std::uint64_t, int> length;
  int in_second = 0;
  int in_first = 0;
  for (int i = 0; i < static_cast<int>(recording.frames.size()); ++i) {
    const TrackFrameSet& set = recording.frames[static_cast<std::size_t>(i)];
    ASSERT_EQ(set.frames.size(), 2U);
    EXPECT_EQ(set.frames[0].observations.size(), static_cast<std::size_t>(options.max_tracks));
    std::set<std::uint64_t> first_ids;
    for (const TrackFrame& frame : set.frames) {
      EXPECT_EQ(frame.timestamp, set.timestamp);
      std::uint64_t previous = 0;
      for (const TrackObservation& observation : frame.observations) {
        EXPECT_GT(observation.track_id, previous) << "sorted by id";
        previous = observation.track_id;
        if (frame.camera == 0) {
          first_ids.insert(previous);
          const auto seen = last_seen.find(previous);
          if (seen != last_seen.end()) {
            EXPECT_EQ(seen->second, i - 1) << "an ended id came back";
          }
          last_seen[previous] = i;
          ++length[previous];
          ++in_first;
        } else {
          EXPECT_TRUE(first_ids.count(previous)) << "seen by the second camera alone";
          ++in_second;
        }
      }
    }
  }
  // The images overlap except at the sides.
  EXPECT_GT(in_second, in_first * 7 / 10);
  double mean = 0.0;
  for (const auto& [id, frames] : length) mean += frames;
  mean /= static_cast<double>(length.size());
  // Like a real tracker's: DESIGN's reference streams have 22 and 40 frames.
  EXPECT_GT(mean, 12.0);
  EXPECT_LT(mean, 60.0);
}

TEST(Simulator, ImuCoversTheFramesWithRoomForTimeOffsets) {
  const SimulatedRecording recording = Simulate(ShortRun());
  EXPECT_GE(recording.frames.front().timestamp - recording.imu.front().timestamp, 199'000'000);
  EXPECT_GE(recording.imu.back().timestamp - recording.frames.back().timestamp, 194'000'000);
  // Frames fall on the IMU's stamps.
  std::set<Timestamp> stamps;
  for (const ImuSample& sample : recording.imu) stamps.insert(sample.timestamp);
  for (const TrackFrameSet& set : recording.frames) EXPECT_TRUE(stamps.count(set.timestamp));
}

// Without noise the readings, corrected, are the rates of the truth: the full error model goes back
// and forth.
TEST(Simulator, ReadingsFollowTheErrorModel) {
  SimulationOptions options = ShortRun();
  options.noise_scale = 0.0;
  RigCalibration rig = EurocLikeRig(1);
  rig.imu.T_g << 1.01, 0.002, -0.003, 0.001, 0.99, 0.004, -0.002, 0.003, 1.005;
  rig.imu.T_a << 0.99, 0.001, 0.002, -0.003, 1.01, 0.004, 0.005, -0.001, 1.002;
  rig.imu.T_s << 1e-3, 2e-4, 0, 0, -1e-3, 3e-4, 1e-4, 0, 5e-4;
  options.true_rig = rig;
  const SimulatedRecording recording = Simulate(options);
  for (std::size_t i = 0; i < recording.imu.size(); i += 17) {
    const ImuSample& sample = recording.imu[i];
    const Kinematics k =
        recording.trajectory->At(SecondsBetween(recording.start, sample.timestamp));
    const ImuBiases& biases = recording.truth[i].biases;
    const Vector3d a_B = k.T_GB.R.conjugate() * (k.a_G + Vector3d(0, 0, 9.81));
    EXPECT_LT((rig.imu.T_a * a_B + biases.b_a - sample.a_m).norm(), 1e-12);
    EXPECT_LT((rig.imu.T_g * k.omega_B + rig.imu.T_s * a_B + biases.b_g - sample.omega_m).norm(),
              1e-12);
  }
}

TEST(Simulator, WhiteNoiseAndWalksHaveTheirDensities) {
  for (const double rate_hz : {100.0, 400.0}) {
    SimulationOptions options = ShortRun();
    options.duration_s = 60.0;
    options.imu_rate_hz = rate_hz;
    options.max_tracks = 1;
    options.camera_rate_hz = 1.0;
    const SimulatedRecording noisy = Simulate(options);
    options.noise_scale = 0.0;
    const SimulatedRecording clean = Simulate(options);
    double white = 0.0;
    double walk = 0.0;
    for (std::size_t i = 0; i + 1 < noisy.imu.size(); ++i) {
      const Vector3d b = noisy.truth[i].biases.b_a - clean.truth[i].biases.b_a;
      white += (noisy.imu[i].a_m - clean.imu[i].a_m - b).squaredNorm();
      walk += (noisy.truth[i + 1].biases.b_a - noisy.truth[i].biases.b_a).squaredNorm();
    }
    const double count = 3.0 * static_cast<double>(noisy.imu.size() - 1);
    // 18,000 numbers and more: a variance is known to 1 / sqrt(9000) = 1 %; four of those.
    EXPECT_NEAR(std::sqrt(white / count / rate_hz) / 2e-3, 1.0, 0.022);
    EXPECT_NEAR(std::sqrt(walk / count * rate_hz) / 3e-3, 1.0, 0.022);
  }
}

// Every observation is a real point: one point in space explains all pixels of a track, each seen
// from where the camera was when that very row was read.
TEST(Simulator, PixelsAreThoseOfOnePointAtTheTimeOfTheirRow) {
  SimulationOptions options = ShortRun();
  options.noise_scale = 0.0;
  options.t_d_s = 0.007;
  options.t_r_s = -0.02;
  const SimulatedRecording recording = Simulate(options);
  const CameraCalibration& camera = recording.true_rig.cameras[0];
  struct Ray {
    Vector3d origin;
    Vector3d direction;
    Pose T_CG;
    Vector2d uv;
  };
  std::map<std::uint64_t, std::vector<Ray>> rays;
  for (const TrackFrameSet& set : recording.frames) {
    for (const TrackObservation& observation : set.frames[0].observations) {
      const Vector2d uv(observation.u, observation.v);
      const double delay_s = 0.007 - 0.02 * (uv.y() - 0.5 * 479.0) / 480.0;
      const Pose T_GB =
          recording.trajectory->At(SecondsBetween(recording.start, set.timestamp) + delay_s).T_GB;
      const Pose T_CG = Pose{camera.R_CB, camera.p_CB} * T_GB.Inverse();
      const Pose T_GC = T_CG.Inverse();
      rays[observation.track_id].push_back(
          {T_GC.p, (T_GC.R * camera.model.Unproject(uv).value()).normalized(), T_CG, uv});
    }
  }
  int checked = 0;
  for (const auto& [id, of_track] : rays) {
    if (of_track.size() < 20) continue;
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    for (const Ray& ray : of_track) {
      const Eigen::Matrix3d P =
          Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
      A += P;
      b += P * ray.origin;
    }
    const Vector3d p_G = A.ldlt().solve(b);
    for (const Ray& ray : of_track) {
      Vector2d uv;
      ASSERT_TRUE(camera.model.Project(ray.T_CG * p_G, &uv));
      // Pixels are kept as floats (half a step is 3e-5 px at 752), which the least squares on rays
      // that are nearly parallel enlarges.
      EXPECT_LT((uv - ray.uv).norm(), 2e-3);
      ++checked;
    }
  }
  EXPECT_GT(checked, 1000);
}

TEST(Simulator, OutliersComeInTheirShare) {
  SimulationOptions options = ShortRun();
  options.pixel_noise_px = 0.0;
  const SimulatedRecording clean = Simulate(options);
  options.outlier_share = 0.05;
  const SimulatedRecording with_outliers = Simulate(options);
  int off = 0;
  int all = 0;
  // The first frame's tracks are drawn before any outlier is.
  const auto& a = clean.frames[0].frames[0].observations;
  const auto& b = with_outliers.frames[0].frames[0].observations;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i, ++all) {
    const double d = std::hypot(a[i].u - b[i].u, a[i].v - b[i].v);
    if (d > 1.0) {
      ++off;
      EXPECT_GE(d, 4.99);
      EXPECT_LE(d, options.outlier_px + 0.01);
    }
  }
  // 120 draws at 0.05: 6 +- 2.4.
  EXPECT_GE(off, 1);
  EXPECT_LE(off, 16);
}

// Pixels of the same seed with and without noise: the same tracks, their noise between them.
TEST(Simulator, PixelNoiseHasItsCovarianceInAWorld) {
  double sum_u = 0.0;
  double sum_v = 0.0;
  double sum_uv = 0.0;
  int count = 0;
  for (int seed = 1; seed <= 5; ++seed) {
    SimulationOptions options = ShortRun();
    options.world = "room";
    options.seed = seed;
    options.pixel_noise_px = 0.7;
    const SimulatedRecording noisy = Simulate(options);
    options.pixel_noise_px = 0.0;
    const SimulatedRecording clean = Simulate(options);
    ASSERT_EQ(noisy.frames.size(), clean.frames.size());
    for (std::size_t i = 0; i < noisy.frames.size(); ++i) {
      const auto& a = noisy.frames[i].frames[0].observations;
      const auto& b = clean.frames[i].frames[0].observations;
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t j = 0; j < a.size(); ++j) {
        ASSERT_EQ(a[j].track_id, b[j].track_id);
        const double u = (a[j].u - b[j].u) / 0.7;
        const double v = (a[j].v - b[j].v) / 0.7;
        sum_u += u * u;
        sum_v += v * v;
        sum_uv += u * v;
        ++count;
      }
    }
  }
  // Chi-squared of 60,000 degrees of freedom: its mean is 1 +- sqrt(2 / n) = 0.6 %; four of those.
  ASSERT_GT(count, 50'000);
  const double bound = 4.0 * std::sqrt(2.0 / count);
  EXPECT_NEAR(sum_u / count, 1.0, bound);
  EXPECT_NEAR(sum_v / count, 1.0, bound);
  EXPECT_NEAR(sum_uv / count, 0.0, bound);
}

// A track ends where its point goes behind something: no observation is of a hidden point.
TEST(Simulator, TracksOfAWorldAreSeen) {
  SimulationOptions options = ShortRun();
  options.world = "hall";
  options.trajectory = "MH_01_easy";
  options.noise_scale = 0.0;
  options.moving_bodies = true;
  options.t_r_s = 0.02;
  const Scenario scenario = MakeScenario(options, false);
  const SimulatedRecording recording = SimulateIn(scenario, options);
  const CameraCalibration& camera = recording.true_rig.cameras[0];
  std::map<std::uint64_t, Vector3d> points;
  int moved = 0;
  int compared = 0;
  for (const TrackFrameSet& set : recording.frames) {
    for (const TrackObservation& observation : set.frames[0].observations) {
      const double t_s = SecondsBetween(recording.start, set.timestamp) +
                         0.02 * (observation.v - 0.5 * 479.0) / 480.0;
      const Pose T_GC =
          (Pose{camera.R_CB, camera.p_CB} * recording.trajectory->At(t_s).T_GB.Inverse()).Inverse();
      const Vector3d ray =
          (T_GC.R * camera.model.Unproject({observation.u, observation.v}).value()).normalized();
      const auto hit = scenario.world->Cast(T_GC.p, ray, t_s);
      ASSERT_TRUE(hit);
      const Vector3d p_G = scenario.world->PointInGlobal(hit->surface, hit->uv_m, t_s);
      const auto [place, is_new] = points.emplace(observation.track_id, p_G);
      if (is_new) continue;
      ++compared;
      // Off by more than float pixels at an edge make: something stands before it, or it moves.
      if ((place->second - p_G).norm() > 0.02) ++moved;
    }
  }
  ASSERT_GT(compared, 5000);
  // Points on edges and on walkers.
  EXPECT_LT(moved, compared / 50);
}

TEST(Simulator, WeakTracksEndEarly) {
  SimulationOptions options = ShortRun();
  options.mean_track_frames = 1e6;
  options.trajectory = "standstill";
  options.weak_share = 0.5;
  options.weak_track_frames = 4.0;
  options.max_tracks = 2000;
  options.duration_s = 1.0;
  const SimulatedRecording recording = Simulate(options);
  std::map<std::uint64_t, int> length;
  for (const TrackFrameSet& set : recording.frames) {
    for (const TrackObservation& each : set.frames[0].observations) ++length[each.track_id];
  }
  int begun = 0;
  int whole = 0;
  for (const TrackObservation& each : recording.frames[0].frames[0].observations) {
    ++begun;
    if (length[each.track_id] == static_cast<int>(recording.frames.size())) ++whole;
  }
  // The strong half stays, and of the weak half (3/4)^20 = 0.3 %: 50.2 +- 1.1 % of 2000.
  EXPECT_NEAR(static_cast<double>(whole) / begun, 0.502, 0.045);
}

TEST(Simulator, ToldRigIsOffByTheToldErrors) {
  SimulationOptions options = ShortRun();
  options.duration_s = 0.5;
  CalibrationPriors priors;
  priors.p_CB.estimated = priors.R_CB.estimated = priors.t_d.estimated = true;
  options.told_errors = ToldErrorsOfPriors(priors);
  double sum = 0.0;
  constexpr int kSeeds = 100;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    options.seed = seed;
    const SimulatedRecording recording = Simulate(options);
    const CalibrationLayout layout(priors, recording.true_rig);
    const Eigen::VectorXd error = BoxMinus(recording.true_rig, recording.told_rig, layout);
    sum += error.cwiseQuotient(layout.PriorSigmas()).squaredNorm();
    EXPECT_EQ(recording.true_rig.cameras[0].model.parameters(),
              recording.told_rig.cameras[0].model.parameters());
  }
  // Mean of chi-squared with 7 degrees of freedom over 100 draws: 7 +- 0.37; four of those.
  EXPECT_NEAR(sum / kSeeds, 7.0, 1.5);
}

TEST(Simulator, DrawnStartErrorsHaveTheirCovariance) {
  Random random(5);
  Matrix15d A;
  for (int i = 0; i < 225; ++i) A(i) = random.Normal();
  Matrix15d covariance = 1e-4 * A * A.transpose();
  covariance.row(5).setZero();  // one state known exactly
  covariance.col(5).setZero();
  InertialState truth;
  truth.nav.R_GB = ExpQuaternion(Vector3d(0.4, -1.0, 2.0));
  truth.nav.p_GB = {1, 2, 3};
  Matrix15d sample = Matrix15d::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const InitialCondition start = DrawInitialCondition(truth, covariance, &random);
    const Vector15d error = BoxMinus(truth, start.state);
    sample += error * error.transpose() / kDraws;
  }
  EXPECT_EQ(sample(5, 5), 0.0);
  // Each number of a sample covariance scatters by sqrt((s_ii s_jj + s_ij^2) / n) <= sqrt(2 / n) of
  // the largest variance: 1 %; five of those over 225 numbers.
  EXPECT_LT((sample - covariance).cwiseAbs().maxCoeff(), 0.05 * covariance.diagonal().maxCoeff());
}

TEST(Simulator, TruthAnywhereIsExactOnTheStampsAndBetweenThem) {
  const SimulatedRecording recording = Simulate(ShortRun());
  const InertialState& third = recording.truth[3];
  const InertialState& fourth = recording.truth[4];
  EXPECT_EQ(recording.TruthAt(third.instant).biases.b_a, third.biases.b_a);
  EXPECT_EQ(recording.TruthAt(third.instant).nav.p_GB, third.nav.p_GB);
  const InertialState between = recording.TruthAt(third.instant + 1'250'000);
  EXPECT_LT((between.biases.b_a - 0.75 * third.biases.b_a - 0.25 * fourth.biases.b_a).norm(),
            1e-12);
}

TEST(Simulator, PresetsRunAndUnknownOnesAreBadInput) {
  for (const std::string& name : SimulationPresetNames()) {
    SimulationOptions options = SimulationPreset(name);
    options.duration_s = 1.0;
    const SimulatedRecording recording = Simulate(options);
    EXPECT_EQ(recording.frames.size(), 21U) << name;
  }
  EXPECT_THROW(static_cast<void>(SimulationPreset("room_eazy")), InputError);
  SimulationOptions options = ShortRun();
  options.b_g_rad_per_s = {0.0};
  EXPECT_THROW(static_cast<void>(Simulate(options)), InputError);
}

}  // namespace
}  // namespace duet
