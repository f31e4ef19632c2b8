#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/dataset/recording.h"
#include "test/acceptance/program.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::StartsWith;

// A quarter of EuRoC's pixels, so that images are quick.
constexpr const char* kSmallRig = R"(imu0:
  rate_hz: 200
  gyroscope_noise_density: 1.7e-4
  gyroscope_random_walk: 2.0e-5
  accelerometer_noise_density: 2.0e-3
  accelerometer_random_walk: 3.0e-3
cam0:
  rate_hz: 20
  T_BS: [[0, -1, 0, 0.02], [1, 0, 0, -0.06], [0, 0, 1, 0.01], [0, 0, 0, 1]]
  camera_model: pinhole
  resolution: [376, 240]
  intrinsics: [229, 229, 184, 124]
  distortion_model: radial-tangential
  distortion_coefficients: [-0.28, 0.07, 2.0e-4, 0.0]
)";

class SimulateTest : public testing::Test {
 protected:
  SimulateTest() { WriteFile(folder_ / "rig.yaml", kSmallRig); }

  [[nodiscard]] ProgramResult Simulate(std::vector<std::string> arguments,
                                       const std::string& out) const {
    arguments.insert(arguments.begin(), {"simulate", "--quiet", "--out", folder_ / out});
    return RunDuet(arguments);
  }
  // A second of a walk through the room, as images.
  [[nodiscard]] ProgramResult Render(std::vector<std::string> arguments,
                                     const std::string& out) const {
    arguments.insert(arguments.end(),
                     {"--images", "--world", "room", "--trajectory", "room_walk", "--sensors",
                      folder_ / "rig.yaml", "--set", "duration_s=1.5"});
    return Simulate(std::move(arguments), out);
  }

  TemporaryFolder folder_;
};

std::vector<std::string> RelativeFiles(const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), folder));
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST_F(SimulateTest, ImagesHaveTheSameBytesForAnyNumberOfThreadsAndAreTrackedWhereTheyAreTrue) {
  ASSERT_EQ(Render({"--threads", "1"}, "one").status, 0);
  ASSERT_EQ(Render({"--threads", "2"}, "two").status, 0);
  const std::vector<std::string> files = RelativeFiles(folder_ / "one/mav0");
  ASSERT_EQ(files, RelativeFiles(folder_ / "two/mav0"));
  EXPECT_EQ(files.size(), 31U + 2U + 2U + 3U);  // images, cam0, imu0, truth and labels
  for (const std::string& file : files) {
    EXPECT_TRUE(ReadFile(fs::path(folder_ / "one/mav0") / file) ==
                ReadFile(fs::path(folder_ / "two/mav0") / file))
        << file;
  }

  ASSERT_EQ(RunDuet({"track", "--quiet", "--dataset", folder_ / "one", "--out", folder_ / "tracks"})
                .status,
            0);
  const ProgramResult error = RunDuet({"trackerror", "--quiet", "--dataset", folder_ / "one",
                                       "--tracks", folder_ / "tracks", "--out", folder_ / "error"});
  ASSERT_EQ(error.status, 0) << error.err;
  const auto json = nlohmann::json::parse(ReadFile(folder_ / "error/track_error.json"));
  const auto& frame_to_frame = json.at("cameras").at(0).at("frame_to_frame");
  EXPECT_GT(frame_to_frame.at("count").get<int>(), 300);
  // The issue's bounds for the accurate mode hold for this easy walk in the fast one too.
  EXPECT_LT(frame_to_frame.at("median_px").get<double>(), 0.08);
  EXPECT_LT(frame_to_frame.at("rms_px").get<double>(), 0.15);
}

TEST_F(SimulateTest, ComparisonAndManifestSayWhatWasSimulated) {
  ASSERT_EQ(Simulate({"--world", "room", "--set", "duration_s=4"}, "flight").status, 0);
  const ProgramResult compare = RunDuet({"compare", "--quiet", "--init", "groundtruth", "--dataset",
                                         folder_ / "flight", "--out", folder_ / "compare"});
  ASSERT_EQ(compare.status, 0) << compare.err;
  EXPECT_THAT(compare.out, StartsWith("flight: simulated: room_walk, world room"));
  const auto manifest = nlohmann::json::parse(ReadFile(folder_ / "compare/manifest.json"));
  EXPECT_EQ(manifest.at("dataset").at("label"), "simulated: room_walk, world room");
}

TEST_F(SimulateTest, ARangeOfSeedsGivesADataSetEach) {
  ASSERT_EQ(Simulate({"--seeds", "3..4", "--set", "duration_s=1"}, "many").status, 0);
  EXPECT_EQ(FilesIn(folder_ / "many"), (std::vector<std::string>{"seed-3", "seed-4"}));
  ASSERT_EQ(Simulate({"--seed", "4", "--set", "duration_s=1"}, "single").status, 0);
  EXPECT_TRUE(ReadFile(folder_ / "many/seed-4/mav0/tracks0/data.csv") ==
              ReadFile(folder_ / "single/mav0/tracks0/data.csv"));
  EXPECT_FALSE(ReadFile(folder_ / "many/seed-3/mav0/tracks0/data.csv") ==
               ReadFile(folder_ / "single/mav0/tracks0/data.csv"));
}

