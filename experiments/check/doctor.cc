#include "experiments/check/doctor.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/dataset/recording.h"
#include "common/support/input_error.h"
#include "experiments/check/camera_checks.h"
#include "experiments/check/imu_checks.h"
#include "experiments/check/stamp_checks.h"
#include "experiments/check/truth_checks.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

void Append(const Findings& more, Findings* findings) {
  findings->insert(findings->end(), more.begin(), more.end());
}

// The folder that holds imu0, as LoadRecording looks for it.
fs::path SensorFolder(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "mav0", ignored) ? folder / "mav0" : folder;
}

std::vector<int> CamerasOf(const fs::path& folder) {
  std::vector<int> cameras;
  std::error_code ignored;
  for (int k = 0; k < 2; ++k) {
    const std::string number = std::to_string(k);
    if (fs::exists(folder / ("cam" + number) / "data.csv", ignored) ||
        fs::exists(folder / ("tracks" + number) / "data.csv", ignored)) {
      cameras.push_back(k);
    }
  }
  return cameras;
}

std::optional<Recording> Load(const fs::path& folder, const std::vector<int>& cameras,
                              Findings* findings) {
  try {
    return LoadRecording(folder, {.cameras = cameras.empty() ? std::vector<int>{0} : cameras,
                                  .source = cameras.empty() ? RecordingOptions::Source::kNone
                                                            : RecordingOptions::Source::kAuto,
                                  .check_coverage = false});
  } catch (const InputError& error) {
    findings->push_back({Severity::kError, "unreadable", error.what(),
                         "Nothing that needs this file will run; repair it and check again."});
    return std::nullopt;
  }
}

void CheckFrames(const std::vector<Timestamp>& frames, const Recording& recording, int camera,
                 Timestamp origin, Findings* findings) {
  const std::string name = "cam" + std::to_string(camera);
  const double told_hz =
      recording.camera_sensors.empty() ? 0.0 : recording.camera_sensors.front().rate_hz;
  Append(CheckStamps(name, frames, told_hz, 0.0, origin), findings);
  if (frames.empty() || recording.imu.empty()) return;
  const double before_s = SecondsBetween(recording.imu.front().timestamp, frames.front());
  const double after_s = SecondsBetween(frames.back(), recording.imu.back().timestamp);
  if (before_s < 0.0 || after_s < 0.0) {
    int uncovered = 0;
    for (const Timestamp t : frames) {
      uncovered += t < recording.imu.front().timestamp || t > recording.imu.back().timestamp;
    }
    findings->push_back(
        {uncovered == static_cast<int>(frames.size()) ? Severity::kError : Severity::kWarning,
         name + ".imu_coverage",
         Sentence("%s: %d of %zu frames lie outside the IMU's time", name.c_str(), uncovered,
                  frames.size()),
         "Those frames are not used; if it is all of them, the clocks differ.",
         {{"frames", static_cast<double>(uncovered)}}});
  } else if (before_s < 0.05) {
    findings->push_back({Severity::kInfo,
                         name + ".imu_start",
                         Sentence("%s: the IMU starts %.0f ms before the first frame", name.c_str(),
                                  1e3 * before_s),
                         "A negative time offset leaves the first frames without IMU.",
                         {{"before_s", before_s}}});
  }
}

void CheckCameras(const fs::path& folder, const std::vector<int>& cameras, Timestamp origin,
                  Findings* findings) {
  std::vector<std::vector<Timestamp>> stamps;
  RigCalibration rig;
  std::vector<int> numbers;
  for (const int camera : cameras) {
    const std::optional<Recording> alone = Load(folder, {camera}, findings);
    if (!alone) continue;
    stamps.push_back(alone->FrameStamps());
    CheckFrames(stamps.back(), *alone, camera, origin, findings);
    if (alone->vision == Vision::kTracks && camera == cameras.front()) {
      Append(CheckTracks(alone->tracks.frames, alone->rig, alone->tracks.renamed_ids), findings);
    }
    rig.cameras.push_back(alone->rig.cameras.front());
    rig.t_d_s = alone->rig.t_d_s;
    rig.t_r_s = alone->rig.t_r_s;
    numbers.push_back(camera);
  }
  if (stamps.size() == 2) Append(CheckSynchrony(stamps[0], stamps[1]), findings);
  Append(CheckCalibration(rig, numbers), findings);
}

}  // namespace

