#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "test/acceptance/program.h"
#include "test/acceptance/small_recording.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

using Json = nlohmann::json;

Json ReadJson(const fs::path& path) { return Json::parse(ReadFile(path)); }

/// Every file of the canonical set below a folder, by its relative path.
std::map<std::string, std::string> CanonicalFiles(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    const bool is_other = name == "manifest.json" || name == "timing.csv" || name == "log.txt" ||
                          name == "config.yaml";
    if (entry.is_regular_file() && !is_other) {
      files[fs::relative(entry.path(), folder)] = ReadFile(entry.path());
    }
  }
  return files;
}

void ExpectSameBytes(const fs::path& a, const fs::path& b) {
  const auto files_a = CanonicalFiles(a);
  const auto files_b = CanonicalFiles(b);
  for (const auto& [name, text] : files_a) {
    ASSERT_TRUE(files_b.contains(name)) << name << " is in " << a << " only";
    EXPECT_TRUE(files_b.at(name) == text) << name << " differs between " << a << " and " << b;
  }
  EXPECT_EQ(files_a.size(), files_b.size());
}

/// The recording that records are made of: real images in motion where this machine has them.
class RecordTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const fs::path real = RealData(); !real.empty()) {
      dataset_ = real / "euroc/MH_01_easy_05s";
    } else {
      std::puts("SKIPPED IN PART: no real recordings (DUET_DATA); images at rest stand in");
      WriteSmallRecording(folder_.path() / "recording");
      dataset_ = folder_ / "recording";
    }
  }

  /// Runs a command on three seconds of it, from the truth.
  ProgramResult Call(const std::string& command, const std::string& out,
                     const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {command, "--dataset",   dataset_,
                                          "--out", folder_ / out, "--duration",
                                          "3",     "--init",      "groundtruth"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunDuet(arguments);
  }

  TemporaryFolder folder_;
  std::string dataset_;
};

TEST_F(RecordTest, IsCompleteAndSaysHowItCameToBe) {
  ASSERT_EQ(Call("run", "run", {"--backend=msckf", "--covariance", "--seed=3"}).status, 0);
  const fs::path run = folder_ / "run";
  EXPECT_THAT(FilesIn(run), ElementsAre("config.yaml", "covariance.csv", "features.csv", "log.txt",
                                        "manifest.json", "states.csv", "timing.csv",
                                        "tracks.sha256", "tracks0", "trajectory.tum"));
  EXPECT_THAT(FilesIn(run / "tracks0"), ElementsAre("data.csv", "frames.csv", "sensor.yaml"));
  const Json manifest = ReadJson(run / "manifest.json");
  for (const char* key : {"version", "commit", "build", "libraries", "linear_algebra", "machine",
                          "started", "command_line", "dataset", "tracks_sha256", "seed",
                          "settings_sha256", "outcome", "warnings", "peak_memory_mb"}) {
    EXPECT_TRUE(manifest.contains(key)) << key;
  }
  EXPECT_EQ(manifest["seed"], 3);
  EXPECT_EQ(manifest["outcome"]["status"], "done");
  EXPECT_EQ(manifest["tracks_sha256"].get<std::string>() + "\n", ReadFile(run / "tracks.sha256"));
  EXPECT_GT(manifest["peak_memory_mb"], 1.0);
  const std::string timing = ReadFile(run / "timing.csv");
  for (const char* column : {"decode [ms]", "tracking [ms]", "estimator [ms]"}) {
    EXPECT_THAT(timing.substr(0, timing.find('\n')), HasSubstr(column));
  }
  // What was resolved is a configuration that gives the same again.
  const std::string explained = RunDuet({"config", "--config", run / "config.yaml"}).out;
  EXPECT_EQ(explained, RunDuet({"config"}).out);
}

TEST_F(RecordTest, SameBytesTwiceWithMoreThreadsAndFromTheReplay) {
  for (const std::string backend : {"msckf", "window"}) {
    const std::string flag = "--backend=" + backend;
    ASSERT_EQ(Call("run", backend + "1", {flag, "--covariance"}).status, 0);
    ASSERT_EQ(Call("run", backend + "2", {flag, "--covariance", "--threads=2"}).status, 0);
    ExpectSameBytes(folder_ / (backend + "1"), folder_ / (backend + "2"));
    ASSERT_EQ(
        Call("run", backend + "3", {flag, "--covariance", "--tracks", folder_ / (backend + "1")})
            .status,
        0);
    for (const char* part : {"tracks0", "tracks.sha256"}) {  // a replay does not write them again
      fs::copy(folder_ / (backend + "1/" + part), folder_ / (backend + "3/" + part),
               fs::copy_options::recursive);
    }
    ExpectSameBytes(folder_ / (backend + "1"), folder_ / (backend + "3"));
  }
}

