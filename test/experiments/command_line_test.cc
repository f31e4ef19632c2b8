#include "experiments/command_line.h"

#include <gflags/gflags.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/support/input_error.h"

DEFINE_string(test_folder, "", "Folder to read.");
DEFINE_double(test_seconds, 1.5, "How long [s].");
DEFINE_bool(test_silent, false, "Says nothing.");
DEFINE_string(test_set, "", "Sets a key.");
DEFINE_string(test_mode, "fast", "How.");

namespace duet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CommandLine last_line;

int Remember(const CommandLine& line) {
  last_line = line;
  return 17;
}

std::vector<Command> Commands() {
  return {{.name = "walk",
           .summary = "Walks.",
           .description = "Walks for a while.",
           .example = "duet walk --test_folder here",
           .flags = {{.name = "test_folder", .value = "DIR", .required = true},
                     {.name = "test_seconds", .value = "S"},
                     {.name = "test_silent", .meaning = "Walks on tiptoe."},
                     {.name = "test_set", .value = "KEY=VALUE", .repeatable = true},
                     {.name = "test_mode", .value = "fast|slow", .choices = {"fast", "slow"}}},
           .run = Remember},
          {.name = "walk_on_and_on",
           .summary = "Walks far.",
           .description = "Walks far.",
           .example = "duet walk_on_and_on",
           .run = Remember},
          {.name = "weigh",
           .summary = "Weighs files.",
           .description = "Weighs files.",
           .example = "duet weigh FILE",
           .operands = "FILE...",
           .run = Remember}};
}

class CommandLineTest : public testing::Test {
 protected:
  int Call(std::vector<const char*> words) {
    words.insert(words.begin(), "duet");
    return Dispatch(Commands(), static_cast<int>(words.size()), words.data());
  }
  std::string ErrorOf(const std::vector<const char*>& words) {
    try {
      Call(words);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  gflags::FlagSaver saver_;
};

TEST_F(CommandLineTest, TakesBothFormsOfAFlagAndReturnsTheCommandsStatus) {
  EXPECT_EQ(Call({"walk", "--test_folder", "a", "-test_seconds=2.25", "--test_silent"}), 17);
  EXPECT_EQ(FLAGS_test_folder, "a");
  EXPECT_EQ(FLAGS_test_seconds, 2.25);
  EXPECT_TRUE(FLAGS_test_silent);
  EXPECT_TRUE(last_line.Given("test_seconds"));
  EXPECT_FALSE(last_line.Given("test_mode"));
  Call({"walk", "--test_folder=a", "--notest_silent", "--test_seconds", "-3"});
  EXPECT_FALSE(FLAGS_test_silent);
  EXPECT_EQ(FLAGS_test_seconds, -3.0);
}

TEST_F(CommandLineTest, KeepsEveryValueOfARepeatableFlagInOrder) {
  Call({"walk", "--test_set", "a=1", "--test_folder=x", "--test_set=b=2"});
  EXPECT_THAT(last_line.All("test_set"), ElementsAre("a=1", "b=2"));
}

TEST_F(CommandLineTest, TextReadsBackInAShell) {
  Call({"walk", "--test_folder", "my data", "--test_set", "a=it's"});
  EXPECT_EQ(last_line.text(), "duet walk --test_folder 'my data' --test_set 'a=it'\\''s'");
}

TEST_F(CommandLineTest, OperandsOnlyWhereTheyAreTaken) {
  Call({"weigh", "a", "--", "--b"});
  EXPECT_THAT(last_line.operands(), ElementsAre("a", "--b"));
  EXPECT_THAT(ErrorOf({"walk", "--test_folder=a", "b"}), HasSubstr("'b' is no flag"));
}

TEST_F(CommandLineTest, MisspellingsNameTheNearest) {
  EXPECT_THAT(ErrorOf({"wlak"}), HasSubstr("did you mean 'walk'?"));
  EXPECT_THAT(ErrorOf({"walk", "--test_flder=a"}), HasSubstr("did you mean --test_folder?"));
  EXPECT_THAT(ErrorOf({"walk", "--test_mode=slwo"}), HasSubstr("did you mean 'slow'?"));
}

TEST_F(CommandLineTest, FlagsOfOtherCommandsAreUnknown) {
  EXPECT_THAT(ErrorOf({"weigh", "--test_silent"}), HasSubstr("has no flag --test_silent"));
}

TEST_F(CommandLineTest, ValuesOfTheWrongKindNameTheFlag) {
  EXPECT_THAT(ErrorOf({"walk", "--test_seconds", "soon"}),
              HasSubstr("--test_seconds: 'soon' is not a number"));
  EXPECT_THAT(ErrorOf({"walk", "--test_folder"}), HasSubstr("--test_folder needs a value"));
  EXPECT_THAT(ErrorOf({"walk"}), HasSubstr("needs --test_folder DIR"));
  EXPECT_THAT(ErrorOf({"walk", "--test_folder=a", "--test_folder=b"}), HasSubstr("more than once"));
  EXPECT_THAT(ErrorOf({"walk", "--notest_silent=true"}), HasSubstr("takes no value"));
}

TEST_F(CommandLineTest, HelpShowsEachFlagOfTheCommandWithDefaultAndUnit) {
  const std::string help = CommandHelp(Commands()[0]);
  EXPECT_THAT(help, HasSubstr("duet walk --test_folder DIR [flags]"));
  EXPECT_THAT(help, HasSubstr("How long [s]. Default: 1.5."));
  EXPECT_THAT(help, HasSubstr("May be repeated."));
  EXPECT_THAT(help, HasSubstr("Example\n  duet walk"));
  EXPECT_THAT(CommandHelp(Commands()[1]), Not(HasSubstr("test_")));
  EXPECT_THAT(ProgramHelp(Commands()), HasSubstr("  weigh           Weighs files."));
}

TEST_F(CommandLineTest, HelpHasRoomForTheLongestNameAndACommandsOwnMeanings) {
  EXPECT_THAT(ProgramHelp(Commands()), HasSubstr("\n  walk_on_and_on  Walks far.\n"));
  EXPECT_THAT(ProgramHelp(Commands()), HasSubstr("\n  walk            Walks.\n"));
  const std::string walk = CommandHelp(Commands().front());
  EXPECT_THAT(walk, HasSubstr("Walks on tiptoe."));
  EXPECT_THAT(walk, testing::Not(HasSubstr("Says nothing.")));
}

}  // namespace
}  // namespace duet
