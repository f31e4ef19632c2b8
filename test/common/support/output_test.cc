#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <deque>
#include <filesystem>
#include <vector>

#include "common/support/input_error.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;
using testing::UnorderedElementsAre;

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

// What was synced, by its path at that time, and what the next syncs answer.
std::vector<std::string> synced;
std::deque<int> sync_errors;
int NotedSync(int descriptor) {
  std::error_code error;
  synced.push_back(fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor), error).string());
  if (sync_errors.empty()) return 0;
  errno = sync_errors.front();
  sync_errors.pop_front();
  return errno == 0 ? 0 : -1;
}

constexpr SyncCalls kNoted = {NotedSync, nullptr};
constexpr SyncCalls kNotedAtOnce = {NotedSync, NotedSync};

class SyncTest : public OutputTest {
 protected:
  void SetUp() override {
    OutputTest::SetUp();
    synced.clear();
    sync_errors.clear();
  }
  // A folder of two files, one of them in a folder of its own.
  static void Write(const fs::path& folder) {
    WriteTextFile(folder / "a.csv", "a");
    fs::create_directory(folder / "in");
    WriteTextFile(folder / "in" / "b.csv", "b");
  }
};

TEST_F(SyncTest, AllOfAFolderIsOnTheDiskBeforeItHasItsName) {
  OutputFolder out(folder_ / "run", OutputFolder::Makers::kOne, kNoted);
  Write(out.path());
  const std::string partial = fs::canonical(out.path()).string();
  out.Commit();
  if (!fs::exists("/proc/self/fd")) GTEST_SKIP() << "no /proc to tell what a descriptor is of";
  ASSERT_EQ(synced.size(), 5U);
  const std::string last = synced.back();
  EXPECT_THAT(synced, UnorderedElementsAre(partial, partial + "/a.csv", partial + "/in",
                                           partial + "/in/b.csv", fs::canonical(folder_).string()));
  EXPECT_EQ(last, fs::canonical(folder_).string());
  EXPECT_EQ(synced[3], partial) << "after its files";
}

TEST_F(SyncTest, OneCallForTheFileSystemDoesForAllFiles) {
  {
    OutputFolder out(folder_ / "run", OutputFolder::Makers::kOne, kNotedAtOnce);
    Write(out.path());
    out.Commit();
    EXPECT_EQ(synced.size(), 2U) << "the file system, and the name";
  }
  // Where there is no such call, file by file.
  synced.clear();
  sync_errors = {ENOSYS};
  OutputFolder out(folder_ / "another", OutputFolder::Makers::kSeveral, kNotedAtOnce);
  Write(out.path());
  EXPECT_TRUE(out.CommitUnlessThere());
  EXPECT_EQ(synced.size(), 6U);
  // A disk that can't hold it is an error at once.
  sync_errors = {ENOSPC};
  OutputFolder full(folder_ / "full", OutputFolder::Makers::kOne, kNotedAtOnce);
  EXPECT_THAT([&] { full.Commit(); },
              ThrowsMessage<OutputError>(HasSubstr("cannot be written to disk: ")));
  EXPECT_FALSE(fs::exists(folder_ / "full"));
}

TEST_F(SyncTest, AFolderThatTheDiskCannotHoldIsAnErrorAndNotThere) {
  for (const int error : {EIO, ENOSPC, EDQUOT}) {
    for (const std::size_t fails : {0, 1, 2, 3}) {
      {
        OutputFolder out(folder_ / "run", OutputFolder::Makers::kSeveral, kNoted);
        Write(out.path());
        sync_errors.assign(fails, 0);
        sync_errors.push_back(error);
        EXPECT_THAT([&] { (void)out.CommitUnlessThere(); },
                    ThrowsMessage<OutputError>(HasSubstr("cannot be written to disk: ")));
      }
      EXPECT_EQ(CountEntries(), 0);
    }
  }
}

TEST_F(SyncTest, AFileSystemThatDoesNotSyncIsNoError) {
  for (const int error : {EINVAL, ENOTSUP, EROFS}) {
    OutputFolder out(folder_ / ("run" + std::to_string(error)), OutputFolder::Makers::kOne, kNoted);
    Write(out.path());
    sync_errors.assign(5, error);
    out.Commit();
    EXPECT_TRUE(fs::exists(out.target() / "in" / "b.csv"));
  }
}

TEST_F(SyncTest, AnInterruptedSyncIsTriedAgain) {
  WriteTextFile(folder_ / "a", "a");
  sync_errors = {EINTR, EINTR, 0};
  SyncPath(folder_ / "a", kNoted);
  EXPECT_EQ(synced.size(), 3U);
  EXPECT_THAT([&] { SyncPath(folder_ / "none", kNoted); },
              ThrowsMessage<OutputError>(HasSubstr("none: cannot be written to disk")));
}

// One that leads out of the folder, or waits for a writer, is nothing that was written there.
TEST_F(SyncTest, OnlyFilesAndFoldersAreSynced) {
  fs::create_symlink("/dev/null", folder_ / "link");
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  SyncTree(folder_, kNoted);
  EXPECT_EQ(synced.size(), 1U);
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