TEST_F(RecordTest, CompareRunsBothOnTheTracksThatTrackWrites) {
  ASSERT_EQ(Call("track", "tracks", {"--save-overlay", folder_ / "overlay"}).status, 0);
  EXPECT_GE(FilesIn(folder_ / "overlay").size(), 40U);
  const ProgramResult compare = Call("compare", "compare");
  ASSERT_EQ(compare.status, 0) << compare.err;
  const fs::path out = folder_ / "compare";
  EXPECT_THAT(FilesIn(out), ElementsAre("comparison.json", "comparison.txt", "config.yaml",
                                        "log.txt", "manifest.json", "msckf", "tracks", "window"));
  EXPECT_EQ(ReadFile(out / "comparison.txt"), compare.out);
  ExpectSameBytes(folder_ / "tracks", out / "tracks");
  const Json json = ReadJson(out / "comparison.json");
  const std::string sha256 = json["tracks_sha256"];
  EXPECT_EQ(sha256 + "\n", ReadFile(folder_ / "tracks/tracks.sha256"));
  EXPECT_THAT(compare.out, HasSubstr(sha256));
  for (const char* backend : {"msckf", "window"}) {
    EXPECT_EQ(ReadJson(out / backend / "manifest.json")["tracks_sha256"], sha256);
    const Json& estimator = json[backend];
    for (const char* path :
         {"/ate/position_m", "/ate/orientation_deg", "/ate/tilt_deg", "/coverage_s",
          "/estimator_ms/median", "/estimator_ms/p99", "/peak_memory_mb", "/status"}) {
      EXPECT_TRUE(estimator.contains(Json::json_pointer(path))) << path;
    }
    EXPECT_GT(estimator["peak_memory_mb"], 1.0);
    EXPECT_GT(estimator["estimator_ms"]["median"], 0.0);
  }
  EXPECT_GT(json["frontend"]["tracking_ms"]["median"], 0.0);
  EXPECT_GE(json["frontend"]["tracking_ms"]["p99"], json["frontend"]["tracking_ms"]["median"]);
  // The same again from the recorded tracks, without the images' part.
  ASSERT_EQ(Call("compare", "again", {"--tracks", folder_ / "tracks"}).status, 0);
  ExpectSameBytes(out / "msckf", folder_ / "again/msckf");
  ExpectSameBytes(out / "window", folder_ / "again/window");
}

/// Simulated tracks are quick to run over.
class SimulatedTest : public testing::Test {
 protected:
  void Simulate(const std::string& duration_s) {
    ASSERT_EQ(RunDuet({"simulate", "--set", "duration_s=" + duration_s, "--out", dataset_}).status,
              0);
  }
  TemporaryFolder folder_;
  std::string dataset_ = folder_ / "simulated";
};

TEST_F(SimulatedTest, RequireTurnsABoundIntoTheExitStatus) {
  Simulate("4");
  const auto compare = [&](const std::string& out, const std::vector<std::string>& bounds) {
    std::vector<std::string> arguments = {"compare",     "--dataset", dataset_, "--init",
                                          "groundtruth", "--quiet",   "--out",  folder_ / out};
    for (const std::string& bound : bounds) arguments.insert(arguments.end(), {"--require", bound});
    return RunDuet(arguments);
  };
  EXPECT_EQ(compare("met", {"msckf.ate.position_m<1", "window.coverage_s>3"}).status, 0);
  const ProgramResult missed =
      compare("missed", {"msckf.ate.position_m<1", "window.ate.position_m<1e-9"});
  EXPECT_EQ(missed.status, 1);
  EXPECT_THAT(missed.out, HasSubstr("window.ate.position_m<1e-9: not met"));
  EXPECT_TRUE(fs::exists(folder_ / "missed/comparison.json"));
  const ProgramResult misspelt = compare("misspelt", {"msckf.ate.positon_m<1"});
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("msckf.ate.position_m"));
  EXPECT_FALSE(fs::exists(folder_ / "misspelt"));
}

