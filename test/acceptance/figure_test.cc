#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <set>
#include <sstream>

#include "test/acceptance/program.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string OutputOf(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  for (char buffer[4096]; std::fgets(buffer, sizeof(buffer), pipe) != nullptr;) text += buffer;
  pclose(pipe);
  return text;
}

class FigureTest : public testing::Test {
 protected:
  // A comparison of two seconds, for all tests.
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const ProgramResult simulated =
        RunDuet({"simulate", "--preset", "room_easy", "--set", "duration_s=3", "--quiet", "--out",
                 *folder_ / "room"});
    ASSERT_EQ(simulated.status, 0) << simulated.err;
    const ProgramResult compared = RunDuet(
        {"compare", "--dataset", *folder_ / "room", "--init", "groundtruth", "--set",
         "shared.calibration.t_d.state=estimated", "--quiet", "--out", *folder_ / "compare"});
    ASSERT_EQ(compared.status, 0) << compared.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static ProgramResult Draw(const std::string& name) {
    return RunDuet({"figure", name, "--runs", *folder_ / "compare", "--out", *folder_ / "figures"});
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* FigureTest::folder_ = nullptr;

// What is hardly spread may still turn; and options that a figure does not have are no matter of
// taste.
TEST_F(FigureTest, ATurningGyroscopeIsNotAtRestAndStrayOptionsAreRefused) {
  for (const auto& [motion, status] : {std::pair{"circle", 2}, std::pair{"standstill", 0}}) {
    const std::string recording = *folder_ / motion;
    const ProgramResult made =
        RunDuet({"simulate", "--preset", "room_easy", "--set",
                 std::string("simulation.trajectory=") + motion, "--set", "simulation.duration_s=3",
                 "--set", "simulation.max_tracks=20", "--out", recording});
    ASSERT_EQ(made.status, 0) << made.err;
    const ProgramResult drawn = RunDuet({"figure", "thesis_3_2", "--runs", recording, "--out",
                                         *folder_ / ("rest_of_" + std::string(motion))});
    EXPECT_EQ(drawn.status, status) << drawn.err;
    if (status != 0) {
      EXPECT_THAT(drawn.err, HasSubstr("does not rest"));
    }
  }
  // What sets off slowly is not at rest any more.
  const std::string recording = *folder_ / "setting_off";
  ASSERT_EQ(RunDuet({"simulate", "--preset", "room_rest", "--set", "simulation.duration_s=6",
                     "--set", "simulation.max_tracks=20", "--out", recording})
                .status,
            0);
  const std::string folder = *folder_ / "rest_of_setting_off";
  ASSERT_EQ(RunDuet({"figure", "thesis_3_2", "--runs", recording, "--out", folder}).status, 0);
  EXPECT_THAT(ReadFile(folder + "/thesis_3_2.csv"), HasSubstr("400 samples at rest, 2.0 s"));
  const std::string out = *folder_ / "stray";
  EXPECT_THAT(RunDuet({"figure", "thesis_3_8", "--runs", "nowhere", "--out", out}).err,
              HasSubstr("nowhere: does not exist"));
  EXPECT_THAT(RunDuet({"figure", "thesis_3_8", "--component", "t_d", "--out", out}).err,
              HasSubstr("--component: is of duet figure calibration alone"));
}

// From the real program's records, all kinds of what is drawn; the others have unit tests.
TEST_F(FigureTest, FiguresOfAComparisonAreWrittenWholeWithTheirFontsEmbedded) {
  std::string fonts;
  for (const char* name :
       {"trajectory_top", "position_error", "rmse_over_runs", "nees_over_time", "relative_errors",
        "calibration", "cost_against_accuracy", "time_by_stage", "track_lengths",
        "information_spectrum", "normalized_errors", "thesis_5_4", "thesis_6_3"}) {
    const ProgramResult drawn = Draw(name);
    ASSERT_EQ(drawn.status, 0) << name << ": " << drawn.err;
    EXPECT_THAT(drawn.err, Not(HasSubstr("warning"))) << name;  // gnuplot's
    const std::string base = *folder_ / "figures" + ("/" + std::string(name));
    EXPECT_THAT(ReadFile(base + ".csv"), HasSubstr("# from ")) << name;
    if (drawn.err.find("gnuplot is not installed") != std::string::npos) continue;
    for (const char* ending : {".svg", ".pdf", ".png"}) {
      EXPECT_GT(ReadFile(base + ending).size(), 1000U) << name << ending;
    }
    fonts += OutputOf("pdffonts " + base + ".pdf 2>/dev/null | tail -n +3");
  }
  SKIP_WITHOUT_PROGRAM("pdffonts", "poppler-utils");
  std::istringstream lines(fonts);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_THAT(line, HasSubstr("LiberationSans"));
    EXPECT_THAT(line, HasSubstr(" yes yes ")) << "not embedded";
  }
  EXPECT_GE(count, 13);
}

// One with bands and lines, one with bars, texts and a logarithmic axis.
TEST_F(FigureTest, PgfplotsFilesCompile) {
  SKIP_WITHOUT_PROGRAM("pdflatex", "texlive-latex-base texlive-pictures");
  for (const char* name : {"nees_over_time", "time_by_stage"}) {
    if (!std::filesystem::exists(*folder_ / "figures" + ("/" + std::string(name)) + ".tex")) {
      ASSERT_EQ(Draw(name).status, 0);
    }
    const std::string log =
        OutputOf("cd " + (*folder_ / "figures") + " && pdflatex -interaction=nonstopmode " +
                 "-halt-on-error -jobname tex_" + name + " " + name + ".tex 2>&1 | tail -n 30");
    EXPECT_THAT(log, HasSubstr("Output written on tex_" + std::string(name) + ".pdf (1 page"))
        << log;
  }
}

// Without gnuplot, which the numbers do not need: as many tracks as the recording has.
TEST_F(FigureTest, TrackLengthsCountEveryTrackOfTheStreamAndNameItsHash) {
  const std::string path = std::getenv("PATH") == nullptr ? "" : std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const ProgramResult drawn = RunDuet(
      {"figure", "track_lengths", "--runs", *folder_ / "compare", "--out", *folder_ / "lengths"});
  setenv("PATH", path.c_str(), 1);
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(drawn.err, HasSubstr("gnuplot is not installed"));
  EXPECT_EQ(
      FilesIn(*folder_ / "lengths"),
      (std::vector<std::string>{"track_lengths.csv", "track_lengths.gp", "track_lengths.tex"}));
  std::set<std::string> ids;
  std::istringstream tracks(ReadFile(*folder_ / "room/mav0/tracks0/data.csv"));
  for (std::string line; std::getline(tracks, line);) {
    if (line[0] == '#') continue;
    const std::size_t begin = line.find(',') + 1;
    ids.insert(line.substr(begin, line.find(',', begin) - begin));
  }
  const std::string csv = ReadFile(*folder_ / "lengths/track_lengths.csv");
  EXPECT_THAT(csv, HasSubstr("# " + std::to_string(ids.size()) + " tracks;"));
  EXPECT_THAT(csv,
              HasSubstr("Stream " + ReadFile(*folder_ / "room/mav0/tracks.sha256").substr(0, 32)));
  double sum = 0.0;
  std::istringstream rows(csv);
  for (std::string line; std::getline(rows, line);) {
    if (line[0] == '#') continue;
    std::istringstream fields(line);
    std::string field;
    for (int k = 0; k < 4; ++k) std::getline(fields, field, ',');
    if (field != "nan") sum += std::stod(field);
  }
  EXPECT_EQ(sum, static_cast<double>(ids.size()));
}

// The grid's coordinates are chosen by flags; a choice that has no effect is no choice.
TEST_F(FigureTest, OneEstimatorIsDrawnWhereItIsChosen) {
  const auto draw = [&](const std::string& name, const std::vector<std::string>& choice) {
    std::vector<std::string> words = {
        "figure", name, "--runs", *folder_ / "compare", "--out", *folder_ / "chosen"};
    words.insert(words.end(), choice.begin(), choice.end());
    return RunDuet(words);
  };
  const ProgramResult drawn = draw("position_error", {"--estimator", "window"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  const std::string csv = ReadFile(*folder_ / "chosen/position_error.csv");
  EXPECT_THAT(csv, HasSubstr("compare/window (window): duet "));
  EXPECT_THAT(csv, Not(HasSubstr("msckf")));
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused = {
      {{"--estimator", "windw"}, "no run is of estimator 'windw'; did you mean 'window'?"},
      {{"--stream", "romo"}, "no run is of stream 'romo'; did you mean 'room'?"},
      {{"--seed", "one"}, "--seed: 'one' is no whole number"},
      {{"--seed", "1"}, "--seed: the runs have no seed: they are of duet run or duet compare"},
      {{"--setting", "default"}, "--setting: the runs have no setting"}};
  for (const auto& [choice, message] : refused) {
    const ProgramResult result = draw("orientation_error", choice);
    EXPECT_EQ(result.status, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  EXPECT_THAT(draw("thesis_3_8", {"--stream", "room"}).err,
              HasSubstr("--stream: has no effect on duet figure thesis_3_8"));
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "chosen/orientation_error.csv"));
}

TEST_F(FigureTest, BadInputIsOneLine) {
  const ProgramResult unknown = Draw("positon_error");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.err,
            "duet: unknown figure 'positon_error' (duet figure list names them); did you mean "
            "'position_error'?\n");
  EXPECT_EQ(RunDuet({"figure"}).status, 2);
  EXPECT_EQ(RunDuet({"figure", "position_error", "--runs", *folder_ / "compare"}).status, 2);
  const ProgramResult list = RunDuet({"figure", "list"});
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.out, HasSubstr("\n  nees_over_time "));
  const ProgramResult twice = RunDuet(
      {"figure", "position_error", "--runs", *folder_ / "compare", "--out", *folder_ / "figures"});
  if (twice.status == 0) {
    EXPECT_EQ(Draw("position_error").status, 2);  // never over another
  }
}

}  // namespace
}  // namespace duet
