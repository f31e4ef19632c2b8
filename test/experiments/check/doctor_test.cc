#include "experiments/check/doctor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/imu/inertial_truth_fit.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/check/camera_checks.h"
#include "experiments/check/imu_checks.h"
#include "experiments/check/stamp_checks.h"
#include "experiments/check/truth_checks.h"
#include "experiments/simulation/write_recording.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kRadians = 3.14159265358979323846 / 180.0;

SimulatedRecording Flight(double rest_s = 0.0) {
  SimulationOptions options;
  options.duration_s = 10.0;
  options.rest_s = rest_s;
  options.cameras = 2;
  options.max_tracks = 40;
  return Simulate(options);
}

const Finding* Find(const Findings& findings, const std::string& code) {
  for (const Finding& finding : findings) {
    if (finding.code == code) return &finding;
  }
  return nullptr;
}

double Measured(const Findings& findings, const std::string& code, const std::string& name) {
  const Finding* finding = Find(findings, code);
  if (finding == nullptr) return std::nan("");
  for (const Measurement& each : finding->measured) {
    if (each.name == name) return each.value;
  }
  return std::nan("");
}

class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(fs::path(testing::TempDir()) / ("duet_check_" + name)) {
    fs::remove_all(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

TEST(Doctor, FindsNothingWrongWithASoundRecording) {
  const TemporaryFolder folder("sound");
  WriteSimulatedRecording(Flight(), folder.path());
  const Diagnosis diagnosis = Diagnose(folder.path());
  EXPECT_EQ(diagnosis.Worst(), Severity::kInfo) << DiagnosisText(diagnosis);
  EXPECT_TRUE(Find(diagnosis.findings, "gyro_truth"));
  EXPECT_TRUE(Find(diagnosis.findings, "gravity_truth"));
  EXPECT_TRUE(Find(diagnosis.findings, "cameras.synchrony"));
  EXPECT_EQ(DiagnosisJson(diagnosis)["worst"], "info");
}

TEST(Doctor, StampsOutOfOrderBecomeAFindingThatNamesFileAndLine) {
  const TemporaryFolder folder("order");
  SimulatedRecording flight = Flight();
  std::swap(flight.imu[100].timestamp, flight.imu[101].timestamp);
  WriteSimulatedRecording(flight, folder.path());
  const Diagnosis diagnosis = Diagnose(folder.path());
  EXPECT_EQ(diagnosis.Worst(), Severity::kError);
  const Finding* finding = Find(diagnosis.findings, "unreadable");
  ASSERT_TRUE(finding);
  // Sample 101 stands in line 103, after the header.
  EXPECT_NE(finding->text.find("imu0/data.csv:103"), std::string::npos) << finding->text;
}

TEST(Doctor, AFolderWithoutAnImuIsBadInput) {
  EXPECT_THROW(static_cast<void>(Diagnose("/nowhere")), InputError);
  EXPECT_THROW(static_cast<void>(Diagnose(testing::TempDir())), InputError);
}

TEST(StampChecks, CountsWhatIsMissing) {
  std::vector<Timestamp> stamps;
  for (int i = 0; i < 1000; ++i) {
    if (i < 300 || i > 314) stamps.push_back(5'000'000LL * i);
  }
  const Findings findings = CheckStamps("imu", stamps, 200.0, 0.05, 0);
  ASSERT_TRUE(Find(findings, "imu.gap"));
  EXPECT_EQ(Find(findings, "imu.gap")->severity, Severity::kError);
  EXPECT_EQ(Measured(findings, "imu.gap", "missing"), 15.0);
  EXPECT_NEAR(Measured(findings, "imu.gap", "longest_s"), 0.08, 1e-12);
  EXPECT_FALSE(Find(findings, "imu.rate_told"));
  EXPECT_TRUE(Find(CheckStamps("imu", stamps, 100.0, 0.05, 0), "imu.rate_told"));
}

TEST(StampChecks, MeasuresTheOffsetBetweenCameras) {
  std::vector<Timestamp> first;
  std::vector<Timestamp> second;
  for (int i = 0; i < 100; ++i) {
    first.push_back(50'000'000LL * i);
    second.push_back(50'000'000LL * i + 2'000'000);
  }
  EXPECT_EQ(Find(CheckSynchrony(first, first), "cameras.synchrony")->severity, Severity::kInfo);
  const Findings findings = CheckSynchrony(first, second);
  EXPECT_EQ(Find(findings, "cameras.synchrony")->severity, Severity::kWarning);
  EXPECT_NEAR(Measured(findings, "cameras.synchrony", "median_offset_s"), 0.002, 1e-12);
}

TEST(ImuChecks, SeesSaturationAndVibrationAtRest) {
  SimulatedRecording flight = Flight(3.0);
  Recording recording = ToRecording(flight);
  const auto check = [&] {
    return CheckImu(recording.imu, recording.imu_sensor,
                    FindRest(recording.imu, recording.truth->poses, 9.81), true);
  };
  Findings findings = check();
  EXPECT_NEAR(Measured(findings, "rest", "rest_s"), 3.0, 0.5);
  EXPECT_NEAR(Measured(findings, "imu.noise_at_rest", "gyroscope_ratio"), 1.0, 0.2);
  EXPECT_NEAR(Measured(findings, "imu.noise_at_rest", "accelerometer_ratio"), 1.0, 0.2);
  EXPECT_EQ(Find(findings, "imu.noise_at_rest")->severity, Severity::kInfo);

  Random random(3);
  for (ImuSample& sample : recording.imu) {
    sample.omega_m += 0.1 * random.NormalVector<3>();
    sample.omega_m.y() = std::clamp(sample.omega_m.y(), -0.2, 0.2);
  }
  findings = check();
  EXPECT_TRUE(Find(findings, "imu.saturation.gyroscope.y"));
  EXPECT_FALSE(Find(findings, "imu.saturation.gyroscope.x"));
  EXPECT_EQ(Find(findings, "imu.noise_at_rest")->severity, Severity::kWarning);
}

TEST(ImuChecks, FindsRestByTheImuAlone) {
  const SimulatedRecording flight = Flight(3.0);
  const std::vector<RestSpan> rest = FindRest(flight.imu, {}, 9.81);
  ASSERT_FALSE(rest.empty());
  EXPECT_EQ(rest.front().start, flight.imu.front().timestamp);
  EXPECT_NEAR(SecondsBetween(rest.front().start, rest.front().end), 3.0, 0.5);
}

// The truth's clock and body frame are changed; the fit says by how much.
TEST(TruthChecks, FindTimeShiftAndRotation) {
  Recording recording = ToRecording(Flight());
  const Vector3d rotation = Vector3d(2.0, -1.0, 1.5) * kRadians;
  for (StampedPose& pose : recording.truth->poses) {
    pose.timestamp -= 12'000'000;
    pose.T_GB.R = pose.T_GB.R * ExpQuaternion(rotation);
  }
  const auto fit = FitGyroToTruth(recording.imu, recording.truth->poses);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->time_shift_s, 0.012, 2e-4);
  // x_I = R_IB x_B with the truth's new body frame B.
  EXPECT_LT((Log(fit->R_IB) - rotation).norm(), 0.05 * kRadians);
  // The means of the white noise and of the bias's walk over ten seconds.
  EXPECT_LT((fit->bias - Vector3d(-0.002, 0.021, 0.075)).norm(), 1e-3);
  const Findings findings = CheckTruth(recording, recording.imu.front().timestamp);
  EXPECT_TRUE(Find(findings, "gyro_truth.time_shift"));
  EXPECT_TRUE(Find(findings, "gyro_truth.rotation"));
}

TEST(TruthChecks, FindJumps) {
  Recording recording = ToRecording(Flight());
  for (std::size_t i = 900; i < recording.truth->poses.size(); ++i) {
    recording.truth->poses[i].T_GB.p += Vector3d(0.01, 0.0, -0.02);
  }
  const Findings findings = CheckTruth(recording, recording.imu.front().timestamp);
  EXPECT_EQ(Measured(findings, "truth.jumps", "count"), 1.0);
  EXPECT_NEAR(Measured(findings, "truth.jumps", "largest_m"), std::hypot(0.01, 0.02), 5e-4);
  // The fits are not led astray by it.
  EXPECT_FALSE(Find(findings, "gyro_truth.time_shift"));
  EXPECT_FALSE(Find(findings, "gravity_truth.direction"));
}

TEST(TruthChecks, FindATiltedAndAnInvertedTruth) {
  Recording recording = ToRecording(Flight());
  const Eigen::Quaterniond tilt = ExpQuaternion(Vector3d(4.0 * kRadians, 0, 0));
  for (StampedPose& pose : recording.truth->poses) {
    pose.T_GB = {tilt * pose.T_GB.R, tilt * pose.T_GB.p};
  }
  recording.truth->velocities.clear();
  Findings findings = CheckTruth(recording, recording.imu.front().timestamp);
  EXPECT_NEAR(Measured(findings, "gravity_truth", "tilt_deg"), 4.0, 0.5);
  EXPECT_NEAR(Measured(findings, "gravity_truth", "gravity_m_per_s2"), 9.81, 0.05);
  EXPECT_EQ(Find(findings, "gravity_truth.direction")->severity, Severity::kWarning);

  recording = ToRecording(Flight());
  for (StampedPose& pose : recording.truth->poses) pose.T_GB.R = pose.T_GB.R.conjugate();
  findings = CheckTruth(recording, recording.imu.front().timestamp);
  ASSERT_TRUE(Find(findings, "gravity_truth.direction"));
  EXPECT_EQ(Find(findings, "gravity_truth.direction")->severity, Severity::kError);
}

TEST(CalibrationChecks, RefuseWhatCannotBe) {
  const RigCalibration rig = EurocLikeRig(2);
  for (const Finding& finding : CheckCalibration(rig, {0, 1})) {
    EXPECT_EQ(finding.severity, Severity::kInfo) << finding.text;
  }
  RigCalibration halved = rig;  // intrinsics of an image of twice the size
  auto parameters = halved.cameras[0].model.parameters();
  parameters.head<4>() *= 2.0;
  halved.cameras[0].model.set_parameters(parameters);
  EXPECT_TRUE(Find(CheckCalibration(halved, {0, 1}), "cam0.principal_point"));
  RigCalibration same = rig;
  same.cameras[1] = same.cameras[0];
  EXPECT_EQ(Find(CheckCalibration(same, {0, 1}), "cameras.baseline_size")->severity,
            Severity::kError);
  RigCalibration millimetres = rig;
  millimetres.cameras[0].p_CB *= 1000.0;
  EXPECT_TRUE(Find(CheckCalibration(millimetres, {0, 1}), "cam0.lever_arm"));
}

TEST(Doctor, WhatIsKnownOfRealRecordingsIsFound) {
  const char* told = std::getenv("DUET_DATA");
  const fs::path data =
      told != nullptr ? fs::path(told) : fs::path(DUET_SOURCE_DIR) / ".." / "shared" / "data";
  if (!fs::exists(data / "inertial")) {
    GTEST_SKIP() << "SKIPPED: no recordings in " << data << "; set DUET_DATA";
  }
  // Its truth jumps by 9 mm, 5 mm and 3 mm, 0.97, 1.77 and 12.77 s after the first IMU sample.
  const Diagnosis easy = Diagnose(data / "euroc" / "MH_01_easy_05s");
  EXPECT_NEAR(Measured(easy.findings, "truth.jumps", "largest_m"), 0.009, 0.001);
  EXPECT_GE(Measured(easy.findings, "truth.jumps", "count"), 3.0);
  EXPECT_LT(Measured(easy.findings, "gravity_truth", "tilt_deg"), 1.0);
  EXPECT_EQ(easy.Worst(), Severity::kWarning);
  // It stands still while its motors run.
  const Diagnosis standing = Diagnose(data / "euroc" / "V1_01_easy_00s");
  EXPECT_NEAR(Measured(standing.findings, "rest", "rest_s"), 3.45, 0.05);
  EXPECT_GT(Measured(standing.findings, "imu.noise_at_rest", "gyroscope_ratio"), 10.0);
}

}  // namespace
}  // namespace duet
