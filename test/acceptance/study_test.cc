#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "test/acceptance/program.h"
#include "test/acceptance/tiny_study.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class StudyTest : public testing::Test {
 protected:
  void SetUp() override { WriteFile(study_, kTinyStudy); }

  [[nodiscard]] ProgramResult Run(const std::string& out,
                                  const std::vector<std::string>& more = {"--jobs", "2"}) const {
    std::vector<std::string> arguments = {"study", study_, "--out", out, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunDuet(arguments);
  }
  /// The study undisturbed, made once for all tests.
  static const std::map<std::string, std::string>& Undisturbed() {
    static const std::map<std::string, std::string> files = [] {
      const TemporaryFolder folder;
      WriteFile(folder / "tiny.yaml", kTinyStudy);
      const ProgramResult result = RunDuet({"study", folder / "tiny.yaml", "--out", folder / "s"});
      EXPECT_EQ(result.status, 0) << result.err;
      return CanonicalFilesOf(folder / "s");
    }();
    return files;
  }
  static std::vector<fs::path> RecordsOf(const std::string& out) {
    std::vector<fs::path> records;
    for (const std::string& name : FilesIn(fs::path(out) / "runs")) {
      records.push_back(fs::path(out) / "runs" / name);
    }
    return records;
  }
  /// The last digit of a file made another one.
  static void Spoil(const fs::path& file) {
    std::string text = ReadFile(file);
    char& digit = text[text.find_last_of("0123456789")];
    digit = digit == '1' ? '2' : '1';
    WriteFile(file, text);
  }

  TemporaryFolder folder_;
  std::string study_ = folder_ / "tiny.yaml";
  std::string out_ = folder_ / "out";
};

TEST_F(StudyTest, ARecordHoldsWhatItSaysAndTheTablesComeOfIt) {
  const ProgramResult result = Run(out_);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(RecordsOf(out_), SizeIs(4));
  const auto files = CanonicalFilesOf(out_);
  for (const fs::path& record : RecordsOf(out_)) {
    const auto study = nlohmann::json::parse(ReadFile(record / "study.json"));
    EXPECT_EQ(study["id"], record.filename().string());
    EXPECT_EQ(study["stream"], "room");
    EXPECT_TRUE(fs::exists(fs::path(out_) / "streams" / study["stream_id"] / "tracks.sha256"));
    const auto evaluation = nlohmann::json::parse(ReadFile(record / "evaluation.json"));
    EXPECT_FALSE(evaluation["failed"]);
    for (const char* key : {"ate.position_m", "rms.position_m", "nees.pose", "nees.calibration",
                            "calibration.t_d.error", "calibration.t_d.sigma", "coverage_share"}) {
      EXPECT_TRUE(evaluation["metrics"].contains(key)) << key;
    }
    EXPECT_LT(evaluation["metrics"]["ate.position_m"], 0.1);
    EXPECT_THAT(ReadFile(record / "calibration_truth.csv"), HasSubstr("name,true\nt_d,0\n"));
    EXPECT_THAT(ReadFile(record / "manifest.json"), HasSubstr("\"init\": \"drawn\""));
  }
  const std::string runs = ReadFile(fs::path(out_) / "runs.csv");
  EXPECT_THAT(runs, HasSubstr("id,stream,estimator,setting,perturbation,seed,failed,reason,"));
  EXPECT_EQ(std::count(runs.begin(), runs.end(), '\n'), 5);
  EXPECT_THAT(result.out, HasSubstr("4 records for 4 cells of the grid"));
  for (const char* made : {"tables/ate.position_m.tex", "tables/ate.position_m.paired.csv",
                           "figures/rmse_over_runs.csv", "report.html"}) {
    EXPECT_TRUE(fs::exists(fs::path(out_) / made)) << made;
  }
}

