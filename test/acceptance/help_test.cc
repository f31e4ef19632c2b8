#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/acceptance/program.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(HelpTest, ListsEveryCommand) {
  const ProgramResult help = RunDuet({"help"});
  EXPECT_EQ(help.status, 0);
  for (const char* command :
       {"compare", "track", "run", "evaluate", "report", "simulate", "config", "observability"}) {
    EXPECT_THAT(help.out, HasSubstr(std::string("\n  ") + command + " "));
    const ProgramResult one = RunDuet({"help", command});
    EXPECT_EQ(one.status, 0) << command;
    EXPECT_THAT(one.out, HasSubstr("\nExample\n  duet " + std::string(command)));
    EXPECT_EQ(RunDuet({command, "--help"}).out, one.out);
  }
  EXPECT_EQ(RunDuet({}).out, help.out);
}

TEST(HelpTest, OfACommandShowsItsFlagsOnlyWithDefaultsAndUnits) {
  const std::string run = RunDuet({"help", "run"}).out;
  for (const char* flag :
       {"--dataset DIR", "--backend msckf|window", "--out DIR", "--config FILE", "--set KEY=VALUE",
        "--init groundtruth|drawn|rest|auto", "--cameras 0|1|0,1", "--start S", "--duration S",
        "--alignment posyaw|se3|sim3|first|none", "--threads N", "--seed N", "--quiet",
        "--tracks DIR"}) {
    EXPECT_THAT(run, HasSubstr(flag));
  }
  EXPECT_THAT(run, HasSubstr("[s]"));
  EXPECT_THAT(run, HasSubstr("Default: auto."));
  EXPECT_THAT(run, Not(HasSubstr("--require")));
  EXPECT_THAT(run, Not(HasSubstr("logtostderr")));
  EXPECT_THAT(RunDuet({"help", "ablate"}).out, Not(HasSubstr("drawn: its state")));
  EXPECT_THAT(RunDuet({"help", "track"}).out, HasSubstr("--save-overlay DIR"));
}

TEST(HelpTest, MisspellingsAreUsageErrorsThatNameTheNearest) {
  const ProgramResult command = RunDuet({"comprae"});
  EXPECT_EQ(command.status, 2);
  EXPECT_EQ(command.err, "duet: there is no command 'comprae'; did you mean 'compare'?\n");
  const ProgramResult flag = RunDuet({"run", "--datset=x"});
  EXPECT_EQ(flag.status, 2);
  EXPECT_EQ(flag.err, "duet: duet run has no flag --datset; did you mean --dataset?\n");
  const ProgramResult choice = RunDuet({"run", "--backend=mskcf"});
  EXPECT_EQ(choice.status, 2);
  EXPECT_THAT(choice.err, HasSubstr("did you mean 'msckf'?"));
  EXPECT_EQ(RunDuet({"run"}).status, 2);
}

TEST(HelpTest, VersionNamesCommitBuildAndLibraries) {
  const ProgramResult version = RunDuet({"version"});
  EXPECT_EQ(version.status, 0);
  for (const char* part : {"duet 0.", "commit ", "flags ", "Ceres ", "Eigen ", "OpenCV ", "blas"}) {
    EXPECT_THAT(version.out, HasSubstr(part));
  }
}

TEST(ConfigTest, TheShippedConfigurationIsTheDefaultsWithTheirMeaning) {
  const std::string path = DUET_SOURCE "/configs/estimators/default.yaml";
  const ProgramResult dump = RunDuet({"config"});
  EXPECT_EQ(dump.status, 0);
  EXPECT_EQ(dump.out, ReadFile(path)) << "write it again: duet config > " << path;
  EXPECT_EQ(RunDuet({"config", "--config", path}).out, dump.out);
}

TEST(ConfigTest, ExplainSaysMeaningRangeAndOrigin) {
  const ProgramResult explained = RunDuet(
      {"config", "--explain", "shared.pixel_noise_px", "--set", "shared.pixel_noise_px=0.5"});
  EXPECT_EQ(explained.status, 0);
  EXPECT_THAT(explained.out, HasSubstr("Standard deviation of a tracked pixel"));
  EXPECT_THAT(explained.out, HasSubstr("0.5"));
  EXPECT_THAT(explained.out, HasSubstr("command line"));
  EXPECT_EQ(RunDuet({"config", "--explain", "shared.pixel_nose_px"}).status, 2);
}

}  // namespace
}  // namespace duet