TEST_F(SimulatedTest, AFailureIsAResultOfAComparisonAndStatusThreeOfARun) {
  Simulate("3");  // in motion: there is no rest to start from
  const ProgramResult run = RunDuet(
      {"run", "--backend=window", "--init=rest", "--dataset", dataset_, "--out", folder_ / "run"});
  EXPECT_EQ(run.status, 3);
  const Json outcome = ReadJson(folder_ / "run/manifest.json")["outcome"];
  EXPECT_EQ(outcome["status"], "failed");
  EXPECT_THAT(outcome["reason"].get<std::string>(), HasSubstr("rest"));
  const ProgramResult compare =
      RunDuet({"compare", "--init=rest", "--dataset", dataset_, "--out", folder_ / "compare"});
  EXPECT_EQ(compare.status, 0) << compare.err;
  EXPECT_THAT(compare.out, HasSubstr("rest"));
  EXPECT_EQ(ReadJson(folder_ / "compare/comparison.json")["msckf"]["status"], "failed");
}

/// Cuts what is before `first` off a table.
void KeepRowsFrom(const fs::path& table, long long first) {
  std::istringstream rows(ReadFile(table));
  std::string kept;
  for (std::string row; std::getline(rows, row);) {
    if (row.front() == '#' || std::stoll(row) >= first) kept += row + "\n";
  }
  WriteFile(table, kept);
}

