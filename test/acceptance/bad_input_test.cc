#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <ostream>

#include "test/acceptance/program.h"
#include "test/acceptance/small_recording.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

using testing::HasSubstr;

/// One way to spoil a recording or a call, and what the one line on stderr has to name.
struct BadInput {
  const char* name;
  std::function<void(const fs::path& mav)> spoil;
  std::vector<std::string> arguments;
  std::vector<std::string> expected;

  friend void PrintTo(const BadInput& input, std::ostream* out) { *out << input.name; }
};

void Replace(const fs::path& path, const std::string& old_text, const std::string& new_text) {
  std::string text = ReadFile(path);
  const std::size_t place = text.find(old_text);
  ASSERT_NE(place, std::string::npos) << old_text << " in " << path;
  WriteFile(path, text.replace(place, old_text.size(), new_text));
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

void EditLines(const fs::path& path, const std::function<void(std::vector<std::string>*)>& edit) {
  std::vector<std::string> lines = Lines(ReadFile(path));
  edit(&lines);
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  WriteFile(path, text);
}

fs::path Image(const fs::path& mav, int index) {
  return mav / "cam0/data" / (std::to_string(kSmallFirstImage + index * 50'000'000LL) + ".png");
}

void Nothing(const fs::path& /*mav*/) {}

std::vector<BadInput> BadInputs() {
  const auto imu = [](const fs::path& mav) { return mav / "imu0/data.csv"; };
  return {
      {"MissingFolder",
       [](const fs::path& mav) { fs::remove_all(mav.parent_path()); },
       {},
       {"recording", "no such folder"}},
      {"NoImuFolder",
       [](const fs::path& mav) { fs::remove_all(mav / "imu0"); },
       {},
       {"recording", "imu0"}},
      {"EmptyTable",
       [=](const fs::path& mav) { WriteFile(imu(mav), ""); },
       {},
       {"imu0/data.csv", "empty"}},
      {"TruncatedTable",
       [=](const fs::path& mav) {
         const std::string text = ReadFile(imu(mav));
         WriteFile(imu(mav), text.substr(0, text.size() - 20));
       },
       {},
       {"imu0/data.csv:"}},
      {"NotANumber",
       [=](const fs::path& mav) {
         EditLines(imu(mav), [](auto* lines) {
           (*lines)[7] = (*lines)[7].substr(0, (*lines)[7].rfind(',')) + ",nan";
         });
       },
       {},
       {"imu0/data.csv:8"}},
      {"TimeGoesBackwards",
       [=](const fs::path& mav) {
         EditLines(imu(mav), [](auto* lines) { std::swap((*lines)[5], (*lines)[6]); });
       },
       {},
       {"imu0/data.csv:7"}},
      {"DuplicatedStamp",
       [=](const fs::path& mav) {
         EditLines(imu(mav), [](auto* lines) { (*lines)[6] = (*lines)[5]; });
       },
       {},
       {"imu0/data.csv:7"}},
      {"ImuGapLongerThanAFrame",
       [=](const fs::path& mav) {
         EditLines(imu(mav),
                   [](auto* lines) { lines->erase(lines->begin() + 200, lines->begin() + 215); });
       },
       {},
       {"imu0/data.csv", "gap of 0.08 s"}},
      {"FirstImageMissing",
       [](const fs::path& mav) { fs::remove(Image(mav, 0)); },
       {},
       {"1000000000000000000.png"}},
      {"FirstImageUnreadable",
       [](const fs::path& mav) { WriteFile(Image(mav, 0), "no image"); },
       {},
       {"1000000000000000000.png"}},
      {"ManyImagesMissing",
       [](const fs::path& mav) {
         for (const int i : {7, 11, 12, 20}) fs::remove(Image(mav, i));
       },
       {},
       {".png"}},
      {"ImageOfAnotherSize",
       [](const fs::path& mav) {
         cv::imwrite(Image(mav, 3), cv::Mat(200, 320, CV_8U, cv::Scalar(90)));
       },
       {},
       {"1000000000150000000.png", "320 x 200", "320 x 240"}},
      {"NoDistortion",
       [](const fs::path& mav) {
         Replace(mav / "cam0/sensor.yaml", "distortion_coefficients: [-0.1, 0.01, 0.0, 0.0]\n", "");
       },
       {},
       {"cam0/sensor.yaml", "distortion_coefficients"}},
      {"NoRotation",
       [](const fs::path& mav) {
         Replace(mav / "cam0/sensor.yaml", "data: [1.0, 0.0", "data: [1.0, 0.3");
       },
       {},
       {"cam0/sensor.yaml:", "T_BS"}},
      {"NoNoiseDensity",
       [](const fs::path& mav) {
         Replace(mav / "imu0/sensor.yaml", "gyroscope_noise_density: 1.6968e-04\n", "");
       },
       {},
       {"imu0/sensor.yaml", "gyroscope_noise_density"}},
      {"TruthThatDoesNotOverlap",
       [](const fs::path& mav) {
         WriteFile(mav / "state_groundtruth_estimate0/data.csv",
                   "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n"
                   "1,0,0,0,1,0,0,0\n5000001,0,0,0,1,0,0,0\n");
       },
       {"--init=groundtruth"},
       {"state_groundtruth_estimate0/data.csv", "overlap"}},
      {"NoTruthToStartFrom",
       [](const fs::path& mav) { fs::remove_all(mav / "state_groundtruth_estimate0"); },
       {"--init=groundtruth"},
       {"ground truth"}},
      {"UnknownKey",
       [](const fs::path& mav) { WriteFile(mav / "c.yaml", "shared:\n  colour: 3\n"); },
       {"--config=CONFIG"},
       {"c.yaml:2", "shared.colour"}},
      {"MisspeltKey",
       [](const fs::path& mav) { WriteFile(mav / "c.yaml", "shared:\n  max_track: 80\n"); },
       {"--config=CONFIG"},
       {"c.yaml:2", "max_track", "max_tracks"}},
      {"RepeatedKey",
       [](const fs::path& mav) {
         WriteFile(mav / "c.yaml", "shared:\n  max_tracks: 80\n  max_tracks: 90\n");
       },
       {"--config=CONFIG"},
       {"c.yaml:3", "max_tracks"}},
      {"WrongType",
       [](const fs::path& mav) { WriteFile(mav / "c.yaml", "shared:\n  max_tracks: many\n"); },
       {"--config=CONFIG"},
       {"c.yaml:2", "max_tracks", "integer from 10 to 2000"}},
      {"OverrideOutOfRange",
       Nothing,
       {"--set", "shared.max_tracks=3"},
       {"--set shared.max_tracks=3", "integer from 10 to 2000"}},
      {"NoSuchCamera", Nothing, {"--cameras=1"}, {"camera 1"}},
      {"StartAfterTheEnd", Nothing, {"--start=100"}, {"no frame in the span"}},
      {"NegativeStart", Nothing, {"--start=-1"}, {"start"}},
      {"NoTracksThere", Nothing, {"--tracks=NOWHERE"}, {"tracks0"}},
  };
}

class BadInputTest : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, GivesOneLineThatNamesItAndLeavesNothing) {
  const TemporaryFolder folder;
  WriteSmallRecording(folder.path() / "recording");
  GetParam().spoil(folder.path() / "recording/mav0");
  for (const char* command : {"run", "compare"}) {
    fs::create_directory(folder.path() / "results");
    std::vector<std::string> arguments = {command,   "--dataset", folder / "recording",
                                          "--quiet", "--out",     folder / "results/out"};
    if (command == std::string("run")) arguments.insert(arguments.end(), {"--backend", "msckf"});
    for (std::string argument : GetParam().arguments) {
      if (argument == "--config=CONFIG")
        argument = "--config=" + (folder / "recording/mav0/c.yaml");
      arguments.push_back(argument);
    }
    const ProgramResult result = RunDuet(arguments);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.err.rfind("duet: ", 0), 0U) << result.err;
    for (const std::string& part : GetParam().expected) EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_THAT(FilesIn(folder.path() / "results"), testing::IsEmpty());
    fs::remove_all(folder.path() / "results");
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadInputTest, testing::ValuesIn(BadInputs()),
                         [](const auto& param) { return std::string(param.param.name); });

