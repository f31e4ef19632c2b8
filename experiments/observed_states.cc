#include "experiments/observed_states.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/imu/imu_delta.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/record_tables.h"
#include "experiments/simulation/recorded_motion.h"

namespace duet {
namespace {

KnownMotion Follow(const Recording& recording, bool apply_time_shift) {
  RecordedMotion followed = FollowRecording(recording, recording.folder.filename().string(),
                                            {.apply_time_shift = apply_time_shift});
  KnownMotion motion{.states = std::move(followed.states)};
  for (const InertialState& state : motion.states) {
    const Kinematics k = followed.trajectory->spline().At(state.instant);
    const ImuRates read = DistortRates(
        {.omega_B = k.omega_B, .a_B = k.T_GB.R.conjugate() * (k.a_G - recording.g_G())},
        recording.rig.imu, state.biases);
    motion.readings.push_back({state.instant, read.omega_B, read.a_B});
  }
  return motion;
}

}  // namespace

KnownMotion MotionOfTruth(const Recording& recording) {
  if (!recording.truth) {
    throw InputError(recording.folder.string() +
                     " has no ground truth (state_groundtruth_estimate0/data.csv); expected one, "
                     "or --estimate with the folder of a run");
  }
  return Follow(recording, /*apply_time_shift=*/true);
}

KnownMotion MotionOfEstimate(const std::string& path, const Recording& recording) {
  std::error_code ignored;
  std::filesystem::path file = path;
  if (std::filesystem::is_directory(file, ignored)) file /= "states.csv";
  KnownMotion motion;
  if (file.filename() == "states.csv") {
    motion.states = ReadStateTable(ReadTextFile(file), file.string());
    if (motion.states.empty()) throw InputError(file.string(), 0, "", "has no state");
    return motion;
  }
  Recording along = recording;
  along.truth = ReadTrajectoryFile(file);
  along.truth_file = file.string();
  motion = Follow(along, /*apply_time_shift=*/false);  // an estimate's stamps are the IMU's
  motion.readings.clear();
  return motion;
}

std::optional<InertialState> StateAt(const std::vector<InertialState>& states, Timestamp instant,
                                     const ImuBuffer& imu, const EstimatorSetup& setup) {
  constexpr double kLongestWay_s = 0.06;  // as between true poses in an evaluation
  if (states.empty()) return std::nullopt;
  auto nearest =
      std::lower_bound(states.begin(), states.end(), instant,
                       [](const InertialState& state, Timestamp t) { return state.instant < t; });
  if (nearest == states.end() || (nearest != states.begin() &&
                                  instant - (nearest - 1)->instant <= nearest->instant - instant)) {
    --nearest;
  }
  if (std::abs(SecondsBetween(nearest->instant, instant)) > kLongestWay_s) return std::nullopt;
  if (!imu.Covers(nearest->instant, instant)) return std::nullopt;
  InertialState state = *nearest;
  state.instant = instant;
  if (nearest->instant == instant) return state;
  std::vector<ImuSample> readings;
  imu.Extract(nearest->instant, instant, &readings);
  state.nav = Predict(
      nearest->nav,
      IntegrateImu(readings, nearest->biases, setup.rig.imu, setup.imu_noise,
                   {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false}),
      setup.g_G);
  return state;
}

}  // namespace duet
