#include "common/dataset/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "common/support/input_error.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const char* const kImuYaml =
    "rate_hz: 200\ngyroscope_noise_density: 1e-4\ngyroscope_random_walk: 1e-5\n"
    "accelerometer_noise_density: 1e-3\naccelerometer_random_walk: 1e-4\n";
const char* const kCameraYaml =
    "T_BS: {rows: 4, cols: 4, data: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n"
    "rate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [50, 50, 32, 24]\n"
    "distortion_model: radtan\ndistortion_coefficients: [0, 0, 0, 0]\n";

/// A recording of one second: IMU at 100 Hz, two cameras at 10 Hz, truth at 20 Hz.
class RecordingTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("duet_recording_" + std::to_string(getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    Write("mav0/imu0/sensor.yaml", kImuYaml);
    std::string imu = "#timestamp [ns],...\n";
    for (int i = 0; i <= 100; ++i) imu += Stamp(10 * i) + ",0,0,0,0,0,9.81\n";
    Write("mav0/imu0/data.csv", imu);
    for (const std::string camera : {"cam0", "cam1"}) {
      Write("mav0/" + camera + "/sensor.yaml", kCameraYaml);
      std::string images = "#timestamp [ns],filename\n";
      for (int i = 0; i <= 10; ++i) images += Stamp(100 * i) + "," + Stamp(100 * i) + ".png\n";
      Write("mav0/" + camera + "/data.csv", images);
    }
    std::string truth;
    for (int i = 0; i <= 20; ++i) truth += Stamp(50 * i) + ",0,0,0,1,0,0,0\n";
    Write("mav0/state_groundtruth_estimate0/data.csv", truth);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string Stamp(int ms) { return std::to_string(1000000000LL + ms * 1000000LL); }
  void Write(const fs::path& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    WriteTextFile(folder_ / name, text);
  }
  void ExpectRefused(const std::string& message, const RecordingOptions& options = {}) const {
    EXPECT_THAT([&] { (void)LoadRecording(folder_, options); },
                ThrowsMessage<InputError>(HasSubstr(message)));
  }

  fs::path folder_;
};

TEST_F(RecordingTest, IsFoundFromTheFolderOfMav0AndFromMav0) {
  for (const fs::path& folder : {folder_, folder_ / "mav0"}) {
    const Recording recording = LoadRecording(folder, {});
    EXPECT_EQ(recording.vision, Vision::kImages);
    EXPECT_EQ(recording.imu.size(), 101U);
    ASSERT_EQ(recording.images.size(), 11U);
    EXPECT_THAT(recording.images[0].paths,
                ElementsAre((folder_ / "mav0/cam0/data" / (Stamp(0) + ".png")).string()));
    EXPECT_EQ(recording.rig.cameras.size(), 1U);
    EXPECT_EQ(recording.g_G(), Eigen::Vector3d(0, 0, -9.81));
    ASSERT_TRUE(recording.truth.has_value());
    EXPECT_EQ(recording.truth->poses.size(), 21U);
    EXPECT_FALSE(recording.truth->has_velocities());
    EXPECT_TRUE(recording.warnings.empty());
  }
}

TEST_F(RecordingTest, PairsTheImagesOfTheChosenCameras) {
  // cam1 lacks the stamp at 300 ms and ends at 600 ms.
  std::string images;
  for (const int ms : {0, 100, 200, 400, 500, 600}) images += Stamp(ms) + ",x.png\n";
  Write("mav0/cam1/data.csv", images);
  const Recording recording = LoadRecording(folder_, {.cameras = {0, 1}});
  EXPECT_EQ(recording.images.size(), 6U);
  EXPECT_EQ(recording.images[0].paths.size(), 2U);
  EXPECT_EQ(recording.unpaired_images, 1);
  EXPECT_EQ(recording.warnings.size(), 1U);
  EXPECT_EQ(LoadRecording(folder_, {.cameras = {1}}).images.size(), 6U);
  Write("mav0/cam1/data.csv", Stamp(1) + ",x.png\n");
  ExpectRefused("no stamp in common", {.cameras = {0, 1}});
}

TEST_F(RecordingTest, IsCutToTheSpanAskedFor) {
  const Recording recording = LoadRecording(folder_, {.start_s = 0.2, .duration_s = 0.3});
  ASSERT_EQ(recording.images.size(), 4U);
  EXPECT_EQ(std::to_string(recording.images[0].timestamp), Stamp(200));
  EXPECT_EQ(std::to_string(recording.images[3].timestamp), Stamp(500));
  EXPECT_EQ(recording.imu.size(), 101U) << "the IMU stays whole";
  ExpectRefused("has no frame in the span asked for", {.start_s = 5});
  ExpectRefused("start, duration", {.start_s = -1});
}

TEST_F(RecordingTest, TheFingerprintChangesWithAnyByteRead) {
  const std::string before = LoadRecording(folder_, {}).fingerprint;
  EXPECT_EQ(LoadRecording(folder_ / "mav0", {}).fingerprint, before);
  Write("mav0/cam0/data/" + Stamp(300) + ".png", "image");
  const std::string with_image = LoadRecording(folder_, {}).fingerprint;
  EXPECT_NE(with_image, before);
  Write("mav0/imu0/sensor.yaml", std::string(kImuYaml) + "# note\n");
  EXPECT_NE(LoadRecording(folder_, {}).fingerprint, with_image);
}

TEST_F(RecordingTest, WhatIsMissingIsNamed) {
  EXPECT_THAT([&] { (void)LoadRecording(folder_ / "none", {}); },
              ThrowsMessage<InputError>(HasSubstr("none: no such folder")));
  EXPECT_THAT([&] { (void)LoadRecording(folder_ / "mav0/cam0", {}); },
              ThrowsMessage<InputError>(HasSubstr("expected mav0 with imu0 in it")));
  ExpectRefused("neither images (cam2/data.csv) nor tracks", {.cameras = {2}});
  EXPECT_EQ(
      LoadRecording(folder_, {.cameras = {2}, .source = RecordingOptions::Source::kAny}).vision,
      Vision::kNone);
  fs::remove(folder_ / "mav0/cam0/sensor.yaml");
  ExpectRefused("cam0/sensor.yaml: no such file");
  fs::remove(folder_ / "mav0/imu0/data.csv");
  ExpectRefused("imu0/data.csv: no such file");
}

TEST_F(RecordingTest, AnImuGapLongerThanAFrameIsRefused) {
  std::string imu;
  for (int i = 0; i <= 100; ++i) {
    if (i <= 30 || i >= 42) imu += Stamp(10 * i) + ",0,0,0,0,0,9.81\n";
  }
  Write("mav0/imu0/data.csv", imu);
  ExpectRefused("gap of 0.12 s after 1300000000; expected at most the time between frames, 0.1 s");
  EXPECT_EQ(LoadRecording(folder_, {.check_coverage = false}).imu.size(), 90U);
  EXPECT_EQ(LoadRecording(folder_, {.start_s = 0.5}).imu.size(), 90U) << "outside of the span";
}

TEST_F(RecordingTest, WhatDoesNotOverlapIsRefused) {
  Write("mav0/state_groundtruth_estimate0/data.csv", Stamp(5000) + ",0,0,0,1,0,0,0\n");
  ExpectRefused("state_groundtruth_estimate0/data.csv: does not overlap the frames");
  Write("mav0/imu0/data.csv", Stamp(5000) + ",0,0,0,0,0,9.81\n");
  ExpectRefused("imu0/data.csv: does not overlap the frames");
}

TEST_F(RecordingTest, AMarkersPosesBecomeTheBodys) {
  fs::remove_all(folder_ / "mav0/state_groundtruth_estimate0");
  Write("mav0/vicon0/data.csv", Stamp(0) + ",1,2,3,0.70710678118654757,0,0,0.70710678118654757\n" +
                                    Stamp(900) + ",1,2,3,1,0,0,0\n");
  // The marker sits 0.1 m along the body's x; turned by 90 degrees about z that is G's y.
  Write("mav0/vicon0/sensor.yaml",
        "T_BS: {rows: 4, cols: 4, data: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n");
  const Recording recording = LoadRecording(folder_, {});
  EXPECT_LT((recording.truth->poses[0].T_GB.p - Eigen::Vector3d(1, 1.9, 3)).norm(), 1e-15);
  EXPECT_LT((recording.truth->poses[1].T_GB.p - Eigen::Vector3d(0.9, 2, 3)).norm(), 1e-15);
}

TEST_F(RecordingTest, UnknownKeysOfSensorsAreWarnings) {
  Write("mav0/cam0/sensor.yaml", std::string(kCameraYaml) + "vendor: x\n");
  EXPECT_THAT(LoadRecording(folder_, {}).warnings,
              ElementsAre(AllOf(HasSubstr("cam0/sensor.yaml: vendor"))));
}

TEST_F(RecordingTest, WhatIsWrittenLoadsToTheSame) {
  Recording recording = LoadRecording(folder_, {.cameras = {0, 1}});
  recording.vision = Vision::kTracks;
  for (const ImageStamp& image : recording.images) {
    recording.tracks.frames.push_back(
        {image.timestamp,
         {{image.timestamp, 0, {{1, 1.1F, 2.2F}, {2, 3.3F, 4.4F}}}, {image.timestamp, 1, {}}}});
  }
  WriteRecording(recording, folder_ / "copy");
  const Recording again = LoadRecording(folder_ / "copy", {.cameras = {0, 1}});
  EXPECT_EQ(again.vision, Vision::kTracks);
  EXPECT_EQ(HashTrackStream(again.tracks.frames), HashTrackStream(recording.tracks.frames));
  EXPECT_EQ(again.imu.size(), recording.imu.size());
  EXPECT_EQ(again.imu_sensor.noise.gyroscope_random_walk, 1e-5);
  EXPECT_EQ(again.rig.cameras[1].p_CB, recording.rig.cameras[1].p_CB);
  EXPECT_EQ(again.truth->poses.size(), recording.truth->poses.size());
  EXPECT_FALSE(again.truth->has_velocities());
  EXPECT_THROW(WriteRecording(recording, folder_ / "copy"), OutputError);

  // The tracks of another folder, with this recording's IMU.
  const Recording replay = LoadRecording(folder_, {.cameras = {0, 1},
                                                   .source = RecordingOptions::Source::kTracks,
                                                   .tracks_folder = folder_ / "copy" / "mav0"});
  EXPECT_EQ(HashTrackStream(replay.tracks.frames), HashTrackStream(recording.tracks.frames));
}

// Real recordings.

fs::path DataFolder() {
  const char* told = std::getenv("DUET_DATA");
  return told != nullptr ? fs::path(told)
                         : fs::path(__FILE__).parent_path() / "../../../../shared/data";
}

class RealRecordings : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(DataFolder() / "README.md")) {
      GTEST_SKIP() << "SKIPPED: no recordings at " << DataFolder()
                   << "; set DUET_DATA to the folder that holds euroc/, inertial/, openvins_sim/";
    }
  }
};