TEST_F(StudyTest, JobsAndOrderChangeNoByte) {
  ASSERT_EQ(Run(out_).status, 0);
  EXPECT_EQ(CanonicalFilesOf(out_), Undisturbed());

  // One process a run from the plan, the last first.
  const std::string other = folder_ / "other";
  const ProgramResult plan = Run(other, {"--plan"});
  ASSERT_EQ(plan.status, 0) << plan.err;
  std::istringstream lines(plan.out);
  std::vector<std::string> commands;
  for (std::string line; std::getline(lines, line);) commands.push_back(line);
  ASSERT_THAT(commands, SizeIs(4));
  for (auto command = commands.rbegin(); command != commands.rend(); ++command) {
    const ProgramResult run = RunShell(*command);
    ASSERT_EQ(run.status, 0) << run.err;
  }
  EXPECT_THAT(Run(other, {"--plan"}).out, "");
  ASSERT_EQ(Run(other).status, 0);
  EXPECT_EQ(CanonicalFilesOf(other), Undisturbed());
}

TEST_F(StudyTest, KilledAndStartedAgainItEndsWithTheSameBytes) {
  int kills = 0;
  for (const double after_s : {0.15, 0.3, 0.5}) {
    const auto start = std::chrono::steady_clock::now();
    const ProgramResult result = RunDuet(
        {"study", study_, "--out", out_, "--jobs", "2", "--quiet"},
        [&] {
          return std::chrono::steady_clock::now() - start > std::chrono::duration<double>(after_s);
        },
        SIGKILL);
    kills += result.status == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_GT(kills, 0);
  ASSERT_EQ(Run(out_).status, 0);
  EXPECT_EQ(CanonicalFilesOf(out_), Undisturbed());
}

TEST_F(StudyTest, AnInterruptionKeepsWhatIsDone) {
  const ProgramResult result = RunDuet({"study", study_, "--out", out_, "--quiet"}, [&] {
    return fs::exists(out_ + "/runs") && !FilesIn(out_ + "/runs").empty() &&
           FilesIn(out_ + "/runs").front().find("partial") == std::string::npos;
  });
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.err, HasSubstr("of 4 runs are done and kept"));
  for (const fs::path& record : RecordsOf(out_)) {
    EXPECT_THAT(record.string(), Not(HasSubstr("partial")));
  }
  ASSERT_EQ(Run(out_).status, 0);
  EXPECT_EQ(CanonicalFilesOf(out_), Undisturbed());
}

TEST_F(StudyTest, AGrownGridRunsOnlyWhatIsNew) {
  ASSERT_EQ(Run(out_).status, 0);
  const std::string record = RecordsOf(out_).front().string();
  const std::string before = ReadFile(record + "/manifest.json");
  WriteFile(study_, std::string(kTinyStudy) +
                        "estimators: [msckf]\nsettings: [{name: default}, "
                        "{name: b, set: {msckf.max_clones: 9}}]\n");
  const ProgramResult dry = Run(out_, {"--dry-run"});
  EXPECT_THAT(dry.out, HasSubstr("tiny: 4 runs, 2 of them there already; 2 streams, 2 there"));
  EXPECT_THAT(dry.out, HasSubstr("by the records that are there"));
  ASSERT_EQ(Run(out_).status, 0);
  EXPECT_THAT(RecordsOf(out_), SizeIs(6));
  EXPECT_EQ(ReadFile(record + "/manifest.json"), before);
}

TEST_F(StudyTest, WhatItNoLongerMakesGoesAndWhatIsDamagedIsMadeAgain) {
  WriteFile(study_, std::string(kTinyStudy) + "metrics: [ate.position_m, ate.orientation_deg]\n");
  ASSERT_EQ(Run(out_).status, 0);
  WriteFile(out_ + "/figures/own.csv", "of the user");
  ASSERT_TRUE(fs::exists(out_ + "/tables/ate.orientation_deg.tex"));
  const fs::path states = RecordsOf(out_).front() / "states.csv";
  const std::string whole = ReadFile(states);
  fs::remove(states);
  fs::remove_all(fs::path(out_) / "streams" / FilesIn(out_ + "/streams").front());
  std::string other = kTinyStudy;
  other.replace(other.find("rmse_over_runs"), 14, "trajectory_top");
  WriteFile(study_, other + "metrics: [ate.position_m]\n");
  const ProgramResult again = Run(out_);
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr(": states.csv is missing; it is run again"));
  EXPECT_EQ(ReadFile(states), whole);
  EXPECT_FALSE(fs::exists(out_ + "/tables/ate.orientation_deg.tex"));
  EXPECT_FALSE(fs::exists(out_ + "/figures/rmse_over_runs.csv"));
  EXPECT_TRUE(fs::exists(out_ + "/figures/trajectory_top.csv"));
  EXPECT_TRUE(fs::exists(out_ + "/figures/own.csv"));
  EXPECT_EQ(RunDuet({"verify", out_}).status, 0);
}