TEST_F(SimulatedTest, ALateStartIsAWarningInRecordAndTable) {
  Simulate("4");
  const fs::path truth = fs::path(dataset_) / "mav0/state_groundtruth_estimate0/data.csv";
  ASSERT_EQ(RunDuet({"run", "--backend=msckf", "--init=groundtruth", "--dataset", dataset_, "--out",
                     folder_ / "early"})
                .status,
            0);
  const Json early = ReadJson(folder_ / "early/manifest.json");
  EXPECT_TRUE(early["warnings"].empty()) << early["warnings"];
  const long long first = early["dataset"]["first_frame_ns"];

  KeepRowsFrom(truth, first + 1'000'000'000);  // a quarter of the recording without a truth
  const ProgramResult compare =
      RunDuet({"compare", "--init=groundtruth", "--dataset", dataset_, "--out", folder_ / "late"});
  EXPECT_EQ(compare.status, 0) << compare.err;
  const Json json = ReadJson(folder_ / "late/comparison.json");
  ASSERT_EQ(json["warnings"].size(), 2U);
  for (const std::string backend : {"msckf", "window"}) {
    const std::string warning = backend + " started only after 1.";
    EXPECT_THAT(compare.err, HasSubstr(warning));
    EXPECT_THAT(compare.out, HasSubstr("WARNING: " + warning));
    const Json manifest = ReadJson(folder_ / ("late/" + backend + "/manifest.json"));
    ASSERT_EQ(manifest["warnings"].size(), 1U);
    EXPECT_THAT(manifest["warnings"][0].get<std::string>(), HasSubstr("truth"));  // was missing
    EXPECT_GE(json[backend]["waiting_frames"], 20);
    EXPECT_GE(json[backend]["waited_s"], 1.0);
  }
  EXPECT_THAT(compare.out, HasSubstr("waited for the start [s]"));
  EXPECT_EQ(ReadJson(folder_ / "late/manifest.json")["warnings"].size(), 2U);
}

TEST_F(SimulatedTest, EvaluateTakesARecordsTrajectory) {
  Simulate("4");
  ASSERT_EQ(RunDuet({"run", "--backend=msckf", "--init=groundtruth", "--dataset", dataset_, "--out",
                     folder_ / "run"})
                .status,
            0);
  const std::string truth = dataset_ + "/mav0/state_groundtruth_estimate0/data.csv";
  const ProgramResult evaluation =
      RunDuet({"evaluate", "--groundtruth", truth, "--estimate", folder_ / "run/trajectory.tum",
               truth, "--json", folder_ / "evaluation.json"});
  EXPECT_EQ(evaluation.status, 0) << evaluation.err;
  EXPECT_THAT(evaluation.out, HasSubstr("position rmse"));
  EXPECT_NEAR(ReadJson(folder_ / "evaluation.json")[truth]["ate"]["position_m"], 0.0, 1e-12);
  EXPECT_EQ(RunDuet({"evaluate", "--groundtruth", truth, "--estimate", folder_ / "none"}).status,
            2);
  const ProgramResult all =
      RunDuet({"evaluate", "--groundtruth", truth, "--estimate", folder_ / "run/trajectory.tum",
               "--definition=all", "--definition=evo:sim3", "--json", folder_ / "all.json"});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_THAT(all.out, HasSubstr("Why they differ"));
  const Json definitions =
      ReadJson(folder_ / "all.json")[folder_ / "run/trajectory.tum"]["definitions"];
  EXPECT_EQ(definitions.size(), 4u);
  EXPECT_GT(definitions["evo:sim3"]["position_m"]["rmse"], 0.0);
  EXPECT_EQ(
      RunDuet({"evaluate", "--groundtruth", truth, "--estimate", truth, "--definition=tum"}).status,
      2);
}

/// True once a file below `parent` whose path contains `part` has more than `bytes` bytes.
bool HasGrown(const fs::path& parent, const std::string& part, std::uintmax_t bytes) {
  std::error_code ignored;  // folders are renamed under our hands
  for (fs::recursive_directory_iterator entry(parent, ignored), end; entry != end;
       entry.increment(ignored)) {
    if (ignored) return false;
    if (entry->path().string().find(part) == std::string::npos) continue;
    if (fs::is_regular_file(entry->path(), ignored) &&
        fs::file_size(entry->path(), ignored) > bytes) {
      return true;
    }
  }
  return false;
}

TEST_F(SimulatedTest, AnInterruptedRunKeepsWhatIsFinished) {
  Simulate("60");
  const fs::path results = folder_.path() / "results";
  fs::create_directory(results);
  const ProgramResult run = RunDuet({"run", "--backend=window", "--init=groundtruth", "--dataset",
                                     dataset_, "--out", results / "run"},
                                    [&] { return HasGrown(results, "states.csv", 2000); });
  EXPECT_EQ(run.status, 130) << run.err;
  EXPECT_THAT(FilesIn(results), ElementsAre("run"));
  const Json outcome = ReadJson(results / "run/manifest.json")["outcome"];
  EXPECT_EQ(outcome["status"], "interrupted");
  EXPECT_GT(outcome["frames"], 0);
  EXPECT_LT(outcome["frames"], 1201);
  EXPECT_EQ(
      RunDuet({"evaluate", "--groundtruth", dataset_ + "/mav0/state_groundtruth_estimate0/data.csv",
               "--estimate", results / "run/trajectory.tum"})
          .status,
      0);
}

TEST_F(SimulatedTest, AnInterruptedComparisonKeepsTheEstimatorThatWasDone) {
  Simulate("60");
  const fs::path results = folder_.path() / "results";
  fs::create_directory(results);
  const ProgramResult compare =
      RunDuet({"compare", "--init=groundtruth", "--dataset", dataset_, "--out", results / "out"},
              [&] { return HasGrown(results, "window.partial", 2000); });
  EXPECT_EQ(compare.status, 130) << compare.err;
  EXPECT_THAT(FilesIn(results), ElementsAre("out"));
  EXPECT_THAT(FilesIn(results / "out"), IsSupersetOf({"manifest.json", "msckf", "window"}));
  EXPECT_FALSE(fs::exists(results / "out/comparison.json"));
  EXPECT_EQ(ReadJson(results / "out/msckf/manifest.json")["outcome"]["status"], "done");
  EXPECT_EQ(ReadJson(results / "out/window/manifest.json")["outcome"]["status"], "interrupted");
  EXPECT_EQ(ReadJson(results / "out/manifest.json")["outcome"]["status"], "interrupted");
}

// Rendered on first use, then taken from the cache.
TEST(DefaultComparisonTest, NeedsNoDataSet) {
  const TemporaryFolder folder;
  const char* told = std::getenv("DUET_CACHE");
  const std::string before = told == nullptr ? "" : told;
  setenv("DUET_CACHE", (folder / "cache").c_str(), 1);
  const ProgramResult first =
      RunDuet({"compare", "--start=3", "--duration=5", "--out", folder / "first"});
  const ProgramResult second =
      RunDuet({"compare", "--start=3", "--duration=5", "--out", folder / "second"});
  if (told == nullptr) {
    unsetenv("DUET_CACHE");
  } else {
    setenv("DUET_CACHE", before.c_str(), 1);
  }
  EXPECT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.err, HasSubstr("rendering"));
  EXPECT_THAT(first.out, HasSubstr("simulated: V1_01_easy, world room"));
  EXPECT_EQ(FilesIn(folder / "cache").size(), 1U);
  EXPECT_EQ(ReadJson(folder / "first/comparison.json")["window"]["status"], "tracking");
  EXPECT_EQ(second.status, 0) << second.err;
  // Changed sources may render otherwise: only a clean build takes what it finds.
  const std::string commit = ReadJson(folder / "first/manifest.json")["commit"];
  if (commit != "unknown" && !commit.ends_with("-dirty")) {
    EXPECT_THAT(second.err, Not(HasSubstr("rendering")));
  }
  EXPECT_EQ(ReadJson(folder / "second/comparison.json")["tracks_sha256"],
            ReadJson(folder / "first/comparison.json")["tracks_sha256"]);
}

}  // namespace
}  // namespace duet