TEST_F(RealRecordings, EurocWithImages) {
  const fs::path folder = DataFolder() / "euroc/MH_01_easy_05s";
  const Recording mono = LoadRecording(folder, {});
  EXPECT_EQ(mono.images.size(), 320U);
  EXPECT_EQ(mono.imu.size(), 3491U);
  EXPECT_EQ(mono.truth->poses.size(), 3491U);
  EXPECT_TRUE(mono.truth->has_velocities());
  EXPECT_FALSE(mono.truth->has_biases());
  EXPECT_TRUE(mono.warnings.empty()) << mono.warnings.front();
  const Recording stereo = LoadRecording(folder, {.cameras = {0, 1}});
  EXPECT_EQ(stereo.images.size(), 160U);
  EXPECT_EQ(stereo.unpaired_images, 0);
  // The baseline of EuRoC's rig is 11 cm.
  const Pose T_C0B{stereo.rig.cameras[0].R_CB, stereo.rig.cameras[0].p_CB};
  const Pose T_C1B{stereo.rig.cameras[1].R_CB, stereo.rig.cameras[1].p_CB};
  EXPECT_NEAR((T_C1B * T_C0B.Inverse()).p.norm(), 0.110, 0.001);

  const Recording rest = LoadRecording(DataFolder() / "euroc/V1_01_easy_00s", {});
  EXPECT_EQ(rest.images.size(), 60U);
  EXPECT_EQ(rest.truth->poses.size(), 70U);
  EXPECT_TRUE(rest.truth->has_biases());
}