TEST_F(StudyTest, AFullDiskStopsItAndLosesNothing) {
  std::string one = kTinyStudy;
  one.replace(one.find("1..2"), 4, "1..1");
  WriteFile(study_, one);
  ASSERT_EQ(Run(out_).status, 0);
  const auto before = CanonicalFilesOf(out_);
  WriteFile(study_, kTinyStudy);
  // No file may grow beyond 20 blocks of 512 bytes: writes fail as on a full disk.
  const ProgramResult full = RunShell("trap '' XFSZ; ulimit -f 20; exec \"$DUET\" study '" +
                                      study_ + "' --out '" + out_ + "' --quiet");
  EXPECT_EQ(full.status, 4) << full.err;
  EXPECT_THAT(full.err, HasSubstr("cannot be written"));
  auto after = CanonicalFilesOf(out_);
  for (const auto& [path, text] : before) {
    const bool done = path.starts_with("runs/") || path.starts_with("streams/");
    EXPECT_TRUE(!done || after[path] == text) << path;
  }
  for (const char* part : {"/runs", "/streams"}) {
    for (const std::string& name : FilesIn(out_ + part)) {
      EXPECT_THAT(name, Not(HasSubstr("partial")));
    }
  }
  ASSERT_EQ(Run(out_).status, 0);
  EXPECT_EQ(CanonicalFilesOf(out_), Undisturbed());
}

TEST_F(StudyTest, ARunWhoseProcessDiesIsAResultAndIsTriedAgain) {
  bool killed = false;
  const ProgramResult result = RunDuet({"study", study_, "--out", out_, "--quiet"}, [&] {
    if (killed || !fs::exists(out_ + "/runs")) return false;
    for (const std::string& name : FilesIn(out_ + "/runs")) {
      if (name.find(".partial-") == std::string::npos) continue;
      kill(std::stoi(name.substr(name.rfind('-') + 1)), SIGKILL);
      killed = true;
    }
    return false;
  });
  ASSERT_TRUE(killed);
  EXPECT_EQ(result.status, 70) << result.err;
  EXPECT_THAT(ReadFile(out_ + "/runs.csv"), HasSubstr(",1,its process was ended by signal 9"));
  EXPECT_THAT(RecordsOf(out_), SizeIs(4));  // with what the dead process has left
  ASSERT_EQ(Run(out_).status, 0);
  EXPECT_THAT(ReadFile(out_ + "/runs.csv"), Not(HasSubstr("signal")));
  fs::remove_all(out_ + "/failures");
  EXPECT_EQ(CanonicalFilesOf(out_), Undisturbed());
}