TEST(OutputTest, AFolderThatExistsIsRefusedUntouched) {
  const TemporaryFolder folder;
  WriteSmallRecording(folder.path() / "recording");
  fs::create_directory(folder.path() / "out");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"run", "--backend=window"}, {"track"}, {"compare"}}) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"--dataset", folder / "recording", "--out", folder / "out"});
    const ProgramResult result = RunDuet(arguments);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr("out: exists"));
  }
  EXPECT_THAT(FilesIn(folder.path() / "out"), testing::IsEmpty());
}

TEST(OutputTest, AFolderThatCannotBeWrittenIsStatusFour) {
  const TemporaryFolder folder;
  WriteSmallRecording(folder.path() / "recording");
  WriteFile(folder / "file", "");
  const ProgramResult result = RunDuet(
      {"track", "--quiet", "--dataset", folder / "recording", "--out", folder / "file/out"});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("file/out"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST(DroppedImageTest, InTheMiddleIsCountedAndReportedAndNotTheEnd) {
  const TemporaryFolder folder;
  WriteSmallRecording(folder.path() / "recording");
  WriteFile(Image(folder.path() / "recording/mav0", 9), "no image");
  const ProgramResult result =
      RunDuet({"track", "--dataset", folder / "recording", "--out", folder / "out"});
  EXPECT_EQ(result.status, 0) << result.err;
  const std::string manifest = ReadFile(folder / "out/manifest.json");
  EXPECT_THAT(manifest, HasSubstr("1000000000450000000.png"));
  EXPECT_THAT(manifest, HasSubstr("\"frames\": 39"));
  EXPECT_THAT(result.err, HasSubstr("1000000000450000000.png"));
}

}  // namespace
}  // namespace duet
