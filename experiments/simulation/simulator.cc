#include "experiments/simulation/simulator.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/geometry/so3.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "experiments/simulation/euroc_sequences.h"
#include "experiments/simulation/imu_simulator.h"
#include "experiments/simulation/scenario.h"
#include "experiments/simulation/track_simulator.h"

namespace duet {
namespace {

// Separate random sequences, so that e.g. another IMU rate leaves the tracks as they are.
// (1, 11 and 12 are the IMU's, those from 1000 on the told calibration's.)
enum RandomStream : std::uint64_t { kTrackStream = 2 };

Eigen::Vector3d ToVector3(const std::vector<double>& values, const char* key) {
  if (values.size() != 3) throw InputError("", 0, key, "expected three numbers");
  return {values[0], values[1], values[2]};
}

Eigen::Quaterniond RotationFromRows(const std::array<double, 9>& rows) {
  const Eigen::Matrix3d M =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
  return Eigen::Quaterniond(M).normalized();
}

// Readings and truth at the IMU's stamps.
void AddImu(const SimulationOptions& options, double rate_hz, SimulatedRecording* recording) {
  const ImuUnderSimulation imu{.calibration = recording->true_rig.imu,
                               .noise = recording->noise,
                               .biases = {.b_g = ToVector3(options.b_g_rad_per_s, "b_g_rad_per_s"),
                                          .b_a = ToVector3(options.b_a_m_per_s2, "b_a_m_per_s2")},
                               .g_G = recording->g_G};
  const ImuSampling sampling{.rate_hz = rate_hz,
                             .gyroscope_range = options.gyroscope_range_rad_per_s,
                             .accelerometer_range = options.accelerometer_range_m_per_s2,
                             .jitter_s = options.imu_jitter_s,
                             .jitter_is_stamped = options.imu_jitter_is_stamped,
                             .drop_share = options.imu_drop_share};
  SimulatedImu simulated = SimulateImu(*recording->trajectory, recording->start, imu, sampling,
                                       static_cast<std::uint64_t>(options.seed));
  recording->imu = std::move(simulated.samples);
  recording->truth = std::move(simulated.truth);
  recording->dropped_imu_samples = simulated.dropped;
  recording->clipped_gyroscope_samples = simulated.clipped_gyroscope;
  recording->clipped_accelerometer_samples = simulated.clipped_accelerometer;
}

}  // namespace

InertialState SimulatedRecording::TruthAt(Timestamp instant) const {
  CHECK_GE(instant, truth.front().instant);
  CHECK_LE(instant, truth.back().instant);
  auto after =
      std::lower_bound(truth.begin(), truth.end(), instant,
                       [](const InertialState& state, Timestamp t) { return state.instant < t; });
  InertialState state;
  state.instant = instant;
  const Kinematics k = trajectory->At(SecondsBetween(start, instant));
  state.nav = {.R_GB = k.T_GB.R, .p_GB = k.T_GB.p, .v_GB = k.v_GB};
  state.biases = after->biases;
  if (after->instant > instant) {
    const auto before = after - 1;
    const double share =
        SecondsBetween(before->instant, instant) / SecondsBetween(before->instant, after->instant);
    state.biases.b_g += (1.0 - share) * (before->biases.b_g - after->biases.b_g);
    state.biases.b_a += (1.0 - share) * (before->biases.b_a - after->biases.b_a);
  }
  return state;
}

RigCalibration EurocLikeRig(int cameras) {
  // R_BC by rows and p_BC [m]; turned round once to the thesis's R_CB and p_CB.
  struct Mount {
    std::array<double, 9> R_BC;
    Eigen::Vector3d p_BC;
    std::array<double, 9> parameters;
  };
  const std::array<Mount, 2> mounts = {
      Mount{{0.0149, -0.99988, 0.0041, 0.99956, 0.0150, 0.0257, -0.0258, 0.0038, 0.99966},
            {-0.0216, -0.0647, 0.0098},
            {458.7, 457.3, 367.2, 248.4, -0.2834, 0.0740, 1.9e-4, 1.8e-5, 0.0}},
      Mount{{0.0126, -0.99976, 0.0182, 0.99960, 0.0130, 0.0252, -0.0254, 0.0179, 0.99952},
            {-0.0198, 0.0454, 0.0079},
            {457.6, 456.1, 380.0, 255.2, -0.2837, 0.0745, -1.0e-4, -3.6e-5, 0.0}}};
  RigCalibration rig;
  for (int i = 0; i < cameras; ++i) {
    const Mount& mount = mounts[static_cast<std::size_t>(i)];
    const Eigen::Quaterniond R_CB = RotationFromRows(mount.R_BC).conjugate();
    CameraCalibration camera;
    camera.model =
        CameraModel(DistortionModel::kRadialTangential, 752, 480,
                    Eigen::Map<const Eigen::Matrix<double, 9, 1>>(mount.parameters.data()));
    camera.R_CB = R_CB;
    camera.p_CB = -(R_CB * mount.p_BC);
    rig.cameras.push_back(camera);
  }
  return rig;
}

void CheckIsFree(const Scenario& scenario, Timestamp stamp) {
  // A camera has a size.
  constexpr double kMargin_m = 0.02;
  const double t_s = SecondsBetween(scenario.start, stamp);
  const Pose T_GB = scenario.trajectory->At(t_s).T_GB;
  for (const CameraCalibration& camera : scenario.true_rig.cameras) {
    const Eigen::Vector3d p_GC = T_GB * Pose{camera.R_CB, camera.p_CB}.Inverse().p;
    if (scenario.world->IsFree(p_GC, kMargin_m, t_s)) continue;
    throw InputError("", 0, "trajectory",
                     "at " + FormatNumber(std::round(1e3 * t_s) * 1e-3) +
                         " s a camera is inside something or outside of the world " +
                         scenario.world->name() + ", at (" +
                         FormatNumber(std::round(100.0 * p_GC.x()) / 100.0) + ", " +
                         FormatNumber(std::round(100.0 * p_GC.y()) / 100.0) + ", " +
                         FormatNumber(std::round(100.0 * p_GC.z()) / 100.0) +
                         ") m; expected a path through free space");
  }
}

std::vector<Timestamp> FrameStamps(const Scenario& scenario, const SimulationOptions& options) {
  double frames_s = scenario.trajectory->duration_s() - 2.0 * kImuMargin_s;
  if (options.duration_s > 0.0) frames_s = std::min(frames_s, options.duration_s);
  if (frames_s < 0.0) {
    throw InputError("", 0, "trajectory",
                     "lasts " + FormatNumber(scenario.trajectory->duration_s()) +
                         " s; expected at least " + FormatNumber(2.0 * kImuMargin_s) + " s");
  }
  // Frames fall on the IMU's stamps where the rates divide, as EuRoC's do.
  const Timestamp first =
      EvenStamp(scenario.start, static_cast<int>(std::lround(kImuMargin_s * scenario.imu_rate_hz)),
                scenario.imu_rate_hz);
  const int count = static_cast<int>(std::floor(frames_s * scenario.camera_rate_hz + 1e-6)) + 1;
  std::vector<Timestamp> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(EvenStamp(first, i, scenario.camera_rate_hz));
  return stamps;
}

SimulatedRecording SimulateIn(const Scenario& scenario, const SimulationOptions& options) {
  SimulatedRecording recording;
  recording.trajectory = scenario.trajectory;
  recording.start = scenario.start;
  recording.label = scenario.label;
  recording.g_G = {0.0, 0.0, -scenario.gravity_m_per_s2};
  recording.noise = scenario.noise;
  recording.pixel_noise_px = options.noise_scale * options.pixel_noise_px;
  recording.true_rig = scenario.true_rig;
  recording.told_rig = DrawToldRig(
      recording.true_rig, Scaled(options.told_errors, options.noise_scale), options.told_imu_frame,
      options.told_cameras, static_cast<std::uint64_t>(options.seed));
  if (scenario.recorded) {
    recording.imu = scenario.recorded->imu;
    recording.truth = scenario.recorded->states;
  } else {
    AddImu(options, scenario.imu_rate_hz, &recording);
  }

  TrackSimulator tracks(
      options, MovingCamera(recording.true_rig, recording.trajectory, recording.start),
      *scenario.scene, Random(static_cast<std::uint64_t>(options.seed), kTrackStream));
  for (const Timestamp stamp : FrameStamps(scenario, options)) {
    if (scenario.world) CheckIsFree(scenario, stamp);
    recording.frames.push_back(tracks.Observe(stamp));
  }
  return recording;
}

SimulatedRecording Simulate(const SimulationOptions& options) {
  return SimulateIn(MakeScenario(options, false), options);
}

SimulatedRecording Simulate(const SimulationOptions& options,
                            std::shared_ptr<const Trajectory> trajectory) {
  return SimulateIn(MakeScenario(options, std::move(trajectory)), options);
}

InitialCondition DrawInitialCondition(const InertialState& truth, const Matrix15d& covariance,
                                      Random* random) {
  const Eigen::LDLT<Matrix15d> ldlt(covariance);
  CHECK(ldlt.isPositive()) << "a start covariance must be positive semidefinite";
  const Vector15d scaled =
      ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().cwiseProduct(random->NormalVector<15>());
  const Vector15d error = ldlt.transpositionsP().transpose() * Vector15d(ldlt.matrixL() * scaled);
  // The error is true minus estimate, hence the sign.
  return {.state = BoxPlus(truth, Vector15d(-error)), .covariance = covariance};
}

EstimatorSetup MakeSetup(const SimulatedRecording& recording, const SharedOptions& shared) {
  EstimatorSetup setup;
  setup.rig = recording.told_rig;
  setup.imu_noise = shared.imu_noise_factors.Times(recording.noise);
  setup.g_G = recording.g_G;
  setup.shared = shared;
  setup.shared.pixel_noise_px = recording.pixel_noise_px;
  return setup;
}

const std::vector<std::string>& SimulationPresetNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {"room_easy", "room_easy_stereo", "room_rest",
                                    "hover",     "excited",          "outliers"};
    for (const EurocSequence& sequence : EurocSequences()) all.push_back(sequence.name);
    return all;
  }();
  return names;
}

SimulationOptions SimulationPreset(const std::string& name) {
  SimulationOptions options;
  for (const EurocSequence& sequence : EurocSequences()) {
    if (sequence.name != name) continue;
    options.trajectory = name;
    options.duration_s = sequence.thesis.duration_s;
    options.rest_s = kEurocRest_s;
    return options;
  }
  if (name == "room_easy") return options;
  if (name == "room_easy_stereo") {
    options.cameras = 2;
  } else if (name == "room_rest") {
    options.rest_s = 2.0;
  } else if (name == "hover") {
    options.trajectory = "hover";
  } else if (name == "excited") {
    options.trajectory = "lissajous";
  } else if (name == "outliers") {
    options.outlier_share = 0.02;
    options.mismatch_share = 0.002;
  } else {
    std::string known;
    for (const std::string& each : SimulationPresetNames()) {
      known += (known.empty() ? "" : ", ") + each;
    }
    throw InputError("", 0, "preset", "unknown preset '" + name + "'; expected " + known);
  }
  return options;
}

}  // namespace duet