TEST_F(SimulateTest, ASimulationIsRepeatedFromItsOwnSettings) {
  ASSERT_EQ(Render({"--seed", "5"}, "first").status, 0);
  ASSERT_EQ(Simulate({"--images", "--config", folder_ / "first/simulation.yaml"}, "again").status,
            0);
  for (const std::string& file : RelativeFiles(folder_ / "first/mav0")) {
    EXPECT_TRUE(ReadFile(fs::path(folder_ / "first/mav0") / file) ==
                ReadFile(fs::path(folder_ / "again/mav0") / file))
        << file;
  }
}

TEST_F(SimulateTest, OnePictureIsOneImageOfTheDataSet) {
  ASSERT_EQ(Render({}, "all").status, 0);
  ASSERT_EQ(Render({"--picture", "0.5"}, "picture.png").status, 0);
  const cv::Mat picture = cv::imread(folder_ / "picture.png", cv::IMREAD_UNCHANGED);
  const cv::Mat image =
      cv::imread(folder_ / "all/mav0/cam0/data/1400000000700000000.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(picture.size(), image.size());
  EXPECT_TRUE(std::equal(picture.datastart, picture.dataend, image.datastart));
}

// Each a line that names what is wrong, exit status 2, and nothing left behind.
TEST_F(SimulateTest, BadInputIsOneClearLineAndLeavesNothing) {
  std::string three_poses;
  std::string repeated;
  std::string jump;
  for (int i = 0; i < 40; ++i) {
    const std::string t = "1." + std::to_string(100 + 10 * i);
    if (i < 3) three_poses += t + " 0 0 1 0 0 0 1\n";
    repeated += (i == 7 ? "1.160" : t) + " 0 0 1 0 0 0 1\n";
    jump += t + (i < 20 ? " 0" : " 5") + " 0 1 0 0 0 1\n";
  }
  WriteFile(folder_ / "three.tum", three_poses);
  WriteFile(folder_ / "repeated.tum", repeated);
  WriteFile(folder_ / "jump.tum", jump);
  struct Case {
    std::vector<std::string> arguments;
    std::vector<std::string> expected;
  };
  const std::vector<Case> cases = {
      {{"--world", "romo"}, {"romo", "did you mean 'room'"}},
      {{"--trajectory", "circel"}, {"circel"}},
      {{"--trajectory", folder_ / "three.tum"}, {"three.tum", "poses"}},
      {{"--trajectory", folder_ / "repeated.tum"}, {"repeated.tum"}},
      {{"--trajectory", folder_ / "jump.tum"}, {"jump.tum"}},
      {{"--images"}, {"box", "room"}},
      {{"--world", "room", "--trajectory", "MH_03_medium", "--set", "duration_s=30"},
       {"room", "free space"}},
      {{"--sensors", folder_ / "missing.yaml"}, {"missing.yaml"}},
      {{"--sensors", folder_ / "rig.yaml", "--set", "cameras=2"}, {"rig.yaml", "expected two"}},
      {{"--imu", folder_ / "nowhere"}, {"nowhere"}},
      {{"--seeds", "5..3"}, {"--seeds", "5..3"}},
      {{"--seeds", "1..2", "--picture", "1", "--world", "room"}, {"--seeds", "--picture"}},
      {{"--set", "render.qualty=fast"}, {"qualty", "quality"}},
  };
  for (const Case& each : cases) {
    const ProgramResult result = Simulate(each.arguments, "bad");
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& word : each.expected) EXPECT_THAT(result.err, HasSubstr(word));
    EXPECT_THAT(FilesIn(folder_.path()), Each(testing::Not(StartsWith("bad"))));
  }
}

// A real flight's IMU, unchanged, and vision along its truth; every table says so.
TEST_F(SimulateTest, RecordedImuWithSyntheticVision) {
  const fs::path recording = RealData() / "inertial/V2_01_easy";
  if (!fs::exists(recording)) {
    GTEST_SKIP() << "no recording at " << recording << " (set DUET_DATA to the folder of them)";
  }
  const ProgramResult simulated =
      Simulate({"--imu", recording, "--world", "room", "--set", "duration_s=8"}, "real");
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  RecordingOptions imu_alone;
  imu_alone.source = RecordingOptions::Source::kNone;
  const std::vector<ImuSample> recorded = LoadRecording(recording, imu_alone).imu;
  const std::vector<ImuSample> written = LoadRecording(folder_ / "real", imu_alone).imu;
  ASSERT_EQ(written.size(), recorded.size());
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    ASSERT_EQ(written[i].timestamp, recorded[i].timestamp);
    ASSERT_EQ(written[i].omega_m, recorded[i].omega_m);
    ASSERT_EQ(written[i].a_m, recorded[i].a_m);
  }
  const ProgramResult compare =
      RunDuet({"compare", "--quiet", "--init", "groundtruth", "--dataset", folder_ / "real",
               "--out", folder_ / "compare", "--require", "msckf.ate.position_m<0.1", "--require",
               "window.ate.position_m<0.1"});
  EXPECT_EQ(compare.status, 0) << compare.err << compare.out;
  EXPECT_THAT(compare.out,
              StartsWith("real: real IMU, synthetic vision along V2_01_easy's truth, world room"));
}

}  // namespace
}  // namespace duet