TEST_F(RealRecordings, InertialOnly) {
  for (const auto& [name, samples, poses, has_biases] :
       {std::tuple("MH_03_medium", 27008U, 26302U, false),
        std::tuple("MH_04_difficult", 20320U, 19753U, true),
        std::tuple("V1_03_difficult", 21500U, 20932U, true),
        std::tuple("V2_01_easy", 22800U, 22401U, true)}) {
    const Recording recording = LoadRecording(DataFolder() / "inertial" / name,
                                              {.source = RecordingOptions::Source::kNone});
    EXPECT_EQ(recording.imu.size(), samples) << name;
    EXPECT_EQ(recording.truth->poses.size(), poses) << name;
    EXPECT_EQ(recording.truth->has_biases(), has_biases) << name;
    EXPECT_EQ(recording.imu_sensor.rate_hz, 200.0) << name;
  }
}

TEST_F(RealRecordings, TrackStreams) {
  const Recording stereo = LoadRecording(DataFolder() / "openvins_sim/V1_01", {.cameras = {0, 1}});
  EXPECT_EQ(stereo.vision, Vision::kTracks);
  EXPECT_EQ(stereo.tracks.renamed_ids, 0) << "points seen again have a new id already";
  std::size_t observations = 0;
  for (const TrackFrameSet& set : stereo.tracks.frames) {
    ASSERT_EQ(set.frames.size(), 2U);
    observations += set.frames[0].observations.size() + set.frames[1].observations.size();
  }
  EXPECT_EQ(observations, 192000U);
  EXPECT_EQ(stereo.tracks.frames.size(), 800U);
  const Recording mono = LoadRecording(DataFolder() / "openvins_sim/V1_03", {});
  EXPECT_EQ(mono.tracks.frames.size(), 800U);
}

}  // namespace
}  // namespace duet
