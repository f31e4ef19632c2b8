#include "experiments/observed_states.h"

#include <algorithm>
#include <filesystem>

#include "common/imu/imu_delta.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/record_tables.h"
#include "experiments/simulation/recorded_motion.h"

namespace duet {
namespace {

std::vector<InertialState> StatesOf(const GroundTruth& truth, const Recording& recording,
                                    bool apply_time_shift) {
  if (!truth.has_velocities() || !truth.has_biases()) {
    Recording with_truth = recording;
    with_truth.truth = truth;
    return FollowRecording(with_truth, recording.folder.filename().string(),
                           {.apply_time_shift = apply_time_shift})
        .states;
  }
  std::vector<InertialState> states;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const StampedPose& pose = truth.poses[i];
    states.push_back(
        {.instant = pose.timestamp,
         .nav = {.R_GB = pose.T_GB.R, .p_GB = pose.T_GB.p, .v_GB = truth.velocities[i]},
         .biases = truth.biases[i]});
  }
  return states;
}

}  // namespace

std::vector<InertialState> StatesOfTruth(const Recording& recording) {
  if (!recording.truth) {
    throw InputError(recording.folder.string() +
                     " has no ground truth (state_groundtruth_estimate0/data.csv); expected one, "
                     "or --estimate with the folder of a run");
  }
  return StatesOf(*recording.truth, recording, /*apply_time_shift=*/true);
}

std::vector<InertialState> StatesOfEstimate(const std::string& path, const Recording& recording) {
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(path, ignored);
  std::filesystem::path file = path;
  if (folder) file /= "states.csv";
  if (file.filename() == "states.csv") {
    std::vector<InertialState> states = ReadStateTable(ReadTextFile(file), file.string());
    if (states.empty()) throw InputError(file.string(), 0, "", "has no state");
    return states;
  }
  // An estimate's stamps are the IMU's.
  return StatesOf(ReadTrajectoryFile(file), recording, /*apply_time_shift=*/false);
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