TEST_F(StudyTest, VerifyFindsWhatIsMissingChangedOrOfAnotherVersion) {
  ASSERT_EQ(Run(out_).status, 0);
  const auto verify = [&] { return RunDuet({"verify", out_}); };
  const ProgramResult clean = verify();
  EXPECT_EQ(clean.status, 0) << clean.out;
  EXPECT_THAT(clean.out, HasSubstr("4 records and 2 streams: every number is what they give"));

  const fs::path record = RecordsOf(out_).front();
  const std::string name = record.filename().string();
  const std::string stream = nlohmann::json::parse(ReadFile(record / "study.json"))["stream_id"];
  const auto finds = [&](const fs::path& file, const std::string& problem) {
    const std::string whole = ReadFile(file);
    Spoil(file);
    const ProgramResult result = verify();
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.out, HasSubstr(problem));
    WriteFile(file, whole);
  };
  finds(record / "features.csv", "runs/" + name + "/features.csv: has changed");
  finds(record / "evaluation.json",
        "runs/" + name + "/evaluation.json: is not what the record gives");
  finds(record / "states.csv", "runs/" + name + "/states.csv: has changed");
  finds(fs::path(out_) / "runs.csv", "runs.csv: is not what the records give");
  finds(fs::path(out_) / "tables" / "ate.position_m.tex",
        "tables/ate.position_m.tex: is not what the records give");
  finds(fs::path(out_) / "streams" / stream / "mav0" / "tracks0" / "data.csv",
        "streams/" + stream + ": its tracks have changed");
  finds(fs::path(out_) / "streams" / stream / "mav0" / "imu0" / "data.csv",
        "streams/" + stream + "/mav0/imu0/data.csv: has changed since it was written");
  finds(fs::path(out_) / "figures" / "rmse_over_runs.csv",
        "figures/rmse_over_runs.csv: is not what the records give");
  finds(fs::path(out_) / "figures" / "rmse_over_runs.tex",
        "figures/rmse_over_runs.tex: has changed since it was written");
  finds(fs::path(out_) / "report.html", "report.html: is not what the records give");
  const auto finds_instead = [&](const fs::path& file, const std::string& from,
                                 const std::string& to, const std::string& problem) {
    const std::string whole = ReadFile(file);
    std::string other = whole;
    other.replace(other.find(from), from.size(), to);
    WriteFile(file, other);
    EXPECT_THAT(verify().out, HasSubstr(problem));
    WriteFile(file, whole);
  };
  finds_instead(record / "study.json", "\"stream\": \"room\"", "\"stream\": \"hall\"",
                "runs/" + name + "/study.json: has changed since it was written");
  finds_instead(out_ + "/study.yaml", "seeds: 1..2", "seeds: 1..3",
                "plan.csv: is not the grid that study.yaml gives");
  const std::string evaluation = ReadFile(record / "evaluation.json");
  fs::remove(record / "evaluation.json");
  const std::string without = verify().out;
  EXPECT_THAT(without, HasSubstr("evaluation.json: is missing"));
  EXPECT_EQ(without.find("evaluation.json"), without.rfind("evaluation.json"));
  WriteFile(record / "evaluation.json", evaluation);
  EXPECT_EQ(verify().status, 0);

  const std::string manifest = ReadFile(record / "manifest.json");
  std::string older = manifest;
  older.replace(older.find("\"commit\": \"") + 11, 2, "zz");
  WriteFile(record / "manifest.json", older);
  EXPECT_THAT(verify().out, HasSubstr("runs/" + name + ": is from another version"));
  // Nor is it mixed with new ones.
  const ProgramResult refused = Run(out_);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("results of two are not mixed"));
  WriteFile(record / "manifest.json", manifest);

  fs::remove_all(record);
  const ProgramResult missing = verify();
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.out, HasSubstr("runs/" + name + ": is missing"));
}

// Before anything is simulated, tracked or written.
TEST_F(StudyTest, AToldCalibrationThatCannotBeIsRefusedAtOnce) {
  WriteFile(study_, std::string(kTinyStudy) +
                        "perturbations: [{name: none}, {name: far, set: "
                        "{shared.calibration.told_offset.intrinsics_px: [-500, 0, 0, 0]}}]\n");
  const std::vector<std::vector<std::string>> ways = {{"--jobs", "1"}, {"--dry-run"}, {"--plan"}};
  for (const std::vector<std::string>& way : ways) {
    const ProgramResult result = Run(out_, way);
    EXPECT_EQ(result.status, 2) << way.front();
    EXPECT_THAT(result.err, HasSubstr("tiny.yaml: perturbations.far: on stream room: "
                                      "shared.calibration.told_offset.intrinsics_px: the told fx"));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(out_)) << way.front();
  }
}

TEST_F(StudyTest, AFolderInUseOrOfSomethingElseIsRefused) {
  fs::create_directory(out_);
  WriteFile(out_ + "/study.yaml", "study: tiny\n");
  const int lock = open((out_ + "/lock").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  const ProgramResult busy = Run(out_);
  EXPECT_EQ(busy.status, 2);
  EXPECT_THAT(busy.err, HasSubstr("another process works in this folder"));
  close(lock);

  WriteFile(out_ + "/study.yaml", "study: another\n");
  const ProgramResult other = Run(out_);
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("holds the study 'another', not 'tiny'"));
  const std::string full = folder_ / "full";
  fs::create_directory(full);
  WriteFile(full + "/thesis.tex", "years of work");
  EXPECT_EQ(Run(full).status, 2);
  EXPECT_THAT(FilesIn(full), SizeIs(1));
}

}  // namespace
}  // namespace duet
