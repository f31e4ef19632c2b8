#include "experiments/simulation/write_recording.h"

#include <cmath>

#include "common/config/yaml_node.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

// Stamps are evenly spaced to a nanosecond.
double RateOf(Timestamp first, Timestamp last, std::size_t count) {
  if (count < 2) return 0.0;
  return std::round(static_cast<double>(count - 1) / SecondsBetween(first, last) * 1e6) * 1e-6;
}

std::string List(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (i > 0) text += ", ";
    AppendNumber(values[i], &text);
  }
  return text + "]";
}

std::string ByRows(const Eigen::Matrix3d& M) {
  const Eigen::Matrix3d rows = M.transpose();
  return List(Eigen::Map<const Eigen::Matrix<double, 9, 1>>(rows.data()));
}

}  // namespace

Recording ToRecording(const SimulatedRecording& simulated) {
  const RigCalibration& rig = simulated.told_rig;
  Recording recording;
  recording.imu_sensor = {.noise = simulated.noise,
                          // The truth is there for lost samples too.
                          .rate_hz = RateOf(simulated.truth.front().instant,
                                            simulated.truth.back().instant, simulated.truth.size()),
                          .gravity = -simulated.g_G.z(),
                          .calibration = rig.imu};
  recording.imu = simulated.imu;
  recording.rig = rig;
  recording.vision = Vision::kTracks;
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
    CameraSensor sensor;
    sensor.calibration = rig.cameras[k];
    sensor.rate_hz = RateOf(simulated.frames.front().timestamp, simulated.frames.back().timestamp,
                            simulated.frames.size());
    sensor.t_d_s = rig.t_d_s;
    sensor.t_r_s = rig.t_r_s;
    sensor.readout_by_columns = rig.readout_by_columns;
    recording.camera_sensors.push_back(sensor);
    recording.camera_numbers.push_back(static_cast<int>(k));
  }
  recording.tracks.frames = simulated.frames;
  recording.truth = GroundTruthOf(simulated.truth);
  recording.label = simulated.label;
  return recording;
}

std::string TruthYaml(const SimulatedRecording& simulated) {
  const RigCalibration& rig = simulated.true_rig;
  std::string text =
      "# What the simulator used. The sensor files beside say what an estimator is told.\n";
  text += "gravity_m_per_s2: " + FormatNumber(-simulated.g_G.z()) + "\n";
  text += "label: " + QuotedYaml(simulated.label) + "\n";
  text += "gyroscope_noise_density: " + FormatNumber(simulated.noise.gyroscope_density) + "\n";
  text +=
      "accelerometer_noise_density: " + FormatNumber(simulated.noise.accelerometer_density) + "\n";
  text += "gyroscope_random_walk: " + FormatNumber(simulated.noise.gyroscope_random_walk) + "\n";
  text += "accelerometer_random_walk: " + FormatNumber(simulated.noise.accelerometer_random_walk) +
          "\n";
  text += std::string("readout_by_columns: ") + (rig.readout_by_columns ? "true" : "false") + "\n";
  text += "# of simulated tracks; images have what simulation.yaml says under render.photometry\n";
  text += "pixel_noise_sigma_px: " + FormatNumber(simulated.pixel_noise_px) + "\n";
  text += "time_offset_s: " + FormatNumber(rig.t_d_s) + "\n";
  text += "readout_time_s: " + FormatNumber(rig.t_r_s) + "\n";
  if (simulated.dropped_imu_samples > 0) {
    text += "imu_lost_samples: " + std::to_string(simulated.dropped_imu_samples) + "\n";
  }
  if (simulated.clipped_gyroscope_samples > 0) {
    text +=
        "gyroscope_clipped_samples: " + std::to_string(simulated.clipped_gyroscope_samples) + "\n";
  }
  if (simulated.clipped_accelerometer_samples > 0) {
    text += "accelerometer_clipped_samples: " +
            std::to_string(simulated.clipped_accelerometer_samples) + "\n";
  }
  text += "T_g: " + ByRows(rig.imu.T_g) + "\n";
  text += "T_s: " + ByRows(rig.imu.T_s) + "\n";
  text += "T_a: " + ByRows(rig.imu.T_a) + "\n";
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
    const CameraCalibration& camera = rig.cameras[k];
    const auto& parameters = camera.model.parameters();
    text += "cam" + std::to_string(k) + ":\n";
    text += "  R_CB: " + ByRows(camera.R_CB.toRotationMatrix()) + "  # by rows\n";
    text += "  p_CB_m: " + List(camera.p_CB) + "\n";
    text += "  intrinsics: " + List(parameters.head(CameraModel::kPinholeParameters)) +
            "  # fx fy ox oy [px]\n";
    text += "  distortion_model: " + std::string(DistortionModelName(camera.model.model())) + "\n";
    text += "  distortion_coefficients: " + List(parameters.tail(camera.model.distortion_count())) +
            "\n";
  }
  return text;
}

void WriteSimulatedRecording(const SimulatedRecording& simulated,
                             const std::filesystem::path& folder, bool tracks) {
  Recording recording = ToRecording(simulated);
  if (!tracks) recording.vision = Vision::kNone;
  WriteRecording(recording, folder);
  WriteTextFile(folder / "mav0" / "truth.yaml", TruthYaml(simulated));
}

}  // namespace duet