Severity Diagnosis::Worst() const {
  Severity worst = Severity::kInfo;
  for (const Finding& finding : findings) worst = std::max(worst, finding.severity);
  return worst;
}

Diagnosis Diagnose(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw InputError(folder.string(), 0, "", "expected a folder in ASL form");
  }
  const fs::path sensors = SensorFolder(folder);
  if (!fs::exists(sensors / "imu0", ignored)) {
    throw InputError(folder.string(), 0, "", "holds neither mav0/imu0 nor imu0");
  }
  Diagnosis diagnosis;
  diagnosis.dataset = folder.string();
  Findings& findings = diagnosis.findings;
  const std::optional<Recording> inertial = Load(folder, {}, &findings);
  if (!inertial) return diagnosis;
  std::vector<Timestamp> stamps;
  for (const ImuSample& sample : inertial->imu) stamps.push_back(sample.timestamp);
  const Timestamp origin = stamps.empty() ? 0 : stamps.front();
  // A gap longer than a frame at 20 Hz can't be bridged.
  Append(CheckStamps("imu", stamps, inertial->imu_sensor.rate_hz, 0.05, origin), &findings);
  const std::vector<StampedPose> poses =
      inertial->truth ? inertial->truth->poses : std::vector<StampedPose>{};
  Append(CheckImu(inertial->imu, inertial->imu_sensor,
                  FindRest(inertial->imu, poses, inertial->imu_sensor.gravity), poses.size() > 2),
         &findings);
  const std::vector<int> cameras = CamerasOf(sensors);
  if (cameras.empty()) {
    findings.push_back({Severity::kInfo, "cameras.none", "no images and no tracks",
                        "For pairing with simulated vision only."});
  } else {
    CheckCameras(folder, cameras, origin, &findings);
  }
  if (inertial->truth) {
    Append(CheckTruth(*inertial, origin), &findings);
  } else {
    findings.push_back({Severity::kInfo, "truth.none", "no ground truth",
                        "Starts must be at rest, and errors can't be measured."});
  }
  for (const std::string& warning : inertial->warnings) {
    findings.push_back({Severity::kWarning, "reader", warning, ""});
  }
  return diagnosis;
}

std::string DiagnosisText(const Diagnosis& diagnosis) {
  std::string text = diagnosis.dataset + "\n";
  int warnings = 0;
  int errors = 0;
  for (const Finding& finding : diagnosis.findings) {
    warnings += finding.severity == Severity::kWarning;
    errors += finding.severity == Severity::kError;
    const char* mark = finding.severity == Severity::kInfo      ? "        "
                       : finding.severity == Severity::kWarning ? "WARNING "
                                                                : "ERROR   ";
    text += mark + finding.text + "\n";
    if (!finding.advice.empty()) text += "          -> " + finding.advice + "\n";
  }
  text += Sentence("%d error%s, %d warning%s\n", errors, errors == 1 ? "" : "s", warnings,
                   warnings == 1 ? "" : "s");
  return text;
}

nlohmann::ordered_json DiagnosisJson(const Diagnosis& diagnosis) {
  nlohmann::ordered_json json = {{"dataset", diagnosis.dataset},
                                 {"worst", SeverityName(diagnosis.Worst())},
                                 {"findings", nlohmann::ordered_json::array()}};
  for (const Finding& finding : diagnosis.findings) {
    nlohmann::ordered_json measured = nlohmann::ordered_json::object();
    for (const Measurement& each : finding.measured) {
      measured[each.name] =
          std::isfinite(each.value) ? nlohmann::ordered_json(each.value) : nlohmann::ordered_json();
    }
    json["findings"].push_back({{"severity", SeverityName(finding.severity)},
                                {"code", finding.code},
                                {"text", finding.text},
                                {"advice", finding.advice},
                                {"measured", measured}});
  }
  return json;
}

}  // namespace duet
