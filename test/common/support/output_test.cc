#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/support/input_error.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class OutputTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("duet_output_" + std::to_string(getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  int CountEntries() const {
    return static_cast<int>(std::distance(fs::directory_iterator(folder_), {}));
  }
  fs::path folder_;
};

TEST_F(OutputTest, ACommittedFolderIsCompleteAndNothingElseRemains) {
  const fs::path target = folder_ / "a" / "run";
  {
    OutputFolder out(target);
    WriteTextFile(out.path() / "file.txt", "text");
    EXPECT_FALSE(fs::exists(target));
    out.Commit();
  }
  EXPECT_EQ(ReadTextFile(target / "file.txt"), "text");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "a"), {}), 1);
}

TEST_F(OutputTest, WithoutCommitNothingRemains) {
  {
    OutputFolder out(folder_ / "run/");
    WriteTextFile(out.path() / "file.txt", "text");
    EXPECT_EQ(CountEntries(), 1);
  }
  EXPECT_EQ(CountEntries(), 0);
}

TEST_F(OutputTest, AnExistingTargetIsRefusedAndUntouched) {
  fs::create_directory(folder_ / "run");
  EXPECT_THAT([&] { OutputFolder out(folder_ / "run"); },
              ThrowsMessage<OutputError>(HasSubstr("exists")));
  WriteTextFile(folder_ / "file", "text");
  EXPECT_THAT([&] { OutputFolder out(folder_ / "file"); },
              ThrowsMessage<OutputError>(HasSubstr("exists")));
  EXPECT_THAT([&] { OutputFolder out(folder_ / "file" / "run"); },
              ThrowsMessage<OutputError>(HasSubstr("cannot be made")));
  EXPECT_EQ(CountEntries(), 2);
}

TEST_F(OutputTest, ATargetThatAppearsMeanwhileIsNotReplaced) {
  OutputFolder out(folder_ / "run");
  fs::create_directory(folder_ / "run");
  EXPECT_THAT([&] { out.Commit(); }, ThrowsMessage<OutputError>(HasSubstr("exists")));
}

TEST_F(OutputTest, AFolderThatCannotBeWrittenIsAnOutputError) {
  EXPECT_THROW(OutputFolder out("/proc/duet_cannot_write/run"), OutputError);
  EXPECT_THROW(WriteTextFile(folder_ / "missing" / "file", "text"), OutputError);
  // A disk that is full: the error comes at the latest with Close().
  if (fs::exists("/dev/full")) {
    EXPECT_THROW(WriteTextFile("/dev/full", "text"), OutputError);
  }
}

TEST_F(OutputTest, AFileThatCannotBeReadIsAnInputErrorThatNamesIt) {
  EXPECT_THAT([&] { (void)ReadTextFile(folder_ / "none.csv"); },
              ThrowsMessage<InputError>(HasSubstr("none.csv: no such file")));
  EXPECT_THAT([&] { (void)ReadTextFile(folder_); },
              ThrowsMessage<InputError>(HasSubstr("is a folder")));
}

TEST(InputErrorText, NamesFileLineAndKey) {
  EXPECT_STREQ(InputError("a.yaml", 3, "x.y", "expected a number").what(),
               "a.yaml:3: x.y: expected a number");
  EXPECT_STREQ(InputError("", 0, "x.y", "expected a number").what(), "x.y: expected a number");
  EXPECT_STREQ(InputError("", 7, "", "text").what(), "line 7: text");
}

TEST_F(OutputTest, OfSeveralMakersOneIsKeptWhole) {
  OutputFolder first(folder_ / "run", OutputFolder::Makers::kSeveral);
  OutputFolder second(folder_ / "run", OutputFolder::Makers::kSeveral);
  WriteTextFile(first.path() / "file.txt", "first");
  WriteTextFile(second.path() / "file.txt", "second");
  EXPECT_TRUE(first.CommitUnlessThere());
  EXPECT_FALSE(second.CommitUnlessThere());
  EXPECT_EQ(ReadTextFile(folder_ / "run" / "file.txt"), "first");
  EXPECT_EQ(CountEntries(), 1);
  // One that comes when all is done is no error either.
  OutputFolder third(folder_ / "run", OutputFolder::Makers::kSeveral);
  WriteTextFile(third.path() / "file.txt", "third");
  EXPECT_FALSE(third.CommitUnlessThere());
  EXPECT_EQ(CountEntries(), 1);
}

TEST_F(OutputTest, WhatDeadProcessesLeftIsRemovedAndNothingElse) {
  OutputFolder living(folder_ / "living");
  const std::string mine = living.path().filename().string();
  const std::string own_pid = std::to_string(getpid());
  const auto named = [&](const std::string& name, const std::string& pid) {
    std::string partial = mine;
    partial.replace(0, std::string("living").size(), name);
    return partial.replace(partial.size() - own_pid.size(), own_pid.size(), pid);
  };
  constexpr const char* kNoProcess = "2147483646";
  fs::create_directory(folder_ / named("dead", kNoProcess));
  fs::create_directory(folder_ / (named("dead", kNoProcess) + "-1"));
  fs::create_directory(folder_ / named("parent", std::to_string(getppid())));
  fs::create_directory(folder_ / ("dead.partial-another-host-" + std::string(kNoProcess)));
  fs::create_directory(folder_ / "done");
  RemoveAbandonedPartials(folder_);
  EXPECT_EQ(CountEntries(), 4);
  EXPECT_TRUE(fs::exists(living.path()));
  EXPECT_TRUE(fs::exists(folder_ / "done"));
}

TEST_F(OutputTest, AReplacedFileIsTheNewOneAndLeavesNothingBeside) {
  ReplaceTextFile(folder_ / "file", "old");
  ReplaceTextFile(folder_ / "file", "new");
  EXPECT_EQ(ReadTextFile(folder_ / "file"), "new");
  EXPECT_EQ(CountEntries(), 1);
  EXPECT_THROW(ReplaceTextFile(folder_ / "no" / "file", "text"), OutputError);
}

}  // namespace
}  // namespace duet
